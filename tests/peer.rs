//! A bench with another renderer in it: shell scripts that speak the protocol of `bench::peer`, or fail to.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use lumbre::bench::results::Run;
use lumbre::bench::{Bench, Limits, Peer, SceneRequest, Stop, Truth, Variant};
use lumbre::image::{Image, Picture, write_picture};

const SIDE: u32 = 16;

/// What a peer says when all is well.
const OPENED: &str = r#"{"renderer": "Fake 1.0", "variant": "slow", "technique": "guessing",
    "setup": {"load": 0.5, "build": 0.25, "compile": 2.0}, "notes": ["it guesses"]}"#;

/// A shell script that reads a line, keeps it in the file `heard`, and answers by its kind.
struct Script {
    folder: tempfile::TempDir,
}

impl Script {
    /// `open`, `begin` and `advance` are commands of the shell; in the last, `$spp` is what was asked for and `$image` an image of
    /// the right size.
    fn new(open: &str, begin: &str, advance: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let text = format!(
            r#"heard=$1/heard
image=$1/image.exr
while read -r line; do
    echo "$line" >> "$heard"
    case $line in
    '{{"open"'*) {open} ;;
    '{{"begin"'*) {begin} ;;
    '{{"advance"'*) spp=${{line#*\"spp\":}}; spp=${{spp%%[,\}}]*}}; {advance} ;;
    esac
done
"#
        );
        std::fs::write(folder.path().join("peer.sh"), text).unwrap();
        write_image(&folder.path().join("image.exr"), SIDE, 1.25);
        write_image(&folder.path().join("small.exr"), SIDE / 2, 1.25);
        write_image(&folder.path().join("broken.exr"), SIDE, f32::NAN);
        Self { folder }
    }

    /// One that opens and begins as it should.
    fn advancing(advance: &str) -> Self {
        Self::new(&say(OPENED), &say(r#"{"ok": true}"#), advance)
    }

    fn words(&self) -> Vec<String> {
        let path = |name: &str| self.folder.path().join(name).display().to_string();
        vec![String::from("sh"), path("peer.sh"), self.folder.path().display().to_string()]
    }

    fn start(&self) -> Result<Peer, String> {
        Peer::start(&self.words(), &request(), self.folder.path()).map_err(|error| error.to_string())
    }

    /// The peer as a bench's command line names it.
    fn variant(&self) -> Result<Variant, String> {
        let text = format!("fake={}", self.words().join(" "));
        Peer::variant(&text, &request(), self.folder.path()).map_err(|error| error.to_string())
    }

    /// The error of a run that cannot be.
    fn failure(&self) -> String {
        let mut peer = self.variant().unwrap().subject;
        peer.begin(3).unwrap();
        let error = peer.advance(Stop { spp: 4, seconds: None }).unwrap_err().to_string();
        println!("{error}");
        assert!(!error.contains('\n') && error.starts_with("peer fake: "), "{error}");
        error
    }

    fn heard(&self) -> Vec<serde_json::Value> {
        let text = std::fs::read_to_string(self.folder.path().join("heard")).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }
}

/// The command that says a line.
fn say(line: &str) -> String {
    format!("echo '{}'", line.replace('\n', " "))
}

/// The answer of a peer that renders a sample per pixel each second.
const STEADY: &str = r#"echo "{\"spp\": $spp, \"seconds\": $spp, \"image\": \"$image\", \"nonfinite\": 7}""#;

fn write_image(path: &Path, side: u32, value: f32) {
    let image = Image { width: side, height: side, pixels: vec![[value, 1.0, 2.0]; (side * side) as usize] };
    write_picture(path, &Picture { image, layers: Vec::new(), header: Vec::new() }).unwrap();
}

fn request() -> SceneRequest {
    SceneRequest {
        file: PathBuf::from("scenes/cornell.xml"),
        defines: vec![(String::from("name"), String::from("a \"quoted\" value"))],
        width: SIDE,
        height: SIDE,
        max_depth: -1,
        rr_depth: Some(5),
    }
}

fn truth() -> Truth {
    let image = Image { width: SIDE, height: SIDE, pixels: vec![[1.0, 1.0, 2.0]; (SIDE * SIDE) as usize] };
    Truth::new(image, None)
}

fn bench(folder: &Path, limits: Limits, variant: Variant) -> lumbre::error::Result<Vec<Run>> {
    std::fs::create_dir_all(folder.join("runs")).unwrap();
    let bench = Bench { folder, scene: "s", limits, fingerprint: 1, truth: &truth() };
    Ok(bench.run(&mut [variant], |_| Ok(()))?.remove(0))
}

#[test]
fn a_peer_takes_part_in_a_bench() {
    let script = Script::advancing(STEADY);
    let variant = script.variant().unwrap();
    assert_eq!(
        (&*variant.name, &*variant.technique, &*variant.backend, &*variant.bias),
        ("fake", "guessing", "slow", "")
    );
    assert_eq!(variant.subject.renderer(), "Fake 1.0");
    assert_eq!(variant.subject.notes(), ["it guesses"]);
    let setup = variant.subject.setup();
    assert_eq!((setup.load, setup.build, setup.compile), (0.5, 0.25, 2.0));

    let folder = tempfile::tempdir().unwrap();
    let runs = bench(folder.path(), Limits { seeds: 2, seconds: None, spp: Some(6), first_seed: 0 }, variant).unwrap();
    for (seed, run) in runs.iter().enumerate() {
        assert_eq!((run.seed as usize, run.nonfinite, run.rays), (seed, 7, None));
        let along: Vec<(u64, f64)> = run.points.iter().map(|point| (point.spp, point.seconds)).collect();
        assert_eq!(along, [(1, 1.0), (2, 2.0), (4, 4.0), (6, 6.0)]);
        // One of three channels is off by 0.25, and relMSE divides that by 1.01.
        let expected = 0.25 * 0.25 / 1.01 / 3.0;
        assert!(run.points.iter().all(|point| (point.relmse - expected).abs() < 1e-9), "{:?}", run.points);
        assert!(run.points.iter().all(|point| point.device_seconds.is_none() && point.estimated_relmse.is_none()));
    }

    // What was said: the scene once, then a run that warms up, then each seed with its stops.
    let heard = script.heard();
    let open = &heard[0]["open"];
    assert!(Path::new(open["scene"].as_str().unwrap()).is_absolute());
    assert!(open["scene"].as_str().unwrap().ends_with("scenes/cornell.xml"));
    assert_eq!(open["defines"]["name"], "a \"quoted\" value");
    assert_eq!((&open["width"], &open["max_depth"], &open["rr_depth"]), (&16.into(), &(-1).into(), &5.into()));
    assert!(!Path::new(open["folder"].as_str().unwrap()).exists(), "the peer's folder should be gone");
    let begun: Vec<u64> = heard.iter().filter_map(|line| line["begin"].as_u64()).collect();
    assert_eq!(begun, [u64::from(u32::MAX), 0, 1]);
    let stops: Vec<u64> = heard.iter().filter_map(|line| line["advance"]["spp"].as_u64()).collect();
    assert_eq!(stops, [1, 1, 2, 4, 6, 1, 2, 4, 6]);
    assert!(heard.iter().all(|line| line["advance"]["seconds"].is_null()));
}

/// With a limit of time, a peer is asked until it has used that time.
#[test]
fn a_peer_stops_in_time() {
    let script = Script::advancing(
        r#"[ "$spp" -gt 5 ] && spp=5; echo "{\"spp\": $spp, \"seconds\": $spp, \"image\": \"$image\"}""#,
    );
    let folder = tempfile::tempdir().unwrap();
    let limits = Limits { seeds: 1, seconds: Some(4.5), spp: None, first_seed: 0 };
    let runs = bench(folder.path(), limits, script.variant().unwrap()).unwrap();
    assert_eq!(runs[0].points.iter().map(|point| point.spp).collect::<Vec<_>>(), [1, 2, 4, 5]);
    assert_eq!(script.heard().last().unwrap()["advance"]["seconds"], 4.5);
}

#[test]
fn a_peer_that_cannot_open_says_why() {
    let fails = |open: &str| {
        let error = Script::new(open, "", "").variant().err().expect("an error");
        println!("{error}");
        assert!(!error.contains('\n'), "{error}");
        error
    };
    assert_eq!(fails(&say(r#"{"error": "no such plugin"}"#)), "peer fake: no such plugin");
    let ended = fails("echo first >&2; echo 'ImportError: no module' >&2; echo >&2; exit 3");
    assert!(ended.contains("ended") && ended.contains("3") && ended.contains("'open'"), "{ended}");
    assert!(ended.ends_with("its last words: ImportError: no module"), "{ended}");
    let silent = fails("exit 0");
    assert!(silent.ends_with("it said nothing"), "{silent}");
    let half = fails(&say(r#"{"renderer": "Fake"}"#));
    assert!(half.contains("variant") && half.contains("'open'"), "{half}");

    let nothing = Peer::start(&[String::from("no-such-program")], &request(), &std::env::temp_dir());
    let nothing = nothing.err().expect("an error");
    assert!(nothing.to_string().contains("cannot start peer no-such-program: 'no-such-program'"), "{nothing}");
    assert_eq!(nothing.exit_status(), 2);
}

/// Each with what the message must say.
#[test]
fn a_peer_that_fails_in_the_middle_says_why() {
    let answer = |spp: &str, seconds: &str, image: &str| {
        say(&format!(r#"{{"spp": {spp}, "seconds": {seconds}, "image": "{image}"}}"#))
            .replace("FOLDER", r#"'"${image%/*}"'"#)
    };
    let cases = [
        (String::from("echo 'out of memory' >&2; kill -9 $$"), vec!["ended", "'advance'", "out of memory"]),
        (say("rendering 4 spp"), vec!["'advance' is no JSON object: rendering 4 spp"]),
        (say("[4]"), vec!["no JSON object"]),
        (String::from("printf '{\"spp\": 4'; exit 0"), vec!["ended", "'advance'"]),
        (say(r#"{"spp": "four", "seconds": 1, "image": "x.exr"}"#), vec!["'advance'", "four"]),
        (say(r#"{"error": "the sampler gave up"}"#), vec!["peer fake: the sampler gave up"]),
        (answer("4", "1", "FOLDER/small.exr"), vec!["8x8 pixels where 16x16"]),
        (answer("4", "1", "FOLDER/broken.exr"), vec!["pixel (0, 0)", "not finite"]),
        (answer("4", "1", "missing.exr"), vec!["cannot read", "missing.exr"]),
        (answer("2", "1", "FOLDER/image.exr"), vec!["stopped early, at 2 samples"]),
        (answer("8", "1", "FOLDER/image.exr"), vec!["8 samples per pixel where 4"]),
        (answer("-1", "1", "FOLDER/image.exr"), vec!["-1 samples"]),
        (answer("4", "-1", "FOLDER/image.exr"), vec!["-1 seconds"]),
    ];
    for (advance, expected) in cases {
        let error = Script::advancing(&advance).failure();
        assert!(expected.iter().all(|part| error.contains(part)), "{advance}: {error}");
    }
}

/// A peer that never ends a line does not fill the memory, and one that is dropped does not live on.
#[test]
fn a_peer_is_kept_in_check() {
    let error = Script::advancing("head -c 3000000 /dev/zero | tr '\\0' 'x'; sleep 1").failure();
    assert!(error.contains("no JSON object: xxxx") && error.len() < 300, "{error}");

    let script = Script::new(&format!("echo $$ > \"$1/pid\"; {}", say(OPENED)), "", "");
    let peer = script.start().unwrap();
    let pid = std::fs::read_to_string(script.folder.path().join("pid")).unwrap();
    let lives =
        || Command::new("sh").args(["-c", &format!("kill -0 {}", pid.trim())]).output().unwrap().status.success();
    assert!(lives());
    let started = Instant::now();
    drop(peer);
    assert!(!lives() && started.elapsed() < Duration::from_secs(2));
}

#[test]
fn a_peers_command_is_read_as_a_shell_would() {
    let variant = |text: &str| Peer::variant(text, &request(), &std::env::temp_dir()).err().expect("an error");
    for text in ["mitsuba.py", "=mitsuba.py", "name=", "name=  "] {
        let error = variant(text);
        assert!(error.to_string().contains("NAME=COMMAND"), "{error}");
        assert_eq!(error.exit_status(), 2);
    }
    assert!(variant("name='open").to_string().contains("quote"));
    // One word with a space in it, and an equals sign in the command.
    let error = variant("name=sh -c 'echo a=\"b c\" >&2; exit 4'").to_string();
    assert!(error.ends_with("its last words: a=b c"), "{error}");
}
