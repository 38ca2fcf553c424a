//! Instant radiosity: unbiased where it makes up for what clamping takes, and dark by that where it does not.
//!
//! Pixels share virtual point lights, so seeds are compared.

use crate::common::seeds::{agree, small};
use crate::common::{average, canon, films, render, with_gpu};
use lumbre::render::{Renderer, Settings};
use lumbre::statistics::Estimate;
use lumbre::techniques::Sampler;

/// Little clamping, much of it, and next to nothing left to virtual point lights; few of them, and all of few.
const FORMS: [&str; 4] =
    ["vpl", "vpl:clamp=0.5:gathered=1", "vpl:clamp=0.02:subpaths=64", "vpl:clamp=3:gathered=16:subpaths=16"];

#[test]
fn diffuse_walls() {
    agree(&FORMS, "cornell.xml", &canon("cornell.xml", &[]), "path", [24, 24], |_| {});
}

/// Glass, mirrors and what they throw: paths go on where a vertex has delta lobes.
#[test]
fn glass_and_mirrors() {
    agree(&FORMS[..2], "glass and mirrors", &canon("cornell_spheres.xml", &[]), "bdpt", [40, 24], |_| {});
}

/// Layers by path length are those of `path`, and a limit of length leaves the others as they are.
#[test]
fn lengths() {
    let scene = canon("cornell.xml", &[]);
    with_gpu(|gpu| {
        let by_length = |technique: &str, max_depth| {
            let settings = Settings { max_depth, lengths: 4, width: 32, height: 32, ..small(&scene, technique) };
            films(gpu, &scene, &settings, 12, 64)
        };
        let (path, vpl) = (by_length("path", Some(4)), by_length("vpl:clamp=1", Some(4)));
        for layer in 0..4 {
            let mean = |film: &lumbre::render::film::Film| {
                let pixels = film.length(layer).pixels;
                pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / pixels.len() as f64
            };
            let over = |films: &[_]| Estimate::of(&films.iter().map(mean).collect::<Vec<f64>>());
            let (path, vpl) = (over(&path), over(&vpl));
            let off = (vpl.mean - path.mean) / (vpl.variance + path.variance).sqrt();
            println!("{} segments: {} against {}, {off:.2} deviations", layer + 1, vpl.mean, path.mean);
            assert!(off.abs() < 4.0 || vpl.mean == path.mean, "{} segments: {off} deviations", layer + 1);
        }
    });
}

/// Without compensation light is missing: more of it the lower the bound, and none that is not between close surfaces.
#[test]
fn clamping_takes_light() {
    let scene = canon("cornell.xml", &[]);
    with_gpu(|gpu| {
        let truth = average(&render(gpu, &scene, &Settings { seed: 1000, ..small(&scene, "path") }, 2048))[1].mean;
        let missing = |clamp: f64| {
            let settings = small(&scene, &format!("vpl:compensate=no:clamp={clamp}"));
            let all = films(gpu, &scene, &settings, 8, 32);
            let means: Vec<f64> = all.iter().map(|film| average(film)[1].mean).collect();
            let found = Estimate::of(&means);
            let missing = (1.0 - found.mean / truth, found.variance.sqrt() / truth);
            println!("clamp {clamp}: {:.4} +- {:.4} of the light is missing", missing.0, missing.1);
            missing
        };
        let all: Vec<(f64, f64)> = [0.02, 0.5, 10.0, 0.0].map(missing).into();
        for pair in all.windows(2) {
            assert!(pair[0].0 > pair[1].0 - 3.0 * pair[0].1.hypot(pair[1].1), "a lower bound leaves more: {all:?}");
        }
        assert!(all[0].0 > 0.15 && all[1].0 > 0.02, "{all:?}");
        assert!(
            all[3].0.abs() < 4.0 * all[3].1 + 0.002,
            "without a bound, and without glass, none is missing: {all:?}"
        );
    });
}

/// How frames are cut changes no bit: the virtual point lights are those of the sample.
#[test]
fn frames_change_nothing() {
    let scene = canon("cornell_spheres.xml", &[]);
    with_gpu(|gpu| {
        let film = |most: Option<u64>| {
            let mut renderer = Renderer::new(gpu, &scene, &small(&scene, "vpl")).unwrap();
            most.into_iter().for_each(|most| renderer.bound_frames(most));
            while renderer.advance(3).unwrap() {}
            renderer.film().unwrap()
        };
        assert_eq!(film(None).mean().pixels, film(Some(640)).mean().pixels);
    });
}

/// Pixels by themselves are independent from sample to sample: the film's own variance tells how seeds differ.
#[test]
fn the_variance_of_a_pixel() {
    let scene = canon("cornell.xml", &[]);
    with_gpu(|gpu| {
        let sampler = Sampler::Independent;
        let settings = Settings { width: 16, height: 16, sampler, ..small(&scene, "vpl:subpaths=16:gathered=16") };
        let all = films(gpu, &scene, &settings, 64, 16);
        let pixels = all[0].mean().pixels.len();
        let stated: f64 =
            all.iter().flat_map(|film| film.mean_variance().pixels).map(|pixel| f64::from(pixel[1])).sum();
        let seen: f64 = (0..pixels)
            .map(|pixel| {
                let values: Vec<f64> = all.iter().map(|film| f64::from(film.mean().pixels[pixel][1])).collect();
                Estimate::of(&values).variance * values.len() as f64
            })
            .sum();
        let ratio = stated / all.len() as f64 / seen;
        println!("variance of a pixel, stated over seen: {ratio:.3}");
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    });
}
