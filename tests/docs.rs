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

/// What a plugin of Mitsuba needs besides its parameters, and the elements around it.
fn probe_of(tag: &str, plugin: &str) -> (String, &'static str) {
    let file = |name: &str| format!(r#"<string name="filename" value="{name}"/>"#);
    let inner = r#"<bsdf type="diffuse"/>"#;
    let map = |name: &str| format!(r#"<texture type="checkerboard" name="{name}"/>"#);
    let body = match (tag, plugin) {
        ("shape", "obj" | "ply") => file(&format!("mesh.{plugin}")),
        ("shape", "serialized") => file("mesh.serialized"),
        ("shape", "instance") => String::from(r#"<ref id="group"/>"#),
        ("bsdf", "twosided" | "mask") => inner.to_owned(),
        ("bsdf", "blendbsdf") => inner.repeat(2),
        ("bsdf", "normalmap") => format!("{inner}{}", map("normalmap")),
        ("bsdf", "bumpmap") => format!("{inner}{}", map("bump")),
        ("texture", "bitmap") | ("emitter", "envmap") => file("image.png"),
        ("texture", "mesh_attribute") => String::from(r#"<string name="name" value="vertex_color"/>"#),
        ("texture", "rawconstant") => String::from(r#"<float name="value" value="1"/>"#),
        ("texture", "regular") => String::from(r#"<string name="values" value="1, 2"/>"#),
        ("texture", "irregular") => {
            String::from(r#"<string name="values" value="1, 2"/><string name="wavelengths" value="400, 500"/>"#)
        }
        ("sensor", "thinlens") => String::from(r#"<float name="aperture_radius" value="1"/>"#),
        ("film", _) => String::from(r#"<integer name="crop_width" value="2"/>"#),
        _ => String::new(),
    };
    let around = match (tag, plugin) {
        ("shape", "instance") => r#"<shape type="shapegroup" id="group"><shape type="sphere"/></shape>%"#,
        ("emitter", "area" | "directionalarea") => r#"<shape type="sphere">%</shape>"#,
        ("film" | "sampler", _) => r#"<sensor type="perspective">%</sensor>"#,
        ("rfilter", _) => r#"<sensor type="perspective"><film type="hdrfilm">%</film></sensor>"#,
        _ => "%",
    };
    (body, around)
}

/// The words in backquotes.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

/// The page of formats names the parameters that the loader of Mitsuba's scenes takes, all of them and no other.
#[test]
fn parameters_of_mitsuba_s_plugins_are_those_that_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::fs::write(folder.path().join("mesh.obj"), obj).unwrap();
    std::fs::write(folder.path().join("mesh.ply"), ply).unwrap();
    let copy = |from: &str, to: &str| std::fs::copy(root().join(from), folder.path().join(to)).unwrap();
    copy("tests/corpus/sound/serialized/single.serialized", "mesh.serialized");
    copy("tests/corpus/sound/image/grey1.png", "image.png");
    let path = folder.path().join("scene.xml");
    let refusal = |tag: &str, plugin: &str| -> String {
        let (body, around) = probe_of(tag, plugin);
        let element = format!(r#"<{tag} type="{plugin}">{body}<transform name="unknown"/></{tag}>"#);
        let scene = around.replace('%', &element);
        std::fs::write(&path, format!(r#"<scene version="3.0.0"><shape type="sphere"/>{scene}</scene>"#)).unwrap();
        lumbre::scene::load(&path, &lumbre::scene::LoadOptions::default()).unwrap_err().to_string()
    };
    let page = read(&root().join("docs/scenes.md"));
    let table = page.split("| element | read | changes nothing |\n|---|---|---|\n").nth(1).unwrap();
    let (mut rows, mut wrong) = (0, Vec::new());
    for row in table.lines().take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.split('|').collect();
        let [_, names, known, ignored, _] = cells[..] else { panic!("not a row of three cells: {row}") };
        let names = quoted(names);
        let mut stated: Vec<&str> = quoted(known).into_iter().chain(quoted(ignored)).collect();
        stated.sort_unstable();
        for plugin in &names[1..] {
            let said = refusal(names[0], plugin);
            assert!(said.contains("has no parameter 'unknown'"), "{plugin}: {said}");
            let valid = said.split("valid are ").nth(1).unwrap_or_default().replace(" and ", ", ");
            let mut valid: Vec<&str> = valid.split(", ").filter(|name| !name.is_empty()).collect();
            valid.sort_unstable();
            if valid != stated {
                wrong.push(format!("{} {plugin}: the page has {stated:?}, the loader {valid:?}", names[0]));
            }
            rows += 1;
        }
    }
    assert!(wrong.is_empty(), "docs/scenes.md: {}", wrong.join("; "));
    assert!(rows > 60, "{rows} plugins");
    // What the page says is refused is, with that reason.
    let refused = page.split("| element | why |\n|---|---|\n").nth(1).unwrap();
    for row in refused.lines().take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.split('|').collect();
        let (elements, why) = (cells[1], cells[2].replace('`', ""));
        for group in elements.split(';') {
            let names = quoted(group);
            let tags = ["bsdf", "shape", "emitter", "sensor", "film", "texture", "integrator"];
            let (tag, plugins) =
                if tags.contains(&names[0]) { (Some(names[0]), &names[1..]) } else { (None, &names[..]) };
            for plugin in plugins {
                let said = match tag {
                    Some("integrator") => continue, // refused where it would be used: tests/mitsuba.rs
                    Some(tag) => refusal(tag, plugin),
                    None => refusal(plugin, "homogeneous"),
                };
                assert!(said.contains(why.trim()), "{plugin}: {said}");
            }
        }
    }
}

/// The page of formats names the extensions of glTF that the loader reads, all of them and no other, and what it says is not read is refused.
#[test]
fn extensions_of_gltf_are_those_that_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.gltf");
    let refusal = |extension: &str| {
        let text = format!(r#"{{"asset": {{"version": "2.0"}}, "extensionsRequired": ["{extension}"]}}"#);
        std::fs::write(&path, text).unwrap();
        lumbre::scene::load(&path, &lumbre::scene::LoadOptions::default()).unwrap_err().to_string()
    };
    let page = read(&root().join("docs/scenes.md"));
    let names = |title: &str| -> Vec<String> {
        let table = page.split(title).nth(1).unwrap();
        let rows = table.lines().take_while(|line| line.starts_with('|'));
        rows.flat_map(|row| quoted(row.split('|').nth(1).unwrap())).map(str::to_owned).collect()
    };
    let said = refusal("VENDOR_unknown");
    let read = said.split("read are ").nth(1).unwrap().replace(" or ", ", ");
    let mut read: Vec<&str> = read.split(", ").collect();
    let mut stated = names("| extension | read |\n|---|---|\n");
    read.sort_unstable();
    stated.sort_unstable();
    assert_eq!(stated, read);
    for name in names("| extension | not read, as |\n|---|---|\n") {
        assert!(refusal(&name).contains(&format!("requires the extension '{name}'")), "{name}");
    }
}
