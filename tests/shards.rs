//! Shards of a rendering, merged: the bits of one run where that is promised, and by name what does not belong together.

use std::path::Path;

use crate::common::has_time;
use crate::common::program::{fails, figures, lumbre, render, start, wait_for, works};
use lumbre::bench::results::Results;
use lumbre::checkpoint::{self, Checkpoints};
use lumbre::image::{Picture, read_picture};

/// Samples of one run: the last block is not whole.
const SAMPLES: u32 = 500;

/// A command of `lumbre merge` in a folder.
fn merge(folder: &Path, args: &str) -> std::process::Command {
    let mut command = lumbre();
    command.arg("merge").args(args.split_whitespace()).current_dir(folder);
    command
}

/// `lumbre render` of a small image of the Cornell box.
fn small(folder: &Path, args: &str) -> std::process::Command {
    render(folder, "cornell.xml", &format!("--size 8x8 -q {args}"))
}

/// All values of an image and its layers, by their bits.
fn bits(path: &Path) -> Vec<(String, Vec<u32>)> {
    let Picture { image, layers, .. } = read_picture(path).unwrap();
    let bits = |pixels: &[[f32; 3]]| pixels.iter().flatten().map(|value| value.to_bits()).collect();
    let layers = layers.iter().map(|layer| (layer.name.clone(), bits(&layer.image.pixels)));
    std::iter::once((String::new(), bits(&image.pixels))).chain(layers).collect()
}

/// Names of the checkpoints of all shards.
fn names(prefix: &str, shards: u32) -> String {
    (1..=shards).rev().map(|number| format!("{prefix}{number} ")).collect()
}

/// Shards have the bits of one run: the image, its layers and variance, and all figures; and what goes on from them has those of a run that
/// went on.
#[test]
fn merged_shards_have_the_bits_of_one_run() {
    let cases = ["path", "light", "bdpt --strategies=2", "photon", "path --lengths=3 --sampler independent", "vcm"];
    for technique in cases.into_iter().take(if has_time() { 6 } else { 4 }) {
        let shards = if has_time() || technique == "path" { 8 } else { 3 };
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let args = format!("-i {technique} --seed 3 --aov variance");
        works(small(folder, &format!("{args} -n {SAMPLES} -o one.exr --json one.json --checkpoint one")));
        for number in 1..=shards {
            let shard = format!("--shard {number}/{shards} --checkpoint s{number}");
            works(small(folder, &format!("-i {technique} --seed 3 -n {SAMPLES} {shard}")));
        }
        works(merge(folder, &format!("{} -o merged -o merged.exr -q", names("s", shards))));
        let on = |samples: u32, from: &str, to: &str| {
            let files = format!("--checkpoint {from} --resume -o {to}.exr --json {to}.json");
            works(small(folder, &format!("{args} -n {samples} {files}")));
        };
        on(SAMPLES, "merged", "again");
        assert!(bits(&folder.join("one.exr")) == bits(&folder.join("again.exr")), "{technique}: not the same bits");
        let [one, again] = ["one", "again"].map(|name| figures(&folder.join(format!("{name}.json"))));
        assert_eq!(one, again, "{technique}");
        let merged = bits(&folder.join("merged.exr"));
        let of_film = bits(&folder.join("one.exr")).into_iter().filter(|(name, _)| name != "variance");
        assert!(of_film.eq(merged), "{technique}: the image by itself differs");
        if technique != "path" {
            continue;
        }
        on(SAMPLES + 20, "merged", "further");
        on(SAMPLES + 20, "one", "longer");
        assert!(
            bits(&folder.join("longer.exr")) == bits(&folder.join("further.exr")),
            "{technique}: it went on otherwise"
        );
    }
}

/// A shard that is killed half-way and resumed is the shard that was not.
#[test]
fn a_killed_shard_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line = |of: &str, more: &str| small(folder, &format!("-n 40000 --shard {of} {more}"));
    for number in [1, 2] {
        works(line(&format!("{number}/2"), &format!("--checkpoint whole{number}")));
    }
    let killed = "--checkpoint killed --checkpoint-interval 0.01 --resume";
    let mut child = start(line("2/2", killed));
    wait_for(&folder.join("killed"));
    child.kill().unwrap();
    child.wait().unwrap();
    let said = fails(merge(folder, "whole1 killed -o early.exr"), 2);
    assert!(said.contains("killed is not finished") && said.contains("of the 20032 samples of shard 2/2"), "{said}");
    // Its checkpoint is of that shard, and of no other.
    let said = fails(line("1/2", "--checkpoint killed --resume"), 2);
    assert!(said.contains("shard (2/2 of 40000 samples there, 1/2 of 40000 samples asked for)"), "{said}");
    works(line("2/2", killed));
    for shard in ["whole2", "killed"] {
        works(merge(folder, &format!("whole1 {shard} -q -o {shard}.exr")));
    }
    assert!(bits(&folder.join("whole2.exr")) == bits(&folder.join("killed.exr")));
}

/// What does not belong together is refused, by the name of the file or of the shard.
#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let shard = |name: &str, of: &str, more: &str| {
        works(small(folder, &format!("-n 256 --shard {of} --checkpoint {name} -o {name}.exr {more}")));
    };
    for number in 1..=4 {
        shard(&format!("s{number}"), &format!("{number}/4"), "");
    }
    shard("seed", "2/4", "--seed 1");
    shard("technique", "2/4", "-i direct");
    let other = "--size 9x8 -q -n 256 --shard 2/4 --checkpoint size -o size.exr";
    works(render(folder, "cornell.xml", other));
    shard("finer", "2/3", "");
    works(small(folder, "-n 512 --shard 2/4 --checkpoint more -o more.exr"));
    works(render(folder, "veach_mis.xml", "--size 8x8 -q -n 256 --shard 2/4 --checkpoint scene -o scene.exr"));
    works(small(folder, "-n 256 --checkpoint alone -o alone.exr"));
    std::fs::copy(folder.join("s2"), folder.join("twice")).unwrap();
    std::fs::copy(folder.join("s2.exr"), folder.join("twice.exr")).unwrap();
    let mut damaged = std::fs::read(folder.join("s2")).unwrap();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    std::fs::write(folder.join("damaged"), damaged).unwrap();
    // $ is what the names of images end with.
    let cases = [
        ("s1 seed s3 s4", "seed$ is not of the same rendering as s1$; what differs is seed (1 there, 0 here)"),
        ("s1 technique s3 s4", "technique$ is not of the same rendering as s1$; what differs is technique ("),
        ("s1 size s3 s4", "size$ is not of the same rendering as s1$; what differs is size (9x8 there, 8x8 here)"),
        ("s1 scene s3 s4", "scene$ is not of the same rendering as s1$; what differs is scene ("),
        ("s1 finer s3 s4", "finer$ is shard 2/3 of 256 samples per pixel, and s1$ shard 1/4 of 256"),
        ("s1 more s3 s4", "more$ is shard 2/4 of 512 samples per pixel, and s1$ shard 1/4 of 256"),
        ("s1 s2 twice s3 s4", "s2$ and twice$ are both shard 2/4"),
        ("s1 s4", "shards 2/4 and 3/4 are missing"),
        ("s2 s3 s4", "shard 1/4 is missing"),
        ("s1 alone s3 s4", "alone$ is no shard"),
    ];
    for suffix in ["", ".exr"] {
        for (files, expected) in cases {
            let listed: String = files.split(' ').map(|file| format!("{file}{suffix} ")).collect();
            let said = fails(merge(folder, &format!("{listed} -o merged.exr")), 2);
            assert!(said.contains(&expected.replace('$', suffix)), "{files}: {said}");
        }
    }
    let said = fails(merge(folder, "s1 damaged s3 s4 -o merged.exr"), 2);
    assert!(said.contains("damaged: it is damaged or cut short"), "{said}");
    let said = fails(merge(folder, "s1 s2.exr s3 s4 -o merged.exr"), 2);
    assert!(said.contains("s1 is a checkpoint, and s2.exr an image"), "{said}");
    let said = fails(merge(folder, "s1.exr s2.exr s3.exr s4.exr -o merged"), 2);
    assert!(said.contains("no checkpoint can be made"), "{said}");
    // A checkpoint has no name that promises something else.
    for (output, expected) in [
        ("merged.jpg", "merged.jpg: .jpg is the extension of an image; valid outputs of checkpoints are .exr and .png"),
        ("merged.json", "merged.json: .json is the extension of JSON; valid outputs"),
        ("merged.exr -o merged.exr", "merged.exr is to be two outputs"),
    ] {
        let said = fails(merge(folder, &format!("s1 s2 s3 s4 -o {output}")), 2);
        assert!(said.contains(expected), "{output}: {said}");
    }
    assert!(!folder.join("merged.jpg").exists() && !folder.join("merged.json").exists());
    assert!(!folder.join("merged.exr").exists() && !folder.join("merged").exists());
    let said = fails(small(folder, "-n 256 --shard 1/5 --checkpoint f"), 2);
    assert!(said.contains("valid is N up to 4, or -n from 257 on"), "{said}");
    let said = fails(small(folder, "-n 256 --shard 1/4"), 2);
    assert!(said.contains("give --checkpoint FILE"), "{said}");
}

/// Images are weighted by their samples: shards of 2, 1 and 1 blocks have the mean of one run, to rounding.
#[test]
fn images_merge_by_their_samples() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    works(small(folder, "-n 256 -o one.exr --aov variance,samples,albedo,object_id"));
    for number in 1..=3 {
        let layers = "--aov variance,samples,albedo,object_id";
        works(small(folder, &format!("-n 256 --shard {number}/3 -o s{number}.exr {layers}")));
    }
    works(merge(folder, "s1.exr s2.exr s3.exr -q -o merged.exr"));
    let [one, merged] = ["one.exr", "merged.exr"].map(|name| read_picture(&folder.join(name)).unwrap());
    let off = |a: &[[f32; 3]], b: &[[f32; 3]]| {
        let apart = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs() / a.abs().max(1e-6));
        apart.fold(0.0, f32::max)
    };
    assert!(off(&one.image.pixels, &merged.image.pixels) < 1e-6);
    for (own, other) in one.layers.iter().zip(&merged.layers) {
        assert_eq!(own.name, other.name);
        // The variance of few samples is an estimate: that of the parts is another one. And each shard has AOVs of its own.
        let bound = match own.name.as_str() {
            "variance" => 3.0,
            "albedo" => 0.2,
            "object_id" => continue,
            _ => 0.0,
        };
        let found = off(&own.image.pixels, &other.image.pixels);
        assert!(found <= bound, "{}: {found}", own.name);
    }
    let objects =
        |picture: &Picture| picture.layers.iter().find(|layer| layer.name == "object_id").unwrap().image.clone();
    assert!(objects(&merged) == objects(&read_picture(&folder.join("s1.exr")).unwrap()), "numbers have no mean");
    let find = |name: &str| merged.header.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str());
    assert_eq!((find("lumbre.spp"), find("lumbre.shard"), find("lumbre.identity")), (Some("256"), None, None));
    // What is said of the whole is true of it.
    let all = [1, 2, 3].map(|number| attributes(&folder.join(format!("s{number}.exr"))));
    let whole = attributes(&folder.join("merged.exr"));
    assert_eq!(whole["shards"], 3);
    let sum = |of: fn(&Attributes) -> f64| all.iter().map(of).sum::<f64>();
    assert_eq!(whole["rays"].as_f64(), Some(sum(|one| one["rays"].as_f64().unwrap())));
    for part in ["load", "render", "total"] {
        let total: f64 = all.iter().map(|one| one["seconds"][part].as_f64().unwrap()).sum();
        assert!((whole["seconds"][part].as_f64().unwrap() - total).abs() < 1e-9, "{part}");
    }
    let most = all.iter().map(|one| one["peak_device_bytes"].as_u64().unwrap()).max();
    assert_eq!(whole["peak_device_bytes"].as_u64(), most);
    let mean = |index: usize| whole["mean"][index].as_f64().unwrap();
    assert!((0..3).all(|index| (mean(index) - merged.image.average()[index]).abs() < 1e-9));
    for name in ["device", "driver", "seed", "kernels", "sampler", "object_names"] {
        assert_eq!(whole[name], all[0][name], "{name}");
    }
    assert!(!whole.contains_key("estimated_relmse"), "that of a shard is not that of the whole");
}

/// What an image's header says, by the name without its prefix.
type Attributes = serde_json::Map<String, serde_json::Value>;

fn attributes(path: &Path) -> Attributes {
    let of = |(name, text): (String, String)| {
        let value = serde_json::from_str(&text).unwrap_or(serde_json::Value::String(text));
        (name.trim_start_matches("lumbre.").to_owned(), value)
    };
    read_picture(path).unwrap().header.into_iter().map(of).collect()
}

/// The image of checkpoints says on which devices they were rendered, how many they are, and nothing that only one of them knows.
#[test]
fn merged_checkpoints_name_all_devices() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for number in 1..=3 {
        works(small(folder, &format!("-n 192 --shard {number}/3 --checkpoint s{number} -o s{number}.exr")));
    }
    // The second as if it came from elsewhere.
    let (mut header, mut saved, state) = checkpoint::read(&folder.join("s2")).unwrap();
    let device = header.about["settings"]["device"].as_str().unwrap().to_owned();
    let identity = serde_json::to_string(&header.identity).unwrap().replace(&device, "another");
    header.identity = serde_json::from_str(&identity).unwrap();
    header.about["settings"]["device"] = "another".into();
    Checkpoints::open(&folder.join("moved")).unwrap().save_film(&header, &mut saved, &state).unwrap();
    let said = works(merge(folder, "s3 moved s1 -o merged.exr"));
    assert!(said.contains("shards are of different devices"), "{said}");
    let whole = attributes(&folder.join("merged.exr"));
    assert_eq!(whole["device"].as_str(), Some(format!("{device}; another").as_str()));
    assert_eq!((&whole["shards"], whole.get("shard"), whole.get("peak_device_bytes")), (&3.into(), None, None));
    let all = [1, 2, 3].map(|number| attributes(&folder.join(format!("s{number}.exr"))));
    let total: f64 = all.iter().map(|one| one["seconds"]["render"].as_f64().unwrap()).sum();
    assert!((whole["seconds"]["render"].as_f64().unwrap() - total).abs() < 1e-6 * total, "{:?}", whole["seconds"]);
    assert!(whole["seconds"].get("load").is_none(), "{:?}", whole["seconds"]);
    assert_eq!((&whole["driver"], &whole["kernels"]), (&all[0]["driver"], &all[0]["kernels"]));
}

/// Chains are a shard's own: the merged image is that of one run within what their brightness is known to, it is said, and there is no checkpoint.
#[test]
fn chains_merge_statistically() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let technique = "-i mlt:chains=64:candidates=16384 -n 256";
    works(small(folder, &format!("{technique} -o one.exr")));
    for number in 1..=4 {
        works(small(folder, &format!("{technique} --shard {number}/4 --checkpoint s{number}")));
    }
    let said = works(merge(folder, "s1 s2 s3 s4 -o merged.exr"));
    assert!(said.contains("statistically equal to one run"), "{said}");
    let [one, merged] = ["one.exr", "merged.exr"].map(|name| read_picture(&folder.join(name)).unwrap());
    let mean = |picture: &Picture| picture.image.average().iter().sum::<f64>();
    let ratio = mean(&merged) / mean(&one);
    assert!((ratio - 1.0).abs() < 0.05 && one.image != merged.image, "{ratio}");
    let said = fails(merge(folder, "s1 s2 s3 s4 -o merged"), 2);
    assert!(said.contains("there is none to go on with"), "{said}");
}

/// Benches of other seeds are one bench of all of them, by its figures; what is of another bench, or there twice, is refused.
#[test]
fn benches_merge_by_their_seeds() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |args: &str| {
        let mut command = lumbre();
        command.args(args.split_whitespace()).current_dir(folder);
        if let Ok(device) = std::env::var("LUMBRE_TEST_DEVICE") {
            command.args(["--device", &device]);
        }
        works(command);
    };
    let scene = crate::common::scene_path("cornell.xml").display().to_string();
    run(&format!("reference {scene} --size 16x16 -t 1 -o truth.exr"));
    let bench = |args: &str| run(&format!("bench {scene} --size 16x16 -i path --reference truth.exr -q {args}"));
    bench("-n 8 --seeds 4 -o whole");
    bench("-n 8 --seeds 2 -o a");
    bench("-n 8 --seeds 2 --first-seed 2 -o b");
    bench("-n 4 --seeds 2 --first-seed 2 -o other");
    works(merge(folder, "b a -q -o both"));
    let [whole, both] = ["whole", "both"].map(|name| Results::read(&folder.join(name).join("results.json")).unwrap());
    assert_eq!((both.seeds, both.scenes[0].variants.len()), (4, 1));
    for (own, other) in whole.scenes[0].variants.iter().zip(&both.scenes[0].variants) {
        assert_eq!(other.runs.iter().map(|run| run.seed).collect::<Vec<_>>(), [0, 1, 2, 3]);
        let ends = [own, other].map(|variant| variant.curve.last().unwrap());
        let [mine, its] = ends.map(|end| (end.spp, end.relmse.mean, end.relmse.low, end.flip.mean));
        assert_eq!(mine, its, "{}", own.name);
        assert_eq!(own.floor.relmse, other.floor.relmse, "{}", own.name);
    }
    assert!(folder.join("both/index.html").exists());
    let cases = [
        ("a ./a", "a and ./a both have seed 0 of path on"),
        ("a other", "other is not of the same bench as a: samples of a run (Some(4) there, Some(8) here)"),
        ("a truth.exr", "a is a bench's folder, and truth.exr an image"),
    ];
    for (inputs, expected) in cases {
        let said = fails(merge(folder, &format!("{inputs} -o refused")), 2);
        assert!(said.contains(expected), "{inputs}: {said}");
    }
    let said = fails(merge(folder, "a b -o both"), 2);
    assert!(said.contains("both holds a bench already"), "{said}");
}
