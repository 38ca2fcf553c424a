//! The lecture as a user makes it: a page that needs nothing else, in both languages, that goes on where it was interrupted.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

use lumbre::lecture::{CHAPTERS, LANGUAGES};
use lumbre::techniques::{self, TECHNIQUES};
use roxmltree::{Document, Node};

/// The lecture with hardly any work into `folder`.
fn command(folder: &Path, more: &[&str]) -> Command {
    let mut command = crate::common::program::lumbre();
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command.args(["lecture", "--quick", "--scale", "0.1", "-o"]).arg(folder).args(more);
    if let Ok(device) = std::env::var("LUMBRE_TEST_DEVICE") {
        command.args(["--device", &device]);
    }
    command
}

fn lecture(folder: &Path, more: &[&str]) -> Output {
    command(folder, more).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Makes it; what it said.
fn works(folder: &Path, more: &[&str]) -> String {
    let output = lecture(folder, more);
    assert!(output.status.success(), "{more:?}: {}", text(&output.stderr));
    text(&output.stderr)
}

/// The one line that a refusal says.
fn fails(folder: &Path, more: &[&str], status: i32) -> String {
    let output = lecture(folder, more);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{more:?}: {errors}");
    assert!(errors.starts_with("error: ") && errors.lines().count() == 1, "{more:?}: {errors}");
    errors
}

/// The commands that were run, of what the lecture said.
fn rendered(said: &str) -> Vec<&str> {
    said.lines().filter_map(|line| Some(line.split_once(" s  ")?.1)).collect()
}

fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder.join("runs")).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    files
}

fn changed(path: &Path) -> SystemTime {
    path.metadata().unwrap().modified().unwrap()
}

/// The page without what its script holds.
fn markup(page: &str) -> String {
    let begin = page.find("<script>").unwrap() + "<script>".len();
    let end = page.find("</script>").unwrap();
    format!("{}{}", &page[..begin], &page[end..])
}

fn parse(markup: &str) -> Document<'_> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    Document::parse_with_options(markup, options).unwrap()
}

fn within<'a>(node: Node<'a, 'a>) -> String {
    node.descendants().filter_map(|node| if node.is_text() { node.text() } else { None }).collect()
}

/// Chapters whose renderings are those of all rooms by all techniques: as much work as all others have.
const ROOMS: [&str; 2] = ["difficult", "choice"];

/// What it adds to the other page is what two chapters write of it.
#[test]
#[ignore = "a minute or two of the driver's time: `make thorough` runs it"]
fn the_page_of_rooms() {
    the_page(|name| ROOMS.contains(&name));
}

#[test]
fn the_page_of_comparisons() {
    the_page(|name| !ROOMS.contains(&name));
}

/// A page with hardly any samples: every command that it shows is one that ran.
fn the_page(chosen: impl Fn(&str) -> bool) {
    let folder = tempfile::tempdir().unwrap();
    let chosen: Vec<_> = CHAPTERS.iter().filter(|chapter| chosen(chapter.name)).collect();
    let there = || chosen.iter().filter(|chapter| chapter.is_there());
    let only: Vec<&str> = there().flat_map(|chapter| ["--only", chapter.name]).collect();
    let said = works(folder.path(), &only);
    let ran: HashSet<&str> = rendered(&said).into_iter().collect();
    assert_eq!(ran.len(), rendered(&said).len(), "a command ran twice");

    let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
    for outside in ["http:", "https:", "url(", "src=", "@import"] {
        assert!(!page.contains(outside), "{outside} is in the page");
    }
    let markup = markup(&page);
    let document = parse(&markup);
    let elements = || document.descendants().filter(Node::is_element);
    let mut ids = HashSet::new();
    for id in elements().filter_map(|node| node.attribute("id")) {
        assert!(ids.insert(id), "the id {id} occurs twice");
    }
    for node in elements() {
        match node.attribute("href") {
            Some(target) if target.starts_with('#') => assert!(ids.contains(&target[1..]), "no element {target}"),
            Some(target) => assert!(target.starts_with("data:image/png;base64,"), "the page refers to {target}"),
            None => {}
        }
    }

    // Every chapter whose techniques are there, and no other one.
    for chapter in &chosen {
        let there = chapter.needs.iter().all(|name| techniques::find(name).is_some());
        assert_eq!(ids.contains(chapter.name), there, "{}", chapter.name);
    }
    let mut shown = HashSet::new();
    for section in elements().filter(|node| node.attribute("class") == Some("chapter")) {
        let name = section.attribute("id").unwrap();
        for lang in LANGUAGES {
            let has = |class: &str| {
                section.descendants().any(|node| {
                    node.attribute("lang") == Some(lang)
                        && node.attribute("class").is_some_and(|classes| classes.contains(class))
                        && within(node).len() > 30
                })
            };
            assert!(has("question") && has("see"), "{name} in {lang}");
        }
        for picture in section.descendants().filter(|node| node.attribute("role") == Some("img")) {
            let label = picture.attribute("aria-label").unwrap();
            let lang = picture.ancestors().find_map(|node| node.attribute("lang")).unwrap();
            assert!(label.len() > 10 && LANGUAGES.contains(&lang), "a picture of {name}: {label}");
        }
        let boxes: Vec<String> = section.descendants().filter(|node| node.has_tag_name("pre")).map(within).collect();
        assert!(!boxes.is_empty(), "{name} shows no command");
        shown.extend(boxes.iter().flat_map(|text| text.lines()).map(String::from));
    }
    // What the page shows is what ran, and all of it.
    assert_eq!(shown, ran.iter().map(|command| (*command).to_owned()).collect::<HashSet<String>>());
    for (name, count) in [("question", 1), ("math", 1)] {
        let found = elements().filter(|node| node.has_tag_name(name) || node.attribute("class") == Some(name)).count();
        assert!(found >= count * there().count(), "{found} of {name}");
    }
    for word in ["NaN", "inf ", "undefined"] {
        assert!(
            !elements()
                .filter(|node| !node.has_tag_name("image"))
                .any(|node| node.text().is_some_and(|t| t.contains(word))),
            "{word}"
        );
    }

    // Once more, nothing is left to do.
    assert_eq!(rendered(&works(folder.path(), &only)), Vec::<&str>::new());
}

#[test]
fn it_goes_on_where_it_was_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let only = ["--only", "equation"];
    let first = works(folder.path(), &only);
    let all = rendered(&first).len();
    let images = files(folder.path(), "exr");
    let times: Vec<SystemTime> = images.iter().map(|path| changed(path)).collect();
    let page = folder.path().join("index.html");
    let holds = |text: &str| std::fs::read_to_string(&page).unwrap().contains(text);
    assert!(holds("id=\"equation\"") && !holds("id=\"lengths\""));

    let image = |name: &str| folder.path().join("runs").join(name);
    // A picture that is rendered again has other seconds in its header, so what is compared with it is compared again.
    let again = |name: &str| {
        let said = works(folder.path(), &only);
        let ran = rendered(&said);
        let of_it =
            |command: &&&str| command.contains(&format!("{name}.json")) || command.contains(&format!("{name}-against"));
        assert_eq!((ran.len(), ran.iter().filter(of_it).count()), (2, 2), "{name}: {ran:?}");
    };
    // An image that is gone, one that was cut short, a stamp that was cut short, and one that is gone.
    std::fs::remove_file(image("equation-4.exr")).unwrap();
    again("equation-4");
    let bytes = std::fs::read(image("equation-16.exr")).unwrap();
    std::fs::write(image("equation-16.exr"), &bytes[..bytes.len() / 2]).unwrap();
    again("equation-16");
    let stamp = std::fs::read(image("equation-64.stamp")).unwrap();
    std::fs::write(image("equation-64.stamp"), &stamp[..stamp.len() / 2]).unwrap();
    again("equation-64");
    std::fs::remove_file(image("equation-256.stamp")).unwrap();
    again("equation-256");
    let touched = ["equation-4.exr", "equation-16.exr", "equation-64.exr", "equation-256.exr"];
    for (path, time) in images.iter().zip(times) {
        let is_touched = touched.iter().any(|name| path.ends_with(Path::new(name)));
        assert_eq!(changed(path) != time, is_touched, "{}", path.display());
    }
    // From the start.
    let fresh = works(folder.path(), &["--only", "equation", "--fresh"]);
    assert_eq!(rendered(&fresh).len(), all);
}

/// The signal of Ctrl-C while a rendering is under way.
#[test]
fn an_interrupt_keeps_what_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| {
        let mut command = crate::common::program::lumbre();
        command.current_dir(env!("CARGO_MANIFEST_DIR")).args(["lecture", "--scale", "0.1", "--only", "photons", "-o"]);
        command.arg(folder.path()).args(more).stdout(Stdio::null()).stderr(Stdio::piped());
        if let Ok(device) = std::env::var("LUMBRE_TEST_DEVICE") {
            command.args(["--device", &device]);
        }
        command.spawn().unwrap()
    };
    let child = run(&[]);
    // The lecture's second command is a reference of many seconds; the first one is finished then.
    let began = Instant::now();
    while !folder.path().join("runs").exists() || files(folder.path(), "stamp").is_empty() {
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(10));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("error: interrupted: what was rendered is kept"), "{said}");
    let kept = files(folder.path(), "stamp");
    assert!(!folder.path().join("index.html").exists() && !kept.is_empty());
    // What was under way has no stamp: only what is listed as finished has one.
    assert_eq!(kept.len(), rendered(&said).len(), "{said}");
}

#[test]
fn bad_lectures_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = fails(folder.path(), &["--only", "caustics"], 2);
    assert!(error.contains("no chapter 'caustics'"), "{error}");
    for chapter in CHAPTERS.iter().filter(|chapter| chapter.is_there()) {
        assert!(error.contains(chapter.name), "{error}");
    }
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let error = fails(&file, &[], 1);
    assert!(error.contains("cannot write") && error.contains("file"), "{error}");
    let error = fails(&file.join("below"), &[], 1);
    assert!(error.contains("cannot write"), "{error}");
    let error = fails(folder.path(), &["--scenes", "nowhere"], 2);
    assert!(error.contains("nowhere") && error.contains("--scenes"), "{error}");
    let error = fails(folder.path(), &["--backend", "cuda"], 2);
    assert!(error.contains("no backend 'cuda'"), "{error}");
}

/// What `lumbre list` prints has all that the table of techniques says.
#[test]
fn list_shows_the_whole_table() {
    let listed = crate::common::program::lumbre().arg("list").output().unwrap();
    let listed = text(&listed.stdout);
    assert!(listed.lines().all(|line| line.chars().count() <= 100), "{listed}");
    let listed = listed.split_whitespace().collect::<Vec<_>>().join(" ");
    for row in TECHNIQUES {
        for said in [row.title, row.solves.what(), row.good_at, row.bad_at] {
            assert!(listed.contains(said), "lumbre list lacks '{said}'");
        }
        assert!(listed.contains(&row.measured.replace('`', "")), "lumbre list lacks '{}'", row.measured);
        assert!(row.measured.chars().any(|c| c.is_ascii_digit()), "no figure in what was measured of {}", row.name);
    }
}
