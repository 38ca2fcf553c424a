//! `lumbre bench` as a user runs it: what it writes, that it goes on after an interruption, and what it refuses.

use std::path::Path;
use std::process::Output;

use lumbre::bench::results::Results;

fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).display().to_string()
}

fn lumbre(folder: &Path, args: &[&str]) -> Output {
    let mut command = crate::common::program::lumbre();
    command.args(args).current_dir(folder).env("XDG_CACHE_HOME", folder.join("cache"));
    if let Ok(device) = std::env::var("LUMBRE_TEST_DEVICE")
        && args[0] == "bench"
    {
        command.args(["--device", &device]);
    }
    command.output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a command that must fail with this status before anything is rendered, and say all of this.
fn refused(folder: &Path, args: &[&str], status: i32, expected: &[&str]) {
    let output = lumbre(folder, args);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{args:?}: {errors}");
    assert!(!errors.contains("panicked") && !errors.contains("run 1"), "{args:?}: {errors}");
    let line = errors.lines().find(|line| line.starts_with("error: ")).unwrap_or_else(|| panic!("{args:?}: {errors}"));
    for part in expected {
        assert!(line.contains(part), "{args:?}: '{part}' is not in '{line}'");
    }
}

#[test]
fn a_bench_writes_its_report_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let cornell = scene("cornell.xml");
    let args = [
        "bench",
        &cornell,
        "-i",
        "path,path-implicit",
        "--backend",
        "bvh",
        "--ablate",
        "lights=tree",
        "-n",
        "8",
        "--seeds",
        "2",
        "--size",
        "24x24",
        "--reference-time",
        "1",
        "-o",
        "out",
    ];
    let first = lumbre(folder.path(), &args);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let out = folder.path().join("out");
    let results = Results::read(&out.join("results.json")).unwrap();
    let names: Vec<&str> = results.scenes[0].variants.iter().map(|variant| variant.name.as_str()).collect();
    assert_eq!(
        names,
        ["path on bvh", "path on bvh, lights=tree", "path-implicit on bvh", "path-implicit on bvh, lights=tree"]
    );
    for variant in &results.scenes[0].variants {
        let spp: Vec<u64> = variant.runs[0].points.iter().map(|point| point.spp).collect();
        assert_eq!(spp, [1, 2, 4, 8], "{}", variant.name);
        assert_eq!(variant.runs.len(), 2);
        assert!(variant.last().unwrap().relmse.mean > 0.0 && variant.runs[0].nonfinite == 0);
    }
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    assert!(page.contains("path-implicit on bvh") && !page.contains("src=\"http"));
    assert!(out.join("results.csv").exists());

    // Without one of its runs it measures that one and keeps the others; the reference comes from the cache.
    std::fs::remove_file(out.join("runs/cornell-2-1.json")).unwrap();
    let again = lumbre(folder.path(), &args);
    let said = text(&again.stderr);
    assert!(again.status.success(), "{said}");
    assert_eq!(said.matches("measured before").count(), 7, "{said}");
    assert_eq!(said.matches("cornell: run ").count(), 1, "{said}");
    let repeated = Results::read(&out.join("results.json")).unwrap();
    assert_eq!(repeated.scenes[0].reference.origin, "cached");
    let errors = |results: &Results| -> Vec<f64> {
        let runs = results.scenes[0].variants.iter().flat_map(|variant| &variant.runs);
        runs.flat_map(|run| run.points.iter().map(|point| point.relmse)).collect()
    };
    assert_eq!(errors(&results), errors(&repeated));

    // Against itself nothing got worse; against one that was ten times as fast, it did.
    let same = lumbre(folder.path(), &["bench", "--against", "out/results.json", "-o", "out"]);
    assert!(same.status.success() && text(&same.stdout).contains("no significant change"), "{}", text(&same.stderr));
    let mut faster = repeated.clone();
    for point in
        faster.scenes[0].variants.iter_mut().flat_map(|variant| &mut variant.runs).flat_map(|run| &mut run.points)
    {
        point.seconds /= 10.0;
    }
    for (index, run) in faster.scenes[0].variants[0].runs.iter_mut().enumerate() {
        // Two runs that nearly agree, so that the difference is beyond noise whatever this machine did.
        run.points.iter_mut().for_each(|point| point.seconds = 1e-7 * (1.0 + 1e-3 * index as f64));
    }
    let mut slower = faster.clone();
    for run in &mut slower.scenes[0].variants[0].runs {
        run.points.iter_mut().for_each(|point| point.seconds *= 3.0);
    }
    for (name, results) in [("faster", &faster), ("slower", &slower)] {
        let target = folder.path().join(name);
        std::fs::create_dir(&target).unwrap();
        std::fs::write(target.join("results.json"), serde_json::to_string(results).unwrap()).unwrap();
    }
    let worse = lumbre(folder.path(), &["bench", "--against", "faster/results.json", "-o", "slower"]);
    assert_eq!(worse.status.code(), Some(1), "{}", text(&worse.stderr));
    assert!(text(&worse.stdout).contains("REGRESSION") && text(&worse.stderr).contains("worse than before"));
    refused(
        folder.path(),
        &["bench", &cornell, "-n", "2", "--size", "24x24", "-o", "out"],
        2,
        &["out holds another bench", "--fresh"],
    );
}

#[test]
fn bad_benches_are_refused_before_anything_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let cornell = scene("cornell.xml");
    let bench = |more: &[&str], status: i32, expected: &[&str]| {
        let mut args = vec!["bench", &cornell, "-o", "out", "--size", "16x16"];
        args.extend(more);
        refused(here, &args, status, expected);
    };
    bench(&["-i", "path,metropolis"], 2, &["no technique 'metropolis'", "path-implicit"]);
    bench(&["--backend", "bvh,cuda"], 2, &["no backend 'cuda'", "ray-query"]);
    bench(&["--ablate", "textures"], 2, &["no ablation 'textures'", "no-specialise"]);
    bench(&["-t", "0"], 2, &["-t", "above 0"]);
    bench(&["--reference-time", "0"], 2, &["--reference-time", "above 0"]);
    bench(&["--seeds", "1"], 2, &["--seeds", "2.."]);
    bench(&["--against", "old.json"], 2, &["old.json"]);
    bench(&["--reference", "none.exr"], 2, &["none.exr"]);
    std::fs::write(here.join("empty.exr"), "").unwrap();
    bench(&["--reference", "empty.exr"], 2, &["empty.exr"]);
    bench(&["--reference", "a.exr", "--reference", "b.exr"], 2, &["2 references for 1 scenes"]);
    let image = |name: &str, width: u32, value: f32| {
        let pixels = vec![[value; 3]; (width * 16) as usize];
        let image = lumbre::image::Image { width, height: 16, pixels };
        let picture = lumbre::image::Picture { image, layers: Vec::new(), header: Vec::new() };
        lumbre::image::write_picture(&here.join(name), &picture).unwrap();
    };
    image("wide.exr", 20, 1.0);
    bench(&["--reference", "wide.exr"], 2, &["wide.exr", "20x16", "16x16"]);
    image("nan.exr", 16, f32::NAN);
    bench(&["--reference", "nan.exr"], 2, &["nan.exr", "(0, 0)", "finite"]);
    image("black.exr", 16, 0.0);
    bench(&["--reference", "black.exr"], 2, &["black.exr", "black"]);
    std::fs::write(here.join("file"), "").unwrap();
    refused(here, &["bench", &cornell, "-o", "file/out"], 2, &["file/out"]);
    refused(here, &["bench", &cornell, "-o", "file"], 2, &["file"]);
    std::fs::write(here.join("other.json"), "{\"schema\": \"lumbre-rays-1\"}").unwrap();
    refused(here, &["bench", &cornell, "--against", "other.json"], 2, &["other.json", "lumbre-bench-2"]);
}
