//! `docs/tour/`: its pages name lines of the code and quote the validation layer. Both are held to the truth here.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::program::lumbre;
use crate::common::scene_path;

/// Asks to write line numbers into the pages again.
const WRITE: &str = "LUMBRE_TEST_PAGES";

/// The validation layer whose words the pages quote.
const QUOTED_LAYER: &str = "1.3.239";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The pages with their texts.
fn pages() -> Vec<(PathBuf, String)> {
    let mut pages: Vec<PathBuf> =
        std::fs::read_dir(root().join("docs/tour")).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.sort();
    pages.into_iter().map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

/// The lines of the item that begins with this text: to the first line that is as far indented and begins with `}`.
fn lines_of(file: &Path, begins: &str) -> (usize, usize) {
    let text = std::fs::read_to_string(file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let place = |line: &&str| line.contains(begins);
    let first = lines.iter().position(place).unwrap_or_else(|| panic!("{}: nothing has '{begins}'", file.display()));
    assert_eq!(
        lines.iter().filter(|line| place(line)).count(),
        1,
        "{}: '{begins}' is there more than once",
        file.display()
    );
    let indent = lines[first].len() - lines[first].trim_start().len();
    let ends = |line: &&str| line.len() > indent && line[..indent].trim().is_empty() && line[indent..].starts_with('}');
    let last = first + 1 + lines[first + 1..].iter().position(ends).unwrap();
    (first + 1, last + 1)
}

/// A page with the line numbers that its links should have: links look like `[FILE, lines A to B](../../FILE#LA-LB "ITEM")`.
fn with_lines(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(", lines ") {
        let open = rest[..start].rfind("[`").unwrap();
        let file = rest[open + 2..start].trim_end_matches('`');
        let title = rest[start..].find(" \"").unwrap() + start + 2;
        let close = rest[title..].find("\")").unwrap() + title;
        let begins = rest[title..close].replace("\\\"", "\"");
        let (first, last) = lines_of(&root().join(file), &begins);
        let kept = &rest[title..close];
        write!(out, "{}, lines {first} to {last}](../../{file}#L{first}-L{last} \"{kept}\")", &rest[..start]).unwrap();
        rest = &rest[close + 2..];
    }
    out + rest
}

#[test]
fn lines_are_those_of_the_code() {
    for (path, text) in pages() {
        let right = with_lines(&text);
        if std::env::var_os(WRITE).is_some() {
            std::fs::write(&path, &right).unwrap();
            continue;
        }
        assert!(
            right == text,
            "{}: its lines have moved; {WRITE}=1 cargo test --release --test tests tour:: writes them again",
            path.display()
        );
    }
}

/// What a page says of a step: the step, and the messages that it quotes.
fn omissions(text: &str) -> Vec<(String, Vec<String>)> {
    let paragraphs = text.split("\n\n").filter(|paragraph| paragraph.starts_with("**Left out**"));
    let quoted = |paragraph: &str| {
        let words = paragraph.split('`').skip(1).step_by(2);
        words.filter(|word| word.starts_with("VUID-") || word.starts_with("UNASSIGNED-")).map(str::to_owned).collect()
    };
    let step = |paragraph: &str| paragraph.split("LUMBRE_OMIT=").nth(1).unwrap().split('`').next().unwrap().to_owned();
    paragraphs.map(|paragraph| (step(paragraph), quoted(paragraph))).collect()
}

fn installed_layer() -> Option<String> {
    let manifest = Path::new("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json");
    let text = std::fs::read_to_string(manifest).ok()?;
    let json: serde_json::Value = serde_json::from_str(&text).ok()?;
    Some(json["layer"]["api_version"].as_str()?.to_owned())
}

/// Each step is left out for real: the layer says what the page quotes, or nothing where the page says so.
#[test]
fn the_validation_layer_says_what_the_pages_quote() {
    let quoted = installed_layer().as_deref() == Some(QUOTED_LAYER);
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    for (path, text) in pages() {
        for (step, messages) in omissions(&text) {
            let backend = if step == "structure-input" { "ray-query" } else { "bvh" };
            let mut command: Command = lumbre();
            command.env("LUMBRE_OMIT", &step).current_dir(folder.path()).arg("render").arg(scene_path("cornell.xml"));
            command.args([
                "-i",
                "bdpt",
                "-n",
                "1",
                "--size",
                "16x16",
                "--validate",
                "-q",
                "-o",
                "image.exr",
                "--backend",
                backend,
            ]);
            let said = String::from_utf8_lossy(&command.output().unwrap().stderr).into_owned();
            let what = format!("{}, {step}", path.display());
            if messages.is_empty() {
                assert!(!said.contains("validation: "), "{what}: the layer is said to be silent, and says: {said}");
            } else if quoted {
                for message in &messages {
                    assert!(said.contains(message.as_str()), "{what}: no {message} in: {said}");
                }
            } else {
                assert!(said.contains("validation: "), "{what}: {said}");
            }
            count += 1;
        }
    }
    assert!(count >= 14, "{count} steps");
}

/// Every step that can be left out has its place in the tour.
#[test]
fn every_step_is_in_the_tour() {
    let mut command = lumbre();
    command.env("LUMBRE_OMIT", "nothing").arg("devices");
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    let valid = said.split("valid are ").nth(1).unwrap().trim().replace(" or ", ", ");
    let told: Vec<String> = pages().iter().flat_map(|(_, text)| omissions(text)).map(|(step, _)| step).collect();
    for step in valid.split(", ") {
        assert!(told.iter().any(|own| own == step), "no page leaves out {step}: {told:?}");
    }
}
