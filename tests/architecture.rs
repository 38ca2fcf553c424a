//! The folders of `src/`: each knows those below it, and none knows one above (docs/architecture.md).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The Rust files below a folder, with the depth of each one's module below the root of the crate: 1 of a folder's `mod.rs`.
fn files(folder: &Path, depth: usize, found: &mut Vec<(usize, PathBuf)>) {
    for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            files(&entry, depth + 1, found);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            found.push((depth + usize::from(!entry.ends_with("mod.rs")), entry));
        }
    }
}

/// The folders that a file names by paths from the root of the crate, comments and its unit tests aside. Fails where it names some in other
/// ways: in braces behind the root, or by as many `super::` as lead to the root.
fn named(file: &Path, depth: usize) -> BTreeSet<String> {
    let text = std::fs::read_to_string(file).unwrap();
    let code: Vec<&str> = text
        .split("\nmod tests {")
        .next()
        .unwrap_or_default()
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect();
    let code = code.join("\n");
    let up = "super::".repeat(depth);
    for hidden in ["crate::{", "lumbre::{", &up] {
        assert!(
            !code.contains(hidden),
            "{} names folders by {hidden}, where this test does not see them",
            file.display()
        );
    }
    let paths = ["crate::", "lumbre::"].into_iter().flat_map(|root| code.split(root).skip(1).collect::<Vec<_>>());
    let first = |path: &str| path.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    paths.map(first).collect()
}

/// Follows the folders that one leads to; fails where that comes back.
fn descend<'a>(uses: &'a BTreeMap<String, BTreeSet<String>>, way: &mut Vec<&'a str>, done: &mut BTreeSet<&'a str>) {
    let here = way[way.len() - 1];
    for next in &uses[here] {
        assert!(!way.contains(&next.as_str()), "a circle of folders in src: {way:?}, then {next} again");
        if done.insert(next) {
            way.push(next);
            descend(uses, way, done);
            way.pop();
        }
    }
}

#[test]
fn folders_know_only_those_below() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let folders = std::fs::read_dir(&src).unwrap().map(|entry| entry.unwrap()).filter(|entry| entry.path().is_dir());
    let folders: BTreeSet<String> = folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    let uses: BTreeMap<String, BTreeSet<String>> = folders
        .iter()
        .map(|folder| {
            let mut all = Vec::new();
            files(&src.join(folder), 1, &mut all);
            let mut used: BTreeSet<String> = all.iter().flat_map(|(depth, file)| named(file, *depth)).collect();
            used.retain(|name| folders.contains(name) && name != folder);
            (folder.clone(), used)
        })
        .collect();
    assert!(uses["render"].contains("gpu") && uses["layout"].is_empty(), "{uses:#?}");
    let mut done = BTreeSet::new();
    for folder in uses.keys() {
        descend(&uses, &mut vec![folder], &mut done);
    }
}

/// Where `unsafe` may stand: Vulkan, and the one other library in C.
const UNSAFE: [&str; 2] = ["src/gpu/", "src/denoise/library.rs"];

#[test]
fn unsafe_code_is_where_c_is_called() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    files(&root.join("src"), 0, &mut all);
    let mut found = BTreeSet::new();
    for (_, file) in all {
        let text = std::fs::read_to_string(&file).unwrap();
        let mut code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        if code.any(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe")) {
            let name = file.strip_prefix(root).unwrap().display().to_string();
            let place = UNSAFE.iter().find(|place| name.starts_with(**place));
            found.insert(*place.unwrap_or_else(|| panic!("{name} has unsafe code, which belongs to {UNSAFE:?}")));
        }
    }
    assert_eq!(found, BTreeSet::from(UNSAFE));
}

/// Sums of whole numbers are checked in the program that people run.
#[test]
fn overflow_is_checked_in_release() {
    let manifest =
        std::fs::read_to_string(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap();
    let own = manifest.split("[profile.release.package.lumbre]").nth(1).unwrap_or_default();
    assert!(
        own.trim_start().starts_with("overflow-checks = true"),
        "Cargo.toml: overflow checks of lumbre are off in release"
    );
}
