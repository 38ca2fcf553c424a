//! `render --record`: what one frame does on the device.

use serde_json::Value;

use crate::common::program::{lumbre, works};
use crate::common::scene_path;

fn render(folder: &std::path::Path, image: &str, more: &[&str]) {
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
