//! `render -e`: how often the error is what the rendering said when it stopped.

use crate::common::{canon, render, settings, with_gpu};
use lumbre::bench::Truth;
use lumbre::image::metrics::compare;
use lumbre::layout::backend::Backend;
use lumbre::render::{ErrorTarget, Renderer};
use lumbre::techniques::Sampler;

#[test]
fn the_error_is_what_was_asked_for() {
    stops_in_time(Sampler::Sobol, 0.0013);
}

#[test]
fn the_error_is_what_was_asked_for_of_independent_samples() {
    stops_in_time(Sampler::Independent, 0.003);
}

/// Twenty renderings stop at a relMSE, after 100 to 200 samples by either sampler; the true one, against a reference whose own noise is taken off, lies within 15 % of it.
fn stops_in_time(sampler: Sampler, target: f64) {
    let scene = canon("cornell.xml", &[("size", "64")]);
    with_gpu(|gpu| {
        let mut settings = settings(&scene, "path", Backend::Bvh);
        (settings.seed, settings.sampler) = (1_000_000, sampler);
        let film = render(gpu, &scene, &settings, 4096);
        let truth = Truth::new(film.mean(), Some(film.mean_variance()));
        let mut renderer = Renderer::new(gpu, &scene, &settings).unwrap();
        let (mut ratios, mut spps) = (Vec::new(), Vec::new());
        for seed in 0..20 {
            renderer.restart(seed).unwrap();
            let mut stop = ErrorTarget::new(target);
            while !stop.is_reached(&renderer).unwrap() {
                assert!(renderer.spp() < 2048, "2048 spp were not enough");
                renderer.advance(stop.next()).unwrap();
            }
            let own = renderer.film().unwrap();
            let stated = own.error_estimate().unwrap().relmse;
            assert!(stated <= target && stated > 0.7 * target, "{stated}");
            let error = compare(&own.mean(), &truth.image).unwrap().relmse - truth.relmse().unwrap();
            ratios.push(error / stated);
            spps.push(renderer.spp());
        }
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let good = ratios.iter().filter(|ratio| (*ratio - 1.0).abs() < 0.15).count();
        let range = ratios.iter().fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(*r), high.max(*r)));
        println!(
            "relMSE {target} after {} to {} spp: true over stated {:.3} to {:.3}, mean {mean:.3}; {good} of 20 within 15 %",
            spps.iter().min().unwrap(),
            spps.iter().max().unwrap(),
            range.0,
            range.1
        );
        assert!(good >= 18, "{ratios:?}");
        assert!((mean - 1.0).abs() < 0.06, "{mean}");
    });
}
