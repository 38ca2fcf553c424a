//! The program as a user runs it: what it writes, what it says, and its exit status.

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use lumbre::image::read_image;
use lumbre::techniques::TECHNIQUES;

/// The program on the tests' device (`LUMBRE_TEST_DEVICE`), if one is named.
fn program(folder: &Path, args: &[&str]) -> Command {
    let mut command = crate::common::program::lumbre();
    command.args(args).current_dir(folder);
    let names_device = args.contains(&"--device");
    if let Ok(device) = std::env::var("LUMBRE_TEST_DEVICE")
        && args.first() == Some(&"render")
        && !names_device
    {
        command.args(["--device", &device]);
    }
    command
}

fn lumbre(folder: &Path, args: &[&str]) -> Output {
    program(folder, args).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a command that must work.
fn works(folder: &Path, args: &[&str]) -> String {
    let output = lumbre(folder, args);
    assert!(output.status.success(), "{args:?}: {}{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

/// Runs a command that must fail with this status; its first line on stderr, which must begin with `error: `.
fn fails(folder: &Path, args: &[&str], status: i32) -> String {
    let output = lumbre(folder, args);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{args:?}: {errors}");
    let line = errors.lines().find(|line| line.starts_with("error: ")).unwrap_or_else(|| panic!("{args:?}: {errors}"));
    assert!(!errors.contains("panicked"), "{errors}");
    line.to_owned()
}

fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).display().to_string()
}

#[test]
fn render_writes_what_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.xml");
    let summary = works(
        folder.path(),
        &["render", &cornell, "-n", "2", "--size", "24x16", "-o", "a.exr", "-o", "a.png", "--json", "a.json"],
    );
    assert!(summary.contains("wrote      a.exr, a.png"), "{summary}");
    let exr = read_image(&folder.path().join("a.exr")).unwrap();
    let png = read_image(&folder.path().join("a.png")).unwrap();
    assert_eq!((exr.width, exr.height, png.width, png.height), (24, 16, 24, 16));
    // The PNG is the EXR, clamped and in 8 bits.
    for (a, b) in exr.pixels.iter().flatten().zip(png.pixels.iter().flatten()) {
        assert!((a.clamp(0.0, 1.0) - b).abs() < 0.006, "{a} against {b}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("a.json")).unwrap()).unwrap();
    for key in [
        "schema",
        "scene",
        "integrator",
        "backend",
        "device",
        "driver",
        "width",
        "height",
        "spp",
        "seed",
        "max_depth",
        "rays",
        "mrays_per_s",
        "samples_per_s",
        "nonfinite",
        "mean",
        "peak_device_bytes",
    ] {
        assert!(!json[key].is_null(), "no '{key}' in {json}");
    }
    for key in ["load", "build", "compile", "render", "total"] {
        assert!(json["seconds"][key].is_number(), "no 'seconds.{key}' in {json}");
    }
    assert_eq!((&json["spp"], &json["nonfinite"], json["mean"].as_array().unwrap().len()), (&2.into(), &0.into(), 3));
    let names: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(names.len(), 3, "nothing else is left behind: {names:?}");
}

#[test]
fn render_without_an_output_names_files_after_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    works(folder.path(), &["render", &scene("furnace_box.xml"), "-n", "1", "--size", "8x8", "-q"]);
    assert!(folder.path().join("furnace_box.exr").exists() && folder.path().join("furnace_box.png").exists());
}

#[test]
fn the_same_command_writes_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.xml");
    let render = |seed: &str| {
        works(folder.path(), &["render", &cornell, "-n", "3", "--size", "32x32", "-o", "a.png", "--seed", seed, "-q"]);
        std::fs::read(folder.path().join("a.png")).unwrap()
    };
    let first = render("5");
    assert_eq!(first, render("5"));
    assert_ne!(first, render("6"));
}

#[test]
fn layers_by_length_are_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    works(
        folder.path(),
        &[
            "render",
            &scene("furnace_sphere.xml"),
            "-n",
            "4",
            "--size",
            "8x8",
            "--lengths=3",
            "--aov",
            "variance,samples",
            "-o",
            "a.exr",
        ],
    );
    let image = exr::prelude::read_all_flat_layers_from_file(folder.path().join("a.exr")).unwrap();
    let layer = &image.layer_data[0];
    let names: Vec<_> = layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
    for name in ["R", "length01.R", "length02.G", "length03plus.B", "variance.R", "samples.B"] {
        assert!(names.iter().any(|found| found == name), "no channel {name} in {names:?}");
    }
    let first = |name: &str| {
        let channel = layer.channel_data.list.iter().find(|channel| channel.name.to_string() == name).unwrap();
        channel.sample_data.values_as_f32().next().unwrap()
    };
    assert_eq!((first("length01.R"), first("samples.R")), (1.0, 4.0));
    let sum = f64::from(first("length01.G")) + f64::from(first("length02.G")) + f64::from(first("length03plus.G"));
    assert_eq!(sum as f32, first("G"), "the layers sum to the image exactly");
    // Every setting and figure is in the header.
    let header: Vec<_> = layer.attributes.other.keys().map(ToString::to_string).collect();
    for name in ["lumbre.integrator", "lumbre.seed", "lumbre.seconds", "lumbre.device"] {
        assert!(header.iter().any(|found| found == name), "no {name} in {header:?}");
    }
}

#[test]
fn compare_tells_how_far_images_are_apart() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.xml");
    for (name, seed) in [("a.exr", "1"), ("b.exr", "2")] {
        works(folder.path(), &["render", &cornell, "-n", "16", "--size", "32x32", "-o", name, "--seed", seed, "-q"]);
    }
    let json = |args: &[&str]| -> serde_json::Value { serde_json::from_str(&works(folder.path(), args)).unwrap() };
    let same = json(&["compare", "a.exr", "a.exr", "--json", "-"]);
    assert_eq!(
        (same["mse"].as_f64(), same["flip"].as_f64(), same["energy_ratio"].as_f64()),
        (Some(0.0), Some(0.0), Some(1.0))
    );
    let other = json(&["compare", "a.exr", "b.exr", "--json", "-", "--heatmap", "map.png"]);
    for key in ["mse", "rmse", "relmse", "mape", "flip", "max_abs"] {
        assert!(other[key].as_f64().unwrap() > 0.0, "{key} in {other}");
    }
    assert!((other["energy_ratio"].as_f64().unwrap() - 1.0).abs() < 0.2);
    assert_eq!(read_image(&folder.path().join("map.png")).unwrap().width, 32);
    works(folder.path(), &["render", &cornell, "-n", "1", "--size", "8x8", "-o", "small.exr", "-q"]);
    assert!(fails(folder.path(), &["compare", "a.exr", "small.exr"], 2).contains("32x32"));
    assert!(fails(folder.path(), &["compare", "a.exr", "none.exr"], 2).contains("none.exr"));
}

#[test]
fn time_limits_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let started = Instant::now();
    let json = works(
        folder.path(),
        &["render", &scene("cornell.xml"), "-t", "1.5", "--size", "64x64", "-o", "a.png", "--json", "-"],
    );
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(json["spp"].as_u64().unwrap() >= 1);
    let render = json["seconds"]["render"].as_f64().unwrap();
    assert!((1.2..4.0).contains(&render), "{render} s");
    assert!(started.elapsed() < Duration::from_secs(20));
}

/// However short the time is, there is an image: each pixel has a sample, and chains have begun.
#[test]
fn no_time_is_too_short() {
    let folder = tempfile::tempdir().unwrap();
    for technique in ["path", "light", "mlt", "radiosity:patches=8"] {
        let args = ["-t", "0.001", "--size", "64x64", "-o", "a.png", "--json", "-", "-i", technique];
        let json = works(folder.path(), &[&["render", &scene("cornell.xml")][..], &args].concat());
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        let green = json["mean"][1].as_f64().unwrap();
        assert!(json["spp"].as_u64().unwrap() >= 1 && (0.1..0.3).contains(&green), "{technique}: {json}");
    }
}

/// Ctrl-C keeps what was rendered and says so, whatever a technique keeps beside the film.
#[test]
fn an_interrupt_keeps_the_image() {
    for technique in ["path", "light", "photon", "mlt:candidates=4096", "radiosity:patches=4"] {
        interrupt(technique);
    }
}

fn interrupt(technique: &str) {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.xml");
    let args = ["render", &cornell, "-i", technique, "-n", "1000000", "--size", "64x64", "-o", "a.exr"];
    let mut child = program(folder.path(), &args)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // The first line with samples says that the picture is under way; a slow machine says before that it compiles.
    let mut progress = std::io::BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("spp") {
        line.clear();
        let length = std::io::BufRead::read_line(&mut progress, &mut line).unwrap();
        assert!(length > 0, "{technique}: no progress");
    }
    let interrupted = Instant::now();
    // The shell's own `kill`: the program of that name is not on every machine.
    let signal = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &signal]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    let said = text(&output.stdout);
    assert!(said.starts_with("interrupted: what was rendered is kept"), "{technique}: {said}");
    assert!(interrupted.elapsed() < Duration::from_secs(3), "{technique}: {:?}", interrupted.elapsed());
    let image = read_image(&folder.path().join("a.exr")).unwrap();
    let [r, ..] = image.average();
    assert!((0.2..0.3).contains(&r), "{technique}: the picture should be nearly done: {r}");
}

#[test]
fn list_devices_and_info_describe() {
    let folder = tempfile::tempdir().unwrap();
    let list = works(folder.path(), &["list"]);
    for row in lumbre::techniques::TECHNIQUES {
        assert!(list.contains(row.name) && list.contains(row.title), "{list}");
    }
    assert!(works(folder.path(), &["devices"]).contains("bvh"));
    let devices: serde_json::Value = serde_json::from_str(&works(folder.path(), &["devices", "--json"])).unwrap();
    assert_eq!(devices[0]["backends"].as_array().unwrap().len(), lumbre::layout::backend::BACKENDS.len());
    let info = works(folder.path(), &["info", &scene("cornell_spheres.xml")]);
    assert!(info.contains("2 spheres") && info.contains("dielectric"), "{info}");
}

/// Where light comes from, and which of it the technique cannot sample.
#[test]
fn info_tells_of_light() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"<scene version="3.0.0"><shape type="sphere"><bsdf type="dielectric"/></shape>
        <emitter type="point"><rgb name="intensity" value="1, 2, 0"/></emitter>
        <emitter type="point"><point name="position" x="0" y="3" z="0"/></emitter></scene>"#;
    std::fs::write(folder.path().join("hidden.xml"), scene).unwrap();
    for (args, warning) in [
        (
            "-i path",
            "path does not find caustics of points, spots, projectors and parallel light: the image lacks it; sampled by",
        ),
        ("-i photon", ""),
    ] {
        let args = ["info", "hidden.xml", "--json", "info.json"].into_iter().chain(args.split_whitespace());
        let output = lumbre(folder.path(), &args.collect::<Vec<_>>());
        let said = text(&output.stderr);
        assert_eq!(said.contains("does not find"), !warning.is_empty(), "{said}");
        assert!(output.status.success() && said.contains(warning), "{said}");
        let printed = text(&output.stdout);
        assert!(printed.contains("power      point       25.13274 37.69911 12.56637 W, from 2"), "{printed}");
        let json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.path().join("info.json")).unwrap()).unwrap();
        assert_eq!(json["power"]["point"]["count"], 2);
        assert_eq!(json["sampling"]["misses"].is_string(), !warning.is_empty());
    }
}

#[test]
fn bad_commands_name_what_is_valid() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::create_dir(here.join("folder.exr")).unwrap();
    let cornell = scene("cornell.xml");
    let render = |args: &[&str]| {
        let args: Vec<&str> = ["render", &cornell].into_iter().chain(args.iter().copied()).collect();
        fails(here, &args, 2)
    };
    let (last, names) = TECHNIQUES.split_last().unwrap();
    let all = names.iter().map(|row| row.name).collect::<Vec<_>>().join(", ");
    assert!(render(&["-i", "bogus"]).contains(&format!("{all} or {}", last.name)));
    assert!(render(&["-i", "direct:sampling=bogus"]).contains("mis, emitter or bsdf"));
    assert!(render(&["-i", "direct:bogus=1"]).contains("valid are sampling"));
    assert!(render(&["-i", "path-implicit:q=2"]).contains("0 to 0.99"));
    assert!(render(&["-i", "direct:sampling"]).contains("name=value"));
    assert!(render(&["--rr-q", "0.5", "-i", "path"]).contains("has no parameter 'q'"));
    assert!(render(&["--backend", "bogus"]).contains("auto, ray-query or bvh"));
    assert!(render(&["--device", "bogus"]).contains("no device 'bogus'"));
    assert!(render(&["--device", "99"]).contains("no device '99'"));
    assert!(render(&["--camera", "bogus"]).contains("no camera 'bogus'"));
    assert!(render(&["-n", "-4"]).contains("-4"));
    assert!(render(&["-n", "0"]).contains('0'));
    assert!(render(&["-n", "many"]).contains("many"));
    assert!(render(&["-t", "-1"]).contains("above 0"));
    assert!(render(&["--size", "0x10"]).contains("1 to 65536"));
    assert!(render(&["--size", "10"]).contains("WIDTHxHEIGHT"));
    assert!(render(&["--max-depth", "-2"]).contains("-1 for no limit"));
    assert!(render(&["--lengths=99"]).contains("99"));
    assert!(render(&["--strategies"]).contains("it is valid with bdpt"));
    assert!(render(&["--strategies=7"]).contains("1..=6"));
    assert!(render(&["--aov", "bogus", "-o", "a.exr"]).contains("valid are variance, samples, albedo, "));
    assert!(render(&["--lengths", "-o", "a.png"]).contains(".exr"));
    assert!(render(&["-o", "a.gif"]).contains(".exr or .png"));
    assert!(render(&["-o", "nowhere/a.exr"]).contains("nowhere"));
    assert!(render(&["-o", "folder.exr"]).contains("it is a folder"));
    assert!(render(&["--json", "nowhere/a.json"]).contains("nowhere"));
    assert!(render(&["-D", "bogus=1"]).contains("max_depth, size and spp"));
    assert!(render(&["-D", "size"]).contains("NAME=VALUE"));
    assert!(render(&["-D", "size=big"]).contains("cornell.xml"));
    assert!(render(&["-D", "size=0"]).contains("1 to 65536"));
    assert!(render(&["--bogus"]).contains("--bogus"));
    assert!(fails(here, &["bogus"], 2).contains("bogus"));
    assert!(fails(here, &["render"], 2).contains("<SCENE>"));
    assert!(fails(here, &["render", "none.xml"], 2).contains("none.xml"));
    assert!(fails(here, &["render", "none.blend"], 2).contains("none.blend"));
    let files = std::fs::read_dir(here).unwrap().count();
    assert_eq!(files, 1, "nothing may be written by a command that is refused");
}

/// A name that promises another sort of file than what would be written to it is refused before any work, by every command that writes files; and so
/// are two outputs of one name.
#[test]
fn names_of_outputs_say_what_they_hold() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let cornell = scene("cornell.xml");
    let render = ["render", &cornell, "-o", "a.png"];
    let cases: [(&[&str], &[&str], &str); 25] = [
        (&render, &["--checkpoint", "out.jpg"], "out.jpg would be a checkpoint, and .jpg is the extension of an image"),
        (&render, &["--checkpoint", "out.XML"], "valid is out.ckpt, or a name without extension"),
        (&render, &["--checkpoint", "-"], "- is standard output, and a checkpoint is read again"),
        (
            &render,
            &["--json", "out.exr"],
            "out.exr would be JSON, and .exr is the extension of an image: valid is out.json",
        ),
        (&render, &["--json", "b.png"], "would be JSON"),
        (&render, &["--record", "out.svg"], "out.svg would be a folder"),
        (&render, &["-o", "a.png"], "a.png is to be two outputs"),
        (&render, &["--json", "c", "--checkpoint", "c"], "c is to be two outputs"),
        (&render, &["-o", "./a.png"], "./a.png is to be two outputs"),
        (&render, &["--record", "d", "--json", "d/frame.json"], "d/frame.json is to be two outputs"),
        (&render, &["--record", "-"], "'-' would be a folder"),
        (&render, &["-o", "-", "--json", "-"], "standard output takes one output"),
        (&["rays", &cornell], &["--export", "out.png"], "out.png would be triangles and rays"),
        (&["rays", &cornell], &["--export", "-", "--json", "-"], "standard output takes one output"),
        (&["trace", &cornell, "--pixel", "1,1"], &["--svg", "out.json"], "out.json would be an SVG"),
        (&["trace", &cornell, "--pixel", "1,1"], &["--svg", "-", "--json", "-"], "standard output takes one output"),
        (&["reference", &cornell], &["-o", "out.jpg"], "out.jpg: a reference is an .exr"),
        (&["reference", &cornell], &["-o", "out.exr", "--json", "out.csv"], "out.csv would be JSON"),
        (&["compare", "a.exr", "b.exr"], &["--heatmap", "-"], "-: a heat map is a .png"),
        (&["compare", "a.exr", "b.exr"], &["--json", "out.png"], "out.png would be JSON"),
        (&["info", &cornell], &["--json", "out.obj"], "out.obj would be JSON, and .obj is the extension of a scene"),
        (&["verify", "--case", "output"], &["-o", "out.json"], "out.json would be a folder"),
        (
            &["bench", &cornell],
            &["-o", "out.html"],
            "out.html would be a folder, and .html is the extension of a document: valid is out",
        ),
        (&["man"], &["out.pdf"], "out.pdf would be a folder"),
        (&["man"], &["-"], "'-' would be a folder"),
    ];
    for (command, more, expected) in cases {
        let said = fails(here, &[command, more].concat(), 2);
        assert!(said.contains(expected), "{command:?} {more:?}: {said}");
    }
    assert_eq!(std::fs::read_dir(here).unwrap().count(), 0, "nothing may be written by a command that is refused");
}

/// What is written to standard output is all that is there.
#[test]
fn standard_output_takes_rays_and_plans() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.xml");
    let rays = ["rays", &cornell, "--size", "8x8", "--repeats", "1", "--backend", "bvh", "--export"];
    works(folder.path(), &[&rays[..], &["a.rays"]].concat());
    let piped = lumbre(folder.path(), &[&rays[..], &["-"]].concat()).stdout;
    assert!(piped == std::fs::read(folder.path().join("a.rays")).unwrap(), "{}", text(&piped));
    let plan = works(folder.path(), &["trace", &cornell, "--size", "8x8", "--pixel", "4,4", "--svg", "-"]);
    assert!(roxmltree::Document::parse(&plan).is_ok(), "{plan}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// Without a driver there is one clear line, not a crash.
#[test]
fn no_device_is_a_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let output = program(folder.path(), &["render", &scene("cornell.xml"), "-o", "a.png"])
        .env("VK_DRIVER_FILES", "/nonexistent.json")
        .env("VK_ICD_FILENAMES", "/nonexistent.json")
        .output()
        .unwrap();
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.lines().any(|line| line.starts_with("error: ") && line.contains("driver")), "{errors}");
    assert!(!folder.path().join("a.png").exists());
}

/// A file that cannot be replaced stays as it was.
#[test]
fn outputs_are_replaced_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    std::fs::write(&path, "old").unwrap();
    fails(folder.path(), &["render", &scene("cornell.xml"), "-o", "a.png", "-D", "bogus=1"], 2);
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    works(folder.path(), &["render", &scene("cornell.xml"), "-o", "a.png", "-n", "1", "--size", "8x8", "-q"]);
    assert_eq!(read_image(&path).unwrap().width, 8);
}

/// From the command to a first picture in under a second on a warm machine; the bound leaves room for a cold one.
#[test]
fn a_first_picture_comes_quickly() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["render", &scene("cornell.xml"), "-n", "1", "--size", "64x64", "-o", "a.png", "-q"];
    works(folder.path(), &args);
    let started = Instant::now();
    works(folder.path(), &args);
    println!("{:?} from the command to its file", started.elapsed());
    assert!(started.elapsed() < Duration::from_secs(3), "{:?}", started.elapsed());
}

/// Radiosity says what it makes of other materials and how its patches fare, on the summary and as JSON; other techniques do not.
#[test]
fn radiosity_reports_its_patches() {
    let folder = tempfile::tempdir().unwrap();
    let spheres = scene("cornell_spheres.xml");
    let render = |technique: &str, more: &[&str]| {
        let all = [&["render", &spheres, "-i", technique, "-n", "2", "--size", "16x16", "-o", "a.exr"], more].concat();
        lumbre(folder.path(), &all)
    };
    let output = render("radiosity:patches=8", &[]);
    let (said, summary) = (text(&output.stderr), text(&output.stdout));
    assert!(said.contains("takes for diffuse") && said.contains("'glass' (dielectric)"), "{said}");
    assert!(summary.contains("patches    ") && summary.contains("form factors sum to"), "{summary}");
    let json = |technique: &str| -> serde_json::Value {
        serde_json::from_str(&text(&render(technique, &["--json", "-", "-q"]).stdout)).unwrap()
    };
    let patches = &json("radiosity:patches=8")["patches"];
    assert!(patches["residual"].as_f64().unwrap() < 1e-5 && patches["row_sums"][2].as_f64() == Some(1.0), "{patches}");
    assert!(json("path")["patches"].is_null());
    assert!(fails(folder.path(), &["render", &spheres, "-i", "radiosity:solver=guess"], 2).contains("gather or shoot"));
}

#[test]
fn verify_measures_a_case_and_leaves_its_images() {
    let folder = tempfile::tempdir().unwrap();
    let table =
        works(folder.path(), &["verify", "--short", "--case", "output", "--backend", "bvh", "--json", "a.json"]);
    assert!(table.contains("output") && table.contains("pass") && table.contains("0 beyond them;"), "{table}");
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(folder.path().join(name)).unwrap()).unwrap()
    };
    let json = read("a.json");
    assert_eq!(json, read("verify-output/verify.json"));
    assert_eq!((&json["schema"], &json["verdict"]), (&"lumbre-verify-1".into(), &"pass".into()));
    let case = &json["cases"][0];
    assert_eq!((&case["case"], &case["backend"]), (&"output".into(), &"bvh".into()));
    for key in ["technique", "what", "figure", "bound", "worst", "verdict"] {
        assert!(!case["figures"][0][key].is_null(), "no '{key}' in {case}");
    }
    assert!(folder.path().join(case["files"][0].as_str().unwrap()).exists(), "{case}");
}

#[test]
fn verify_refuses_what_makes_no_sense() {
    let folder = tempfile::tempdir().unwrap();
    let fails = |args: &[&str]| fails(folder.path(), &[&["verify", "--short"], args].concat(), 2);
    assert!(fails(&["--case", "teapot"]).contains("no case 'teapot': valid are furnace, "));
    assert!(fails(&["--backend", "embree"]).contains("no backend 'embree': valid are auto, ray-query or bvh"));
    assert!(fails(&["--json", "none/a.json"]).contains("none/a.json"));
    std::fs::write(folder.path().join("file"), "").unwrap();
    assert!(fails(&["--case", "output", "-o", "file/out"]).contains("cannot write file/out"));
    let list = works(folder.path(), &["verify", "--list"]);
    assert!(list.contains("watertight") && list.contains("bound: ") && list.contains("source: "), "{list}");
}

/// Where a technique has nothing to do, or cannot do all, it says so before it renders.
#[test]
fn what_is_not_found_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let camera = |eye: &str| {
        format!(
            "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'>
             <lookat origin='{eye}' target='0, 0, 0' up='0, 1, 0'/></transform></sensor>
             <shape type='rectangle'><transform name='to_world'><translate z='-2'/></transform><bsdf type='diffuse'/></shape>"
        )
    };
    let (outside, inside) = (camera("0, 0, 5"), camera("0, 0, 0.5"));
    let ball = "<shape type='sphere'><bsdf type='dielectric'/></shape>";
    let point = "<emitter type='point'><point name='position' x='1' y='3' z='3'/></emitter>";
    let lamp = "<shape type='sphere'><point name='center' x='1' y='3' z='3'/><float name='radius' value='0.5'/>
        <emitter type='area'><rgb name='radiance' value='9'/></emitter></shape>";
    let told = |technique: &str, elements: &[&str]| {
        std::fs::write(folder.path().join("a.xml"), format!("<scene version='3.0.0'>{}</scene>", elements.concat()))
            .unwrap();
        let args = ["render", "a.xml", "-i", technique, "-n", "1", "--size", "8x8", "-o", "a.exr"];
        let output = program(folder.path(), &args).output().unwrap();
        assert!(output.status.success(), "{technique}: {}", text(&output.stderr));
        text(&output.stderr)
    };
    let within = "the camera stands within smooth glass: light shows it nothing that lies outside";
    for (technique, elements, expected) in [
        ("path", [&outside, ball, point], "path does not find caustics of points"),
        (
            "bdpt",
            [&outside, ball, point],
            "bdpt does not find caustics of points, spots, projectors and parallel light that the camera sees by way of mirrors",
        ),
        ("vcm:form=bpt", [&outside, ball, point], "vcm does not find caustics"),
        ("vcm:form=bpm", [&outside, ball, point], ""),
        ("path-implicit", [&outside, "", point], "path-implicit does not find the light of points"),
        (
            "light",
            [&outside, ball, lamp],
            "light does not find the background as the camera sees it, and whatever it sees by way of mirrors",
        ),
        ("light", [&outside, "", lamp], ""),
        ("light", [&inside, ball, lamp], within),
        ("bdpt", [&outside, "", point], ""),
        ("vcm", [&outside, ball, point], ""),
        ("photon", [&outside, ball, point], ""),
        ("light", [&outside, "", ""], "the scene has no light: a white sky of radiance 1 stands in"),
    ] {
        let said = told(technique, &elements);
        let what = format!("{technique}, {elements:?}: {said}");
        assert!(said.contains(expected), "{what}");
        assert_eq!(said.contains("warning"), !expected.is_empty(), "{what}");
        assert!(said.contains(within) == (expected == within), "{what}");
    }
}
