//! The pages of `docs/` against the program and the code: tables that the program writes, and links to where things are.

use std::path::{Path, PathBuf};

use crate::common::program::lumbre;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn says(args: &[&str]) -> String {
    let output = lumbre().args(args).output().unwrap();
    assert!(output.status.success(), "lumbre {}", args.join(" "));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_page_of_techniques_is_the_one_that_list_writes() {
    let page = read(&root().join("docs/techniques.md"));
    assert!(
        page == says(&["list", "--markdown"]),
        "docs/techniques.md is not up to date: cargo run --release -- list --markdown > docs/techniques.md"
    );
}

#[test]
fn the_table_of_cases_is_the_one_that_verify_writes() {
    let page = read(&root().join("docs/verify.md"));
    let table = says(&["verify", "--list", "--markdown"]);
    assert!(
        page.contains(&table),
        "the table in docs/verify.md is not up to date: replace it by what `cargo run --release -- verify --list --markdown` prints"
    );
}

/// README.md names every technique, and stays short: what it loses belongs into `docs/`.
#[test]
fn the_readme_is_short_and_names_every_technique() {
    let readme = read(&root().join("README.md"));
    for row in lumbre::techniques::TECHNIQUES {
        assert!(readme.contains(&format!("\n| `{}` | ", row.name)), "README.md has no row of {}", row.name);
    }
    let words = readme.split_whitespace().count();
    assert!(words <= 900, "README.md has {words} words: 900 at most");
}

/// README.md, CONTRIBUTING.md and the pages of `docs/`.
fn pages() -> Vec<PathBuf> {
    let here = ["README.md", "CONTRIBUTING.md"].map(|name| root().join(name));
    let docs = std::fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    here.into_iter().chain(docs.filter(|path| path.extension().is_some_and(|extension| extension == "md"))).collect()
}

/// The links of a page: text and target.
fn links(page: &str) -> Vec<(&str, &str)> {
    let mut links = Vec::new();
    for (at, _) in page.match_indices("](") {
        let (before, after) = (&page[..at], &page[at + 2..]);
        if let (Some(start), Some(end)) = (before.rfind('['), after.find(')')) {
            links.push((&before[start + 1..], &after[..end]));
        }
    }
    links
}

/// A link to a file finds it; one whose text is a name in code finds the name there.
#[test]
fn links_lead_to_what_they_name() {
    let mut broken = Vec::new();
    let mut count = 0;
    for path in pages() {
        let page = read(&path);
        for (text, target) in links(&page) {
            let target = target.split('#').next().unwrap_or_default();
            if target.is_empty() || target.contains("://") {
                continue;
            }
            count += 1;
            let at = path.parent().unwrap().join(target);
            let link = format!("{}: [{text}]({target})", path.display());
            if !at.exists() {
                broken.push(format!("{link}: no such file"));
                continue;
            }
            let source = at.extension().is_some_and(|extension| extension == "rs" || extension == "glsl");
            let name = text.trim_matches('`').rsplit("::").next().unwrap_or_default();
            let identifier =
                text.len() > 2 && !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
            if source && text.starts_with('`') && identifier && !read(&at).contains(name) {
                broken.push(format!("{link}: the file has no such name"));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    assert!(count > 50, "{count} links");
}
