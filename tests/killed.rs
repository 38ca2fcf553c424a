//! Renderings that are killed, at moments that chance chooses, and go on: the image has the bits of one that was not.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::common::has_time;
use crate::common::program::{errors, figures, files, render, signal, start, wait_for, works};
use lumbre::files::replace_file;
use lumbre::image::read_image;

/// Kills of each case: sixty in all where there is time, twenty-four where there is not.
fn kills_of_each() -> u32 {
    if has_time() { 5 } else { 2 }
}

/// Techniques with the samples per pixel that take some tenths of a second, and what else a film may hold.
const CASES: [&str; 12] = [
    "-i direct -n 6000 --seed 3",
    "-i whitted -n 6000",
    "-i path-implicit -n 3000 --sampler sobol",
    "-i path -n 2000 --lengths=3 --aov variance",
    "-i path-recursive -n 2000",
    "-i light -n 2000 --lengths=3",
    "-i bdpt -n 500 --strategies=3",
    "-i vcm -n 100 --seed 9",
    "-i photon -n 100",
    "-i mlt -n 1000 --seed 4",
    "-i radiosity:patches=8 -n 60",
    "-i path -e 0.0004",
];

fn pixels(path: &Path) -> Vec<u32> {
    read_image(path).unwrap().pixels.iter().flatten().map(|value| value.to_bits()).collect()
}

#[test]
fn kills_change_no_bit() {
    let mut random = 0x2545_f491_4f6c_dd1d_u64;
    let mut uniform = || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random >> 40) as f64 / f64::from(1 << 24)
    };
    let (mut kills, mut with_checkpoint) = (0, 0);
    for case in CASES {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let begun = Instant::now();
        works(render(folder, "cornell.xml", &format!("{case} --size 16x16 -o whole.exr --json whole.json")));
        let whole = begun.elapsed().as_secs_f64();
        let line =
            format!("{case} --size 16x16 -o a.exr --json a.json --checkpoint c --checkpoint-interval 0.001 --resume");
        let mut left = kills_of_each();
        while left > 0 {
            let mut child = start(render(folder, "cornell.xml", &line));
            std::thread::sleep(Duration::from_secs_f64(uniform() * whole));
            if child.try_wait().unwrap().is_some() {
                // Too late: it had ended. Another one begins.
                let output = child.wait_with_output().unwrap();
                assert!(output.status.success(), "{case}: {}", errors(&output));
                for name in ["c", "c.previous"] {
                    let _ = std::fs::remove_file(folder.join(name));
                }
                continue;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            (left, kills) = (left - 1, kills + 1);
            with_checkpoint += u32::from(folder.join("c").exists());
        }
        let said = works(render(folder, "cornell.xml", &line));
        assert!(!said.contains("warning"), "{case}: {said}");
        assert!(pixels(&folder.join("a.exr")) == pixels(&folder.join("whole.exr")), "{case}: other pixels");
        assert_eq!(figures(&folder.join("a.json")), figures(&folder.join("whole.json")), "{case}");
        let expected = ["a.exr", "a.json", "c", "c.previous", "whole.exr", "whole.json"];
        let left: Vec<String> = files(folder).into_iter().filter(|name| name != "c.previous").collect();
        assert_eq!(left, expected.into_iter().filter(|name| *name != "c.previous").collect::<Vec<_>>(), "{case}");
    }
    println!("{kills} kills, {with_checkpoint} of them with a checkpoint to go on from");
    assert!(kills >= 24 && 3 * with_checkpoint >= kills, "{kills} kills, {with_checkpoint} with a checkpoint");
}

/// SIGTERM is answered like Ctrl-C: image and checkpoint are written, the exit status is 0, and what goes on has the same bits. So does
/// what is asked for more samples than before.
#[test]
fn a_terminated_rendering_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line =
        |spp: u32, more: &str| render(folder, "cornell.xml", &format!("--size 32x32 -n {spp} --checkpoint c {more}"));
    works(line(6000, "-o whole.exr --json whole.json"));
    std::fs::remove_file(folder.join("c")).unwrap();
    let child = start(line(6000, "--checkpoint-interval 0.05 -o a.exr"));
    wait_for(&folder.join("c"));
    signal(&child, "TERM");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", errors(&output));
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("interrupted: what was rendered is kept"));
    assert!(pixels(&folder.join("a.exr")) != pixels(&folder.join("whole.exr")), "it was not interrupted");
    let said = works(line(6000, "--resume -o a.exr --json a.json"));
    assert!(said.starts_with("note: going on from c: "), "{said}");
    assert!(pixels(&folder.join("a.exr")) == pixels(&folder.join("whole.exr")));
    assert_eq!(figures(&folder.join("a.json")), figures(&folder.join("whole.json")));
    // More samples, from where it had ended; then fewer than there are, which changes nothing.
    works(line(7000, "--resume -o more.exr --json more.json"));
    works(render(folder, "cornell.xml", "--size 32x32 -n 7000 -o whole.exr --json whole.json"));
    assert!(pixels(&folder.join("more.exr")) == pixels(&folder.join("whole.exr")));
    works(line(100, "--resume -o more.exr --json more.json"));
    assert_eq!(figures(&folder.join("more.json")), figures(&folder.join("whole.json")));
}

/// With a time limit, the time before counts: what goes on takes what was left, and nothing where nothing was.
#[test]
fn time_before_a_kill_counts() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line = |more: &str| {
        render(folder, "cornell.xml", &format!("--size 32x32 --checkpoint c --json a.json -o a.exr {more}"))
    };
    let child = start(line("-t 60 --checkpoint-interval 0.2"));
    wait_for(&folder.join("c.previous"));
    signal(&child, "KILL");
    child.wait_with_output().unwrap();
    works(line("-t 1.2 --resume"));
    let seconds = |path: &str| {
        let json: serde_json::Value = serde_json::from_slice(&std::fs::read(folder.join(path)).unwrap()).unwrap();
        (json["seconds"]["render"].as_f64().unwrap(), json["spp"].as_u64().unwrap())
    };
    let (render, spp) = seconds("a.json");
    assert!((0.8..1.7).contains(&render), "{render} s in both parts");
    works(line("-t 1.2 --resume"));
    assert_eq!(seconds("a.json").1, spp, "there was no time left");
}

/// Without --resume a rendering begins anew, and says what lies there; with it and without a file it begins anew as well.
#[test]
fn what_is_begun_anew_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let line = |more: &str| render(folder, "cornell.xml", &format!("--size 16x16 -n 8 -o a.exr --checkpoint c {more}"));
    assert_eq!(works(line("--resume")), "note: there is no c yet: the rendering begins anew\n");
    let said = works(line("--seed 2"));
    assert!(said.starts_with("note: c holds 8 spp of an earlier rendering"), "{said}");
    assert_eq!(works(line("--seed 2 --resume -q")), "");
    let said = crate::common::program::fails(line("--resume"), 2);
    assert!(said.contains("what differs is seed (2 there, 0 asked for)"), "{said}");
}

/// What a killed process left half-written is removed by the next one that writes there, and what is being written is not.
#[test]
fn remains_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in [".lumbre-partial-dead42", ".lumbre-notes", "lumbre-abcdef"] {
        std::fs::write(at(name), "half").unwrap();
    }
    let put = |name: &str, before: &dyn Fn()| {
        replace_file(&at(name), |file| {
            before();
            file.write_all(b"whole").map_err(|error| error.to_string())
        })
        .unwrap();
    };
    put("slow", &|| put("quick", &|| ()));
    assert_eq!(files(folder.path()), [".lumbre-notes", "lumbre-abcdef", "quick", "slow"]);
    assert_eq!(std::fs::read(at("slow")).unwrap(), b"whole");
}
