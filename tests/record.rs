//! `render --record`: what one frame does on the device.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use crate::common::program::{files, lumbre, render as command_of, signal, start, works};
use crate::common::scene_path;
use serde_json::Value;

fn render(folder: &Path, image: &str, more: &[&str]) {
    let mut command = lumbre();
    command.current_dir(folder).arg("render").arg(scene_path("cornell.xml"));
    command
        .args(["-i", "bdpt", "-n", "2", "--size", "24x16", "--backend", "bvh", "-q", "--validate", "-o", image])
        .args(more);
    works(command);
}

/// Every dispatch is there with the invocations that its workgroups make, in the order of the device's clock; buffers do not overlap; the picture
/// is well-formed; and the image has the bits that it has without.
#[test]
fn a_frame_is_written_down_command_by_command() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    render(folder, "plain.exr", &[]);
    render(folder, "recorded.exr", &["--record", "frame"]);
    let pixels = |name: &str| lumbre::image::read_image(&folder.join(name)).unwrap().pixels;
    assert_eq!(pixels("plain.exr"), pixels("recorded.exr"));
    let text = std::fs::read_to_string(folder.join("frame/frame.json")).unwrap();
    let frame: Value = serde_json::from_str(&text).unwrap();
    let submissions = frame["submissions"].as_array().unwrap();
    let commands: Vec<&Value> = submissions.iter().flat_map(|one| one["commands"].as_array().unwrap()).collect();
    for pass in ["bdpt.light.bvh", "bdpt.camera.bvh", "bdpt.resolve.bvh"] {
        let dispatch =
            commands.iter().find(|command| command["name"] == pass).unwrap_or_else(|| panic!("no {pass}: {text}"));
        let workgroups = dispatch["workgroups"].as_u64().unwrap();
        assert_eq!(workgroups, 6, "24x16 pixels are six tiles: {dispatch}");
        assert_eq!(dispatch["invocations"].as_u64(), Some(64 * workgroups), "{dispatch}");
    }
    for submission in submissions {
        let ends: Vec<[f64; 2]> = submission["commands"]
            .as_array()
            .unwrap()
            .iter()
            .map(|command| ["begin_us", "end_us"].map(|name| command[name].as_f64().unwrap()))
            .collect();
        assert!(ends.iter().all(|[begin, end]| begin <= end), "{submission}");
        assert!(ends.windows(2).all(|pair| pair[0][1] <= pair[1][0] + 1e-3), "{submission}");
    }
    let place = |buffer: &Value| {
        (u64::from_str_radix(buffer["address"].as_str().unwrap(), 16).unwrap(), buffer["size"].as_u64().unwrap())
    };
    let buffers: Vec<(u64, u64)> = frame["buffers"].as_array().unwrap().iter().map(place).collect();
    assert!(buffers.windows(2).all(|pair| pair[0].0 + pair[0].1 <= pair[1].0), "{text}");
    assert!(frame["buffers"].as_array().unwrap().iter().any(|buffer| buffer["name"] == "film"), "{text}");
    let picture = std::fs::read_to_string(folder.join("frame/frame.svg")).unwrap();
    assert!(roxmltree::Document::parse(&picture).is_ok() && picture.matches("<rect").count() > 6, "{picture}");
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Seconds that the submissions of a recording took by the host's clock.
fn recorded(folder: &Path) -> f64 {
    let frame = json(&folder.join("frame/frame.json"));
    frame["submissions"].as_array().unwrap().iter().map(|one| one["wall_s"].as_f64().unwrap()).sum()
}

/// What a recording takes is taken from the time that the rendering has; and Ctrl-C ends it with one line, and leaves neither a part of it nor an
/// image.
#[test]
fn a_recording_counts_as_time_and_ends_when_it_is_to() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = |side: u32, more: &str| {
        let args = format!("-i bdpt --backend bvh --size {side}x{side} --record frame -o a.exr {more}");
        command_of(folder, "cornell.xml", &args)
    };
    let seconds = 3.5;
    works(run(512, &format!("-t {seconds} --json a.json")));
    let took = recorded(folder);
    let rendered = json(&folder.join("a.json"))["seconds"]["render"].as_f64().unwrap();
    println!("{rendered:.2} s of rendering after {took:.2} s of recording, of {seconds} s");
    // The last frame goes beyond the time, and each pixel has a sample however long that takes: where the recording was as short as a few frames,
    // or longer than the time, it cannot be told apart.
    let most = (seconds - 0.5 * took).max(1.5 * took);
    assert!(rendered < most || took < 0.3, "{rendered} s of rendering after {took} s of recording, of {seconds} s");

    for name in ["a.exr", "a.json", "frame/frame.json", "frame/frame.svg"] {
        std::fs::remove_file(folder.join(name)).unwrap();
    }
    let mut child = start(run(768, "-n 1000"));
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("recording") {
        line.clear();
        assert!(said.read_line(&mut line).unwrap() > 0, "it ended before it recorded");
    }
    signal(&child, "INT");
    let mut rest = String::new();
    said.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest}");
    assert_eq!(
        rest,
        "error: interrupted: frame is as it was, for not every pixel had its sample; there is no image yet\n"
    );
    assert_eq!((files(folder), files(&folder.join("frame"))), (vec![String::from("frame")], Vec::new()));
}
