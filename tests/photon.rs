//! Progressive photon mapping: its error vanishes with the number of samples, nothing is counted twice or missed, and no order of
//! photons or frames changes a bit.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::room::{LAMP, MATERIALS, room, scene};
use common::{average, backends, canon, render, settings, with_gpu};
use lumbre::backend::Backend;
use lumbre::film::Film;
use lumbre::gpu::Gpu;
use lumbre::integrator::{Bias, find};
use lumbre::metrics::compare;
use lumbre::render::{Renderer, Settings};
use lumbre::scene::Scene;

const SIZE: u32 = 64;
const BOTH: [&str; 2] = ["photon", "photon:direct=photons"];

fn film(gpu: &Gpu, scene: &Scene, technique: &str, seed: u32, spp: u32) -> Film {
    let settings = Settings { width: SIZE, height: SIZE, seed, ..settings(scene, technique, Backend::Bvh) };
    render(gpu, scene, &settings, spp)
}

/// Largest difference of the mean of a rectangle from that of the truth, over the truth's, of the three channels.
fn off(found: &Film, truth: &Film, columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) -> f64 {
    let mean = |film: &Film| common::tile_average(film, columns.clone(), rows.clone()).map(|channel| channel.mean);
    let differences = mean(found).into_iter().zip(mean(truth)).map(|(a, b)| a / b - 1.0);
    differences.fold(0.0, |worst: f64, x| if x.abs() > worst.abs() { x } else { worst })
}

fn assert_off(what: &str, found: &Film, truth: &Film, bound: f64) {
    let off = off(found, truth, 0..found.width, 0..found.height);
    println!("{what}: the mean is off by {:+.3} %, bound {:.2} %", 100.0 * off, 100.0 * bound);
    assert!(off.abs() < bound, "{what}: off by {off}");
}

#[test]
fn the_table_says_that_it_is_consistent() {
    assert!(matches!(find("photon").unwrap().bias, Bias::Consistent(_)));
}

/// The energy is that of `path`, within a bound that is three times tighter for sixteen times the samples.
#[test]
fn the_mean_is_that_of_path() {
    with_gpu(|gpu| {
        for name in ["cornell.xml", "cornell_spheres.xml"] {
            let scene = canon(name, &[]);
            let truth = film(gpu, &scene, "path", 1000, 8192);
            for technique in BOTH {
                for (spp, bound) in [(32, 0.015), (512, 0.005)] {
                    assert_off(
                        &format!("{name}, {technique}, {spp}"),
                        &film(gpu, &scene, technique, 1, spp),
                        &truth,
                        bound,
                    );
                }
            }
        }
    });
}

/// The error falls with every eightfold of samples, and where the first radius is large, more than that: with a radius that stays, blur
/// would be left.
#[test]
fn the_error_vanishes() {
    with_gpu(|gpu| {
        let name = "cornell_spheres.xml";
        let scene = canon(name, &[]);
        let truth = film(gpu, &scene, "path", 1000, 16384).mean();
        let error = |technique: &str, spp: u32| {
            let relmse = compare(&film(gpu, &scene, technique, 1, spp).mean(), &truth).unwrap().relmse;
            println!("{name}: {technique}, {spp} samples: relMSE {relmse:.2e}");
            relmse
        };
        for technique in BOTH {
            let errors = [8, 64, 512].map(|spp| error(technique, spp));
            assert!(errors.is_sorted_by(|a, b| *b < 0.3 * *a), "{name}, {technique}: {errors:?}");
            assert!(errors[2] < 0.015, "{name}, {technique}: {errors:?}");
        }
        let (shrinking, blurred) =
            (error("photon:radius=0.1:alpha=0.5", 1024), error("photon:radius=0.1:alpha=1", 1024));
        assert!(shrinking < 0.5 * blurred, "{name}: {shrinking} against {blurred}");
    });
}

/// Photons are kept, sorted and met in any order; frames are cut within a stage, or hold all of them.
#[test]
fn no_order_changes_a_bit() {
    let scene = canon("cornell_spheres.xml", &[]);
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            // A first frame has not the room for all pixels, later ones have.
            let settings = Settings { width: 168, height: 160, ..settings(&scene, "photon", backend) };
            let mut renderer = Renderer::new(gpu, &scene, &settings).unwrap();
            let mut frames = 0;
            let mut run = |renderer: &mut Renderer, targets: &[u32]| {
                for target in targets {
                    loop {
                        frames += 1;
                        if !renderer.advance(*target).unwrap() {
                            break;
                        }
                    }
                }
                (renderer.film().unwrap(), std::mem::take(&mut frames))
            };
            let (first, cut) = run(&mut renderer, &[1, 2, 3, 4]);
            renderer.restart(settings.seed).unwrap();
            let (again, whole) = run(&mut renderer, &[4]);
            println!("on {}: {cut} frames, then {whole}", backend.name());
            assert!(cut > whole);
            assert_eq!(first.sums, again.sums, "on {}", backend.name());
            assert_eq!(first.squares, again.squares, "on {}", backend.name());
            let fresh = render(gpu, &scene, &settings, 4);
            assert_eq!(first.sums, fresh.sums, "on {}", backend.name());
        }
    });
}

/// Light that was refracted before and after it met the torus: nothing but chance brings it to `path`, so that its image takes many
/// samples. The block of glass by itself, and the whole.
#[test]
fn light_through_glass_is_found() {
    let scene = canon("torus_in_glass.xml", &[]);
    with_gpu(|gpu| {
        let truth = film(gpu, &scene, "path", 1000, 32768);
        for technique in BOTH {
            let found = film(gpu, &scene, technique, 1, 2048);
            assert_off(&format!("torus_in_glass, {technique}"), &found, &truth, 0.02);
            let block = off(&found, &truth, 20..44, 14..36);
            println!("torus_in_glass, {technique}: the torus is off by {:+.2} %", 100.0 * block);
            assert!(block.abs() < 0.05, "{technique}: {block}");
        }
    });
}

/// A furnace of albedo r: paths of k segments bring r^(k-1). On a sphere the area within a distance is that on a plane, so that not
/// even the estimate's radius shows; albedos are high enough that many paths have more photons than are kept.
#[test]
fn furnace() {
    const LAYERS: u32 = 5;
    let scene = canon("furnace_sphere.xml", &[("size", "32")]);
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            for technique in BOTH {
                let settings =
                    Settings { lengths: LAYERS, ..settings(&scene, &format!("{technique}:radius=0.1"), backend) };
                let film = render(gpu, &scene, &settings, 1024);
                let what = format!("{technique} on {}", backend.name());
                for (channel, r) in [0.5f64, 0.25, 0.75].into_iter().enumerate() {
                    let mean = average(&film)[channel].mean;
                    let expected = 1.0 / (1.0 - r);
                    println!("{what}, channel {channel}: {mean:.4} against {expected:.4}");
                    assert!(
                        (mean / expected - 1.0).abs() < 5e-3,
                        "{what}, channel {channel}: {mean} against {expected}"
                    );
                    for layer in 0..LAYERS {
                        let last = if layer + 1 == LAYERS { 1.0 - r } else { 1.0 };
                        let expected = r.powi(layer as i32) / last;
                        let values = film.length(layer as usize);
                        let mean = values.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>()
                            / values.pixels.len() as f64;
                        println!("{what}, channel {channel}, {} segments: {mean:.5} against {expected:.5}", layer + 1);
                        assert!(
                            (mean / expected - 1.0).abs() < 1e-2,
                            "{what}, {} segments: {mean} against {expected}",
                            layer + 1
                        );
                    }
                }
            }
        }
    });
}

/// Where paths have to end, they end at the same number of segments as those of `path`, by whatever they were found.
#[test]
fn paths_end_where_they_have_to() {
    let scene = canon("cornell_spheres.xml", &[]);
    with_gpu(|gpu| {
        for max_depth in [1, 2, 3, 5] {
            let film = |technique: &str, seed: u32, spp: u32| {
                let settings = Settings {
                    width: SIZE,
                    height: SIZE,
                    max_depth: Some(max_depth),
                    lengths: max_depth + 1,
                    seed,
                    ..settings(&scene, technique, Backend::Bvh)
                };
                render(gpu, &scene, &settings, spp)
            };
            let truth = film("path", 1000, 4096);
            for technique in BOTH {
                let found = film(technique, 1, 256);
                assert_off(&format!("{technique}, {max_depth} segments"), &found, &truth, 0.015);
                let longer = found.length(max_depth as usize);
                assert!(
                    longer.pixels.iter().all(|pixel| *pixel == [0.0; 3]),
                    "{technique}: more than {max_depth} segments"
                );
            }
        }
    });
}

/// A camera that looks at the middle of the room, with the default filter.
const CAMERA: &str = "<sensor type='perspective'><float name='fov' value='40'/>
    <transform name='to_world'><lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/></transform></sensor>";

/// Every kind of material and light, on both sides of a gathering.
#[test]
fn every_material_and_light() {
    // Smooth glass makes caustics that `path` does not find well; rough plastic is plastic and rough metal in one.
    let materials: Vec<_> = MATERIALS.iter().filter(|(name, _)| !["glass", "rough plastic"].contains(name)).collect();
    let lights = [
        ("a lamp", LAMP),
        (
            "a ball and the sky",
            "<shape type='sphere'><point name='center' x='0' y='2.2' z='0'/><float name='radius' value='0.4'/>
             <emitter type='area'><rgb name='radiance' value='9, 8, 7'/></emitter></shape>
             <emitter type='constant'><rgb name='radiance' value='0.4, 0.5, 0.6'/></emitter>",
        ),
        // Not through anything smooth: `path` does not find a light without extent there.
        (
            "a spot",
            "<emitter type='spot'><float name='cutoff_angle' value='35'/><rgb name='intensity' value='30, 28, 25'/>
             <transform name='to_world'><lookat origin='1, 3, 2' target='0, 0, 0' up='0, 1, 0'/></transform></emitter>",
        ),
    ];
    with_gpu(|gpu| {
        for (light_name, light) in lights {
            let few = if light_name == "a spot" { &materials[..1] } else { &materials[..] };
            for (name, material) in few {
                let scene = scene(&[CAMERA, &room(material, material), light].concat());
                let truth = film(gpu, &scene, "path", 1000, 1024);
                for technique in BOTH {
                    let found = film(gpu, &scene, technique, 1, 256);
                    assert_off(&format!("{name} and {light_name}, {technique}"), &found, &truth, 0.02);
                }
            }
        }
    });
}
