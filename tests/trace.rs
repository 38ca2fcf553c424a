//! `lumbre trace`: what is told of the paths of a sample adds up to that sample.

use serde_json::Value;

use std::process::Command;

use crate::common::program::{fails, lumbre};
use crate::common::{backends, backends_in_time, canon, scene_path, settings, with_gpu};
use lumbre::layout::{PathRecord, RECORD_CONTRIBUTION, RECORD_SPLAT, RECORD_VALUE};
use lumbre::render::{Renderer, Settings, Wanted};
use lumbre::techniques::TECHNIQUES;
use lumbre::trace::{Request, trace};

/// What a command prints.
fn printed(mut command: Command) -> String {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// An image of so many pixels across and down: 1024 of them.
const SIDE: u32 = 32;
/// Records of all pixels of a sample.
const ROOM: u32 = 1 << 18;

/// Of the records of a sample of all pixels: what adds up to each pixel, and the value that the film took.
fn sums(records: &[PathRecord]) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let pixels = (SIDE * SIDE) as usize;
    let (mut sums, mut values) = (vec![[0.0; 3]; pixels], vec![[0.0; 3]; pixels]);
    for record in records {
        let to = if record.kind == RECORD_VALUE { &mut values } else { &mut sums };
        let pixel = &mut to[record.pixel as usize];
        for (channel, value) in pixel.iter_mut().zip(record.value) {
            *channel += f64::from(value);
        }
    }
    (sums, values)
}

/// For 1024 pixels, each technique and each backend: what the paths of the second sample contribute adds up to the sample's value, which is the
/// difference between images of two samples and of one; and recording changes no bit of the image.
#[test]
fn contributions_add_up_to_the_sample_in_every_technique() {
    with_gpu(|gpu| {
        let scene = canon("cornell_spheres.xml", &[]);
        for (row, backend) in
            TECHNIQUES.iter().flat_map(|row| backends_in_time(gpu).into_iter().map(move |backend| (row, backend)))
        {
            let what = format!("{} on {}", row.name, backend.name());
            let mut settings = settings(&scene, row.name, backend);
            (settings.width, settings.height) = (SIDE, SIDE);
            let mut plain = Renderer::new(gpu, &scene, &settings).unwrap();
            let mut film_after = |spp| {
                while plain.advance(spp).unwrap() {}
                plain.film().unwrap()
            };
            let (one, two) = (film_after(1), film_after(2));
            let mut renderer = Renderer::new(gpu, &scene, &Settings { records: ROOM, ..settings.clone() }).unwrap();
            let kinds = 1 << RECORD_CONTRIBUTION | 1 << RECORD_SPLAT | 1 << RECORD_VALUE;
            renderer.want_records(&Wanted { kinds, sample: Some(1), ..Wanted::NOTHING }).unwrap();
            while renderer.advance(2).unwrap() {}
            let (records, lost) = renderer.records().unwrap();
            assert_eq!(lost, 0, "{what}");
            let recorded = renderer.film().unwrap();
            assert_eq!(recorded.mean().pixels, two.mean().pixels, "{what}: recording changes the image");
            let factor = renderer.film_factor().unwrap();
            let (sums, values) = sums(&records);
            let (one, two) = (one.mean(), two.mean());
            let brightness: f64 = values.iter().flatten().sum::<f64>() / (3 * values.len()) as f64;
            for (pixel, (sum, value)) in sums.iter().zip(&values).enumerate() {
                let before = one.pixels[pixel].map(f64::from);
                for channel in 0..3 {
                    let scale = value[channel].abs().max(1e-2 * brightness);
                    let off = (sum[channel] - value[channel]).abs();
                    assert!(
                        off < 1e-4 * scale,
                        "{what}, pixel {pixel}: {} adds up to {}",
                        value[channel],
                        sum[channel]
                    );
                    // The chains' brightness is known better after two samples, so their images of one are none of a part of those.
                    if row.name == "mlt" {
                        continue;
                    }
                    let difference = 2.0 * f64::from(two.pixels[pixel][channel]) - before[channel];
                    let off = (value[channel] * factor - difference).abs();
                    let scale = scale.max(before[channel]);
                    assert!(off < 1e-4 * scale, "{what}, pixel {pixel}: {} instead of {difference}", value[channel]);
                }
            }
            assert!(brightness > 0.0, "{what}: no light");
        }
    });
}

fn vector(of: &Value, name: &str) -> [f64; 3] {
    let number = |index: usize| of[name][index].as_f64().unwrap_or_else(|| panic!("{name} of {of}"));
    [0, 1, 2].map(number)
}

fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap_or_else(|| panic!("{name} of {of}"))
}

fn times(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// The value of a path by the rendering equation, from the printed numbers alone: f |cos| / pdf and roulette multiplied along it, and each emission
/// and light sample with the power heuristic of its two printed densities.
fn evaluated(path: &Value) -> [f64; 3] {
    let heuristic = |own: f64, other: f64| own * own / (own * own + other * other);
    let mut throughput = [1.0; 3];
    let mut sum = [0.0; 3];
    let mut add = |value: [f64; 3], weight: f64| (0..3).for_each(|channel| sum[channel] += value[channel] * weight);
    let emission_weight = |emission: &Value| {
        emission["pdf_w"].as_f64().map_or(1.0, |pdf| heuristic(pdf, number(emission, "light_pdf_w")))
    };
    for vertex in path["vertices"].as_array().unwrap() {
        let emission = &vertex["emission"];
        if !emission.is_null() {
            add(times(throughput, vector(emission, "radiance")), emission_weight(emission));
        }
        for light in vertex["light_samples"].as_array().unwrap() {
            let weight = if light["is_delta"] == true {
                1.0
            } else {
                heuristic(number(light, "pdf"), number(light, "bsdf_pdf_w"))
            };
            add(times(throughput, times(vector(light, "f_cos"), vector(light, "radiance_over_pdf"))), weight);
        }
        let Some(scattering) = vertex["scatterings"].as_array().unwrap().first() else { break };
        throughput = times(throughput, vector(scattering, "weight"));
        if !vertex["roulette"].is_null() {
            throughput = throughput.map(|channel| channel / number(&vertex["roulette"], "survival"));
        }
    }
    let background = &path["background"];
    if !background.is_null() {
        add(times(throughput, vector(background, "radiance")), emission_weight(background));
    }
    sum
}

/// The brightest samples of a rendering, traced by the commands that it names, are worth what their printed numbers say, whatever the scene and
/// the settings were asked for.
#[test]
fn the_printed_path_of_a_firefly_gives_its_value() {
    let folder = tempfile::tempdir().unwrap();
    let report = folder.path().join("report.json");
    const ASKED: &str = "-D light=ceiling -D spheres=large --lights tree --max-depth 4 --rr-depth 2 --sampler independent --seed 7 --camera 0";
    for (name, asked) in [("gltf_room/room.gltf", ""), ("small_vcm.xml", ASKED)] {
        let mut command = lumbre();
        command.arg("render").arg(scene_path(name)).args([
            "-i",
            "path",
            "-n",
            "8",
            "--size",
            "64x48",
            "--fireflies",
            "5",
            "-q",
        ]);
        command.args(asked.split_whitespace());
        command.arg("-o").arg(folder.path().join("image.exr")).arg("--json").arg(&report);
        printed(command);
        let report: Value = serde_json::from_str(&std::fs::read_to_string(&report).unwrap()).unwrap();
        let fireflies = report["fireflies"].as_array().unwrap();
        assert_eq!(fireflies.len(), 5, "{report}");
        let brightness = |firefly: &Value| vector(firefly, "value").into_iter().fold(0.0, f64::max);
        assert!(fireflies.windows(2).all(|pair| brightness(&pair[0]) >= brightness(&pair[1])), "{fireflies:?}");
        for firefly in &fireflies[..2] {
            let words = shlex::split(firefly["command"].as_str().unwrap()).unwrap();
            let mut command = lumbre();
            command.args(&words[1..]).args(["--json", "-"]);
            let traced: Value = serde_json::from_str(&printed(command)).unwrap();
            let (found, value) = (evaluated(&traced["subpaths"][0]), vector(firefly, "value"));
            let told = vector(&traced, "value");
            for channel in 0..3 {
                let scale = brightness(firefly);
                assert!(
                    (found[channel] - value[channel]).abs() < 1e-4 * scale,
                    "{found:?} instead of {value:?}: {traced}"
                );
                assert!((told[channel] - value[channel]).abs() < 1e-6 * scale, "{told:?} instead of {value:?}");
            }
        }
    }
}

/// A light subpath that splats onto the pixel is told vertex by vertex, and the strategies of the pixel's own subpaths have weights.
#[test]
fn bidirectional_samples_tell_both_subpaths() {
    with_gpu(|gpu| {
        let scene = canon("small_vcm.xml", &[]);
        let mut settings = settings(&scene, "bdpt", backends(gpu)[0]);
        (settings.width, settings.height) = (SIDE, SIDE);
        let traced = trace(gpu, &scene, &settings, Request { x: 16, y: 24, sample: 2 }).unwrap();
        assert!(
            traced.subpaths.len() >= 2 && !traced.subpaths[0].from_light && traced.subpaths[1].from_light,
            "{traced:#?}"
        );
        assert!(traced.strategies.iter().all(|one| one.how == "candidate" || one.mis_weight > 0.0), "{traced:#?}");
        let scale = traced.value.iter().copied().fold(1e-9, f64::max);
        assert!(
            traced.sum.iter().zip(&traced.value).all(|(sum, value)| (sum - value).abs() < 1e-4 * scale),
            "{traced:#?}"
        );
    });
}

#[test]
fn wrong_pixels_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let ask = |arguments: &[&str]| {
        let mut command = lumbre();
        command.current_dir(folder.path()).arg("trace").arg(scene_path("cornell.xml")).args(arguments);
        command
    };
    let beside = fails(ask(&["--pixel", "64,0", "--size", "64x48"]), 2);
    assert!(beside.contains("64,0") && beside.contains("0,0 to 63,47"), "{beside}");
    let malformed = fails(ask(&["--pixel", "64"]), 2);
    assert!(malformed.contains("X,Y"), "{malformed}");
    let mut drawn = ask(&["-i", "path", "--pixel", "3,4", "--size", "64x48", "--svg", "plan.svg"]);
    drawn.arg("--sample").arg("1");
    let text = printed(drawn);
    assert!(text.contains("path from the camera") && text.contains("sum "), "{text}");
    let plan = std::fs::read_to_string(folder.path().join("plan.svg")).unwrap();
    roxmltree::Document::parse(&plan).unwrap();
    assert!(plan.matches("<circle").count() >= 2, "{plan}");
}
