//! Independent ways to the same image agree in the mean: techniques, sampling strategies, backends, frame sizes.
//!
//! A new row of the table is enrolled by itself, through what it solves and its bias.

use crate::common::{assert_same_mean, average, backends, backends_in_time, canon, render, settings, truth, with_gpu};
use lumbre::gpu::Gpu;
use lumbre::image::metrics::compare;
use lumbre::layout::backend::Backend;
use lumbre::render::film::Film;
use lumbre::render::{Renderer, Settings, Technique};
use lumbre::scene::Scene;
use lumbre::techniques::{Bias, Correlated, Sampler, Solves, TECHNIQUES};

const TILE: u32 = 16;

/// The name of a scene's file without what it ends with.
fn stem(name: &str) -> &str {
    name.trim_end_matches(".xml")
}

/// Seeds differ, so that the two sides of a comparison share nothing.
fn film(gpu: &Gpu, scene: &Scene, technique: &str, backend: Backend, seed: u32, spp: u32) -> Film {
    let mut settings = settings(scene, technique, backend);
    settings.seed = seed;
    render(gpu, scene, &settings, spp)
}

/// Every unbiased technique of independent pixels that solves the same transport against a reference with a seed of its own: on the backends of `all_on` each, on
/// others the reference alone, which shares with the rest what asks a ray.
fn techniques_agree(name: &str, defines: &[(&str, &str)], spp: u32, all_on: fn(&Gpu) -> Vec<Backend>) {
    let scene = canon(name, defines);
    with_gpu(|gpu| {
        for (reference, solves) in [("direct", Solves::Direct), ("path", Solves::Everything)] {
            // All are held against it: were it as noisy as they are, its own chance would be in all of their figures.
            let truth = Settings { seed: 1000, ..settings(&scene, reference, Backend::Bvh) };
            let truth = truth::truth(gpu, &format!("{}-{reference}", stem(name)), &scene, &truth, 16 * spp);
            let mut variants: Vec<String> = TECHNIQUES
                .iter()
                .filter(|row| {
                    row.solves == solves && row.bias == Bias::Unbiased && row.correlated == Correlated::Nothing
                })
                .map(|row| row.name.to_owned())
                .filter(|name| Technique::parse(name).unwrap().misses(&scene).is_none())
                .collect();
            if solves == Solves::Everything {
                variants.push(String::from("vcm:form=bpt"));
            } else {
                variants.extend(["direct:sampling=emitter", "direct:sampling=bsdf"].map(str::to_owned));
            }
            let all_on = all_on(gpu);
            for (seed, technique) in (0..).zip(&variants) {
                for backend in backends(gpu) {
                    if !all_on.contains(&backend) && technique != reference {
                        continue;
                    }
                    let found =
                        film(gpu, &scene, technique, backend, 2 * seed + u32::from(backend == Backend::Bvh), spp);
                    let what = format!("{name}: {technique} on {} against {reference} on bvh", backend.name());
                    assert_same_mean(&what, &found, &truth, TILE);
                }
            }
        }
    });
}

#[test]
fn techniques_agree_on_cornell() {
    techniques_agree("cornell.xml", &[("size", "64")], 192, backends);
}

#[test]
fn techniques_agree_on_cornell_spheres() {
    techniques_agree("cornell_spheres.xml", &[("size", "64")], 256, backends_in_time);
}

/// Sampling lights alone hits the lobe of the smoothest plates so seldom, and sampling BSDFs alone the smallest lights, that no
/// affordable number of samples is near a normal distribution: plates are rougher here and lights larger.
const ROUGHER: [(&str, &str); 10] = [
    ("width", "96"),
    ("height", "64"),
    ("alpha1", "0.05"),
    ("alpha2", "0.07"),
    ("radius1", "0.4"),
    ("radiance1", "7.2, 2.6, 1.6"),
    ("radius2", "0.4"),
    ("radiance2", "7, 5.8, 2.1"),
    ("radius_lamp", "3"),
    ("radiance_lamp", "2.4"),
];

#[test]
fn techniques_agree_on_veach_mis() {
    techniques_agree("veach_mis.xml", &ROUGHER, 256, backends_in_time);
}

/// Scenes whose light is hard to find, with fewer pixels: techniques with paths from the lights against `path`, with so many samples. Those that
/// merge are held to the mean. `vcm`, whose kernels hold all that the others' do, is on every backend, and each backend is held to the first one.
fn paths_from_the_lights_agree(name: &str, defines: &[(&str, &str)], spp: u32, path_spp: u32) {
    const SIDE: u32 = 48;
    let scene = canon(name, defines);
    with_gpu(|gpu| {
        let film = |technique: &str, backend: Backend, seed: u32, spp: u32| {
            let settings = Settings { width: SIDE, height: SIDE, seed, ..settings(&scene, technique, backend) };
            render(gpu, &scene, &settings, spp)
        };
        let truth = Settings { width: SIDE, height: SIDE, seed: 1000, ..settings(&scene, "path", Backend::Bvh) };
        let truth = truth::truth(gpu, &format!("{}-small-path", stem(name)), &scene, &truth, path_spp);
        for (seed, technique) in (0..).zip(["bdpt", "vcm:form=bpt", "light", "vcm", "photon"]) {
            let row = Technique::parse(technique).unwrap();
            if row.misses(&scene).is_some() {
                continue;
            }
            let mut first: Option<Film> = None;
            let compared = if technique == "vcm" { backends(gpu) } else { backends_in_time(gpu) };
            for backend in compared {
                let found = film(technique, backend, seed, if technique == "photon" { 4 * spp } else { spp });
                let what = format!("{name}: {technique} on {}", backend.name());
                if row.row.bias == Bias::Unbiased || technique == "vcm:form=bpt" {
                    assert_same_mean(&what, &found, &truth, TILE);
                } else {
                    assert_near(&what, &found, &truth, 0.02);
                }
                // The same paths, but for those that rounding sends another way.
                let Some(first) = &first else {
                    first = Some(found);
                    continue;
                };
                let off = nine_tenths_off(&found, first);
                println!("{what}: nine tenths of the pixels are within {:.4} % of the other backend's", 100.0 * off);
                assert!(off < 0.01, "{what}: off the other backend by {off}");
            }
        }
    });
}

/// By which share nine tenths of the pixels of two films differ at most, in the second channel.
fn nine_tenths_off(a: &Film, b: &Film) -> f64 {
    let (a, b) = (a.mean().pixels, b.mean().pixels);
    let off = |(a, b): (&[f32; 3], &[f32; 3])| f64::from((a[1] - b[1]).abs()) / f64::from(b[1].max(1e-6));
    let mut all: Vec<f64> = a.iter().zip(&b).map(off).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() * 9 / 10]
}

/// Holds the mean of what is blurred within this share of another technique's and three standard deviations, which must not be more than six per
/// cent.
fn assert_near(what: &str, found: &Film, truth: &Film, share: f64) {
    for (found, truth) in average(found).into_iter().zip(average(truth)) {
        let (off, sigma) = (found.mean / truth.mean - 1.0, (found.variance + truth.variance).sqrt() / truth.mean);
        println!("{what}: off by {:+.3} %, sigma {:.3} %", 100.0 * off, 100.0 * sigma);
        assert!(sigma < 0.02, "{what}: sigma {sigma} is too coarse: take more samples");
        assert!(off.abs() < share + 3.0 * sigma, "{what}: off by {off}, sigma {sigma}");
    }
}

#[test]
fn paths_from_the_lights_agree_on_bidirectional_room() {
    paths_from_the_lights_agree("bidirectional_room.xml", &[], 24, 2048);
}

#[test]
fn paths_from_the_lights_agree_on_door_ajar() {
    paths_from_the_lights_agree("door_ajar.xml", &[], 96, 1024);
}

#[test]
fn paths_from_the_lights_agree_on_ring_caustic() {
    paths_from_the_lights_agree("ring_caustic.xml", &[("sun_size", "2")], 256, 4096);
}

/// `techniques_agree_on_veach_mis` has all of these but those that merge, which tests/merging.rs holds to rough metal.
#[test]
#[ignore = "twenty seconds: `make thorough` runs it"]
fn paths_from_the_lights_agree_on_veach_mis() {
    paths_from_the_lights_agree("veach_mis.xml", &ROUGHER, 64, 1024);
}

/// The case `shading-normals` of `lumbre verify` holds what bumps do to paths from the light in a scene of its own.
#[test]
#[ignore = "three minutes, most of which the driver spends on kernels: `make thorough` runs it"]
fn paths_from_the_lights_agree_on_bumps() {
    paths_from_the_lights_agree("bumps.xml", &[], 64, 1024);
}

/// Samplers give the same image in the mean. Scrambled Sobol pairs have less error than the variance of the samples says: the test of
/// the mean is a cautious one for them, and the error itself is measured against a reference of the same image.
#[test]
fn samplers_agree() {
    let scene = canon("veach_mis.xml", &[("width", "96"), ("height", "64")]);
    with_gpu(|gpu| {
        let truth = Settings { seed: 1000, ..settings(&scene, "path", Backend::Bvh) };
        let truth = truth::truth(gpu, "veach_mis-samplers-path", &scene, &truth, 4096);
        for backend in backends(gpu) {
            let error = |sampler: Sampler| {
                let settings = Settings { sampler, seed: 5, ..settings(&scene, "path", backend) };
                let film = render(gpu, &scene, &settings, 256);
                let what = format!("path from {} numbers on {}", sampler.name(), backend.name());
                assert_same_mean(&what, &film, &truth, TILE);
                compare(&film.mean(), &truth.mean()).unwrap().relmse
            };
            let [independent, sobol] = [Sampler::Independent, Sampler::Sobol].map(error);
            println!("relMSE of 256 samples on {}: {independent:.2e} and {sobol:.2e}", backend.name());
            assert!(sobol < 0.5 * independent, "{sobol} is not half of {independent}");
        }
    });
}

/// The same command gives the same bits, however the work is cut into frames; another seed does not.
#[test]
fn frames_and_repetition_change_no_bit() {
    let scene = canon("cornell_spheres.xml", &[("size", "40")]);
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            for row in TECHNIQUES {
                let settings = settings(&scene, row.name, backend);
                let mut renderer = Renderer::new(gpu, &scene, &settings).unwrap();
                let mut film = |seed: u32, targets: std::ops::RangeInclusive<u32>| {
                    renderer.restart(seed).unwrap();
                    for spp in targets {
                        while renderer.advance(spp).unwrap() {}
                    }
                    let film = renderer.film().unwrap();
                    assert_eq!(film.nonfinite, 0, "{:?}", film.bad_samples);
                    film
                };
                let (whole, other) = (film(settings.seed, 12..=12), film(settings.seed + 1, 12..=12));
                // One sample per pixel and frame, each time asked for anew.
                let cut = film(settings.seed, 1..=12);
                assert_eq!(whole.sums, cut.sums, "{} on {}", row.name, backend.name());
                assert_eq!(whole.squares, cut.squares, "{} on {}", row.name, backend.name());
                assert_ne!(whole.sums, other.sums, "{} on {}", row.name, backend.name());
            }
        }
    });
}

/// The comparison itself can fail: an image that is 2 % too bright in one corner is found.
#[test]
fn a_planted_difference_is_found() {
    let scene = canon("cornell.xml", &[("size", "64")]);
    let found = with_gpu(|gpu| {
        let truth = film(gpu, &scene, "path", Backend::Bvh, 1, 512);
        let mut wrong = film(gpu, &scene, "path", Backend::Bvh, 2, 512);
        assert_same_mean("as rendered", &wrong, &truth, TILE);
        for y in 32..48 {
            for x in 32..48 {
                wrong.sums[y * 64 + x] = wrong.sums[y * 64 + x].map(|sum| sum * 1.02);
            }
        }
        std::panic::catch_unwind(|| assert_same_mean("planted", &wrong, &truth, TILE)).is_err()
    });
    assert!(found, "a difference of 2 % in one tile was not found");
}
