//! One small scene per kind of material, light and camera, against what Mitsuba 3 (`scalar_rgb`) makes of the very same file.
//!
//! `benches/references.py` makes the scenes and the references, which hold the variance of their means.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::common::{backends, has_time, render, settings, with_gpu};
use lumbre::layout::backend::Backend;
use lumbre::render::film::Film;
use lumbre::scene::{LoadOptions, Scene, load};
use lumbre::statistics::{sidak, two_sided_p};

/// Samples per pixel here. The references have 16 times as many, so the noise of the comparison is ours.
const SPP: u32 = 512;
/// Samples per pixel of the references over those here.
const REFERENCE_SAMPLES: f64 = 16.0;
/// Probability of a false alarm per scene.
const ALPHA: f64 = 0.01;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references")
}

fn scene(name: &str) -> Scene {
    load(&folder().join(format!("{name}.xml")), &LoadOptions::default()).unwrap()
}

/// The names of all scenes that have a reference.
fn names() -> Vec<String> {
    let entries = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let mut names: Vec<String> = entries
        .filter(|path| {
            path.extension().is_some_and(|extension| extension == "xml") && path.with_extension("exr").exists()
        })
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// A channel of a reference, row by row.
type Channels = BTreeMap<String, Vec<f64>>;

fn reference(name: &str) -> Channels {
    let image = exr::prelude::read_first_flat_layer_from_file(folder().join(format!("{name}.exr"))).unwrap();
    let channels = image.layer_data.channel_data.list;
    channels
        .iter()
        .map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().map(f64::from).collect()))
        .collect()
}

/// Compares pixel by pixel, and blocks of 8 x 8, which see a small difference everywhere. Returns what is wrong.
fn compare(name: &str, film: &Film, truth: &Channels) -> Option<String> {
    let (mean, variance) = (film.mean(), film.mean_variance());
    let (width, height) = (film.width as usize, film.height as usize);
    let mut worst = [(0.0f64, String::new()), (0.0, String::new())];
    let mut tests = [0usize; 2];
    for (channel, letter) in ["R", "G", "B"].into_iter().enumerate() {
        let (expected, noise) = (&truth[letter], &truth[&format!("variance.{letter}")]);
        assert_eq!(expected.len(), width * height, "{name}: the reference is of another size");
        let at = |pixel: usize| {
            let difference = f64::from(mean.pixels[pixel][channel]) - expected[pixel];
            // Where light is seldom found, few samples show a variance that is too small; both sides know something of it.
            let ours = f64::from(variance.pixels[pixel][channel]).max(REFERENCE_SAMPLES * noise[pixel]);
            (difference, ours + noise[pixel])
        };
        // Rounding: the references are single precision.
        let floor = |value: f64| (1e-5 * value).powi(2) + 1e-14;
        for (pixel, expected) in expected.iter().enumerate() {
            let (difference, variance) = at(pixel);
            let z = difference.abs() / (variance + floor(*expected)).sqrt();
            tests[0] += 1;
            if z > worst[0].0 {
                let place = format!("pixel ({}, {}) {letter}", pixel % width, pixel / width);
                worst[0] = (z, format!("{place}: {} against {}", mean.pixels[pixel][channel], expected));
            }
        }
        for block_y in (0..height).step_by(8) {
            for block_x in (0..width).step_by(8) {
                let (mut difference, mut variance, mut sum) = (0.0, 0.0, 0.0);
                for y in block_y..block_y + 8 {
                    for x in block_x..block_x + 8 {
                        let (d, v) = at(y * width + x);
                        difference += d;
                        variance += v;
                        sum += expected[y * width + x];
                    }
                }
                let z = difference.abs() / (variance + floor(sum)).sqrt();
                tests[1] += 1;
                if z > worst[1].0 {
                    worst[1] =
                        (z, format!("block ({block_x}, {block_y}) {letter}: off by {:.3} %", 100.0 * difference / sum));
                }
            }
        }
    }
    let ours = film.average();
    let theirs = ["R", "G", "B"].map(|letter| truth[letter].iter().sum::<f64>() / (width * height) as f64);
    let ratio = ours.iter().sum::<f64>() / theirs.iter().sum::<f64>();
    println!("{name}: energy ratio {ratio:.5}, largest z {:.2} per pixel, {:.2} per block", worst[0].0, worst[1].0);
    let failed = worst.iter().zip(tests).find(|((z, _), tests)| two_sided_p(*z) < sidak(ALPHA, *tests));
    failed.map(|((z, place), _)| format!("{name}: z = {z:.2} at {place}; energy ratio {ratio:.5}"))
}

#[test]
fn every_kind_agrees_with_mitsuba() {
    let names = names();
    assert!(names.len() >= 40, "only {} references", names.len());
    // LUMBRE_TEST_REFERENCE names one scene to look into.
    let only = std::env::var("LUMBRE_TEST_REFERENCE").ok();
    let mut wrong = Vec::new();
    with_gpu(|gpu| {
        for name in names.iter().filter(|name| only.as_deref().is_none_or(|only| only == name.as_str())) {
            let scene = scene(name);
            let mut settings = settings(&scene, "path", Backend::Bvh);
            settings.seed = 7;
            wrong.extend(compare(name, &render(gpu, &scene, &settings, SPP), &reference(name)));
        }
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A kernel that models everything gives the bits of one that models what the scene needs. Few scenes, because that kernel
/// takes the driver half a minute to compile, and more on slow machines.
#[test]
fn specialisation_changes_no_bit() {
    with_gpu(|gpu| {
        let few =
            [("mask", "path-implicit", Backend::RayQuery, false), ("roughdielectric", "path", Backend::Bvh, true)];
        let more = [
            ("mask", "path", Backend::Bvh, false),
            ("directional", "path", Backend::Bvh, false),
            ("normalmap", "path", Backend::RayQuery, false),
        ];
        let more = if has_time() { &more[..] } else { &[] };
        for (name, technique, backend, energy_compensation) in few.iter().chain(more).copied() {
            if !backends(gpu).contains(&backend) {
                continue;
            }
            let options = LoadOptions { energy_compensation, ..LoadOptions::default() };
            let scene = load(&folder().join(format!("{name}.xml")), &options).unwrap();
            let mut settings = settings(&scene, technique, backend);
            let lean = render(gpu, &scene, &settings, 4);
            settings.specialise = false;
            let everything = render(gpu, &scene, &settings, 4);
            assert_eq!(lean.sums, everything.sums, "{name}, {technique} on {}", backend.name());
        }
    });
}
