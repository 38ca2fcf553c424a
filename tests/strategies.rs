//! The strategies of bidirectional path tracing: what each of them brings. Their weights are the row `mis-weights` of `lumbre verify`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{backends, canon, render, settings, with_gpu};
use lumbre::backend::Backend;
use lumbre::film::Film;
use lumbre::metrics::stats::Estimate;
use lumbre::render::Settings;
use lumbre::strategies::Strategy;

/// Weighted layers sum to the image; and each strategy by itself, where all surfaces are matte, brings all light of its path length.
#[test]
fn each_strategy_brings_all_of_its_length() {
    const LONGEST: u32 = 4;
    const SEEDS: u32 = 12;
    let scene = canon("cornell.xml", &[("size", "32")]);
    with_gpu(|gpu| {
        let truth = {
            let settings =
                Settings { lengths: LONGEST, max_depth: Some(LONGEST), ..settings(&scene, "path", Backend::Bvh) };
            let films: Vec<_> = (0..SEEDS)
                .map(|seed| render(gpu, &scene, &Settings { seed: 100 + seed, ..settings.clone() }, 512))
                .collect();
            (0..LONGEST as usize)
                .map(|layer| {
                    let averages: Vec<f64> = films.iter().map(|film| film.length(layer).average()[1]).collect();
                    Estimate::of(&averages)
                })
                .collect::<Vec<_>>()
        };
        for backend in backends(gpu) {
            let settings =
                Settings { strategies: LONGEST, max_depth: Some(LONGEST), ..settings(&scene, "bdpt", backend) };
            let films: Vec<_> =
                (0..SEEDS).map(|seed| render(gpu, &scene, &Settings { seed, ..settings.clone() }, 256)).collect();
            for (index, strategy) in Strategy::up_to(LONGEST).enumerate() {
                let average = |film: &Film| film.image_of(&film.strategies[index].unweighted).average()[1];
                let found = Estimate::of(&films.iter().map(average).collect::<Vec<f64>>());
                let z = found.z(&truth[strategy.segments() as usize - 1]);
                println!("{} on {}: {:.5}, z {z:.2}", strategy.name(), backend.name(), found.mean);
                // Few runs: Student's t with 11 degrees of freedom, of 14 comparisons on two backends.
                assert!(z.abs() < 5.0, "{} on {}: z {z}", strategy.name(), backend.name());
                assert!(found.variance.sqrt() < 0.05 * found.mean, "{}: too coarse", strategy.name());
            }
            // Layers have a shadow ray for each connection, the technique by itself one for all: the same image in the mean.
            let plain = Settings { strategies: 0, ..settings.clone() };
            let average = |film: &Film| film.average()[1];
            let plain: Vec<f64> = (0..SEEDS)
                .map(|seed| average(&render(gpu, &scene, &Settings { seed: 50 + seed, ..plain.clone() }, 256)))
                .collect();
            let (layered, plain) =
                (Estimate::of(&films.iter().map(average).collect::<Vec<f64>>()), Estimate::of(&plain));
            println!("{}: {:.6} weighted, {:.6} without layers", backend.name(), layered.mean, plain.mean);
            assert!(layered.z(&plain).abs() < 4.0, "{layered:?} against {plain:?}");
            assert!(layered.variance.sqrt() < 2e-3 * layered.mean, "{layered:?}: too coarse");
            let (film, image) = (&films[0], films[0].mean());
            let weighted: Vec<_> = film.strategies.iter().map(|layers| film.image_of(&layers.weighted)).collect();
            for (pixel, whole) in image.pixels.iter().enumerate() {
                for (channel, whole) in whole.iter().enumerate() {
                    let sum: f64 = weighted.iter().map(|layer| f64::from(layer.pixels[pixel][channel])).sum();
                    assert!((sum - f64::from(*whole)).abs() <= 1e-5 * f64::from(*whole).max(1e-3), "pixel {pixel}");
                }
            }
        }
    });
}
