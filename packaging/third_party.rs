//! Writes the licences of the crates that are linked into the program, as Markdown on standard output: a table of names, versions and
//! licences, then each text once with the crates that it is of. `make dist` runs it.
//!
//! Crates that only build scripts or macros use are no part of the program: neither is shaderc, which compiles the shaders for the build.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// How the names of files with licences begin, in capitals.
const LICENCES: [&str; 5] = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE"];

/// A crate in the program.
struct Linked {
    name: String,
    version: String,
    licence: String,
    folder: PathBuf,
    repository: String,
}

fn text(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap_or_default().to_owned()
}

fn list<'a>(value: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> {
    value[key].as_array().into_iter().flatten()
}

fn is_macro(package: &Value) -> bool {
    list(package, "targets").any(|target| list(target, "kind").any(|kind| kind == "proc-macro"))
}

/// Every crate that the program's own code reaches by dependencies that are neither a build script's nor a test's.
fn linked(metadata: &Value) -> Result<Vec<Linked>, Box<dyn Error>> {
    let packages: BTreeMap<&str, &Value> =
        list(metadata, "packages").filter_map(|package| Some((package["id"].as_str()?, package))).collect();
    let nodes: BTreeMap<&str, &Value> =
        list(&metadata["resolve"], "nodes").filter_map(|node| Some((node["id"].as_str()?, node))).collect();
    let root = metadata["resolve"]["root"].as_str().ok_or("cargo metadata names no root")?;
    let (mut queue, mut reached) = (vec![root], BTreeSet::new());
    while let Some(node) = queue.pop().and_then(|id| nodes.get(id)) {
        for dependency in list(node, "deps") {
            let is_normal = list(dependency, "dep_kinds").any(|kind| kind["kind"].is_null());
            let id = dependency["pkg"].as_str().unwrap_or_default();
            let Some(package) = packages.get(id).filter(|package| is_normal && !is_macro(package)) else { continue };
            if reached.insert((text(package, "name"), text(package, "version"), id)) {
                queue.push(id);
            }
        }
    }
    let crates = reached.into_iter().map(|(name, version, id)| {
        let package = packages[id];
        let manifest = PathBuf::from(text(package, "manifest_path"));
        Linked {
            name,
            version,
            licence: text(package, "license"),
            folder: manifest.parent().unwrap_or(Path::new("")).to_owned(),
            repository: text(package, "repository"),
        }
    });
    Ok(crates.collect())
}

/// The texts of licences that a crate brings, in the order of their files' names.
fn licences(folder: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|file| {
        let name = file.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        file.is_file() && LICENCES.iter().any(|licence| name.starts_with(licence))
    });
    files.sort();
    files.iter().map(|file| Ok(String::from_utf8_lossy(&fs::read(file)?).trim().to_owned())).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let target = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| String::from("cargo"));
    let arguments = ["metadata", "--format-version", "1", "--locked", "--filter-platform", &target];
    let output = Command::new(cargo).args(arguments).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let crates = linked(&serde_json::from_slice(&output.stdout)?)?;
    println!("# Licences of what is linked into lumbre\n");
    println!(
        "Besides these, the program contains the standard library of Rust (MIT OR Apache-2.0, https://github.com/rust-lang/rust).\n"
    );
    println!("| crate | version | licence | source |\n|---|---|---|---|");
    let mut texts: Vec<(String, Vec<&str>)> = Vec::new();
    let mut without = Vec::new();
    for one in &crates {
        println!("| {} | {} | {} | {} |", one.name, one.version, one.licence, one.repository);
        let found = licences(&one.folder)?;
        if found.is_empty() {
            without.push(one);
        }
        for text in found {
            match texts.iter_mut().find(|(known, _)| *known == text) {
                Some((_, names)) => names.push(&one.name),
                None => texts.push((text, vec![&one.name])),
            }
        }
    }
    if !without.is_empty() {
        let names: Vec<&str> = without.iter().map(|one| one.name.as_str()).collect();
        println!(
            "\nThe packages of these bring no text of their licence, which is the one in the table: {}.",
            names.join(", ")
        );
    }
    for (text, names) in texts {
        println!("\n## {}\n\n```\n{text}\n```", names.join(", "));
    }
    Ok(())
}
