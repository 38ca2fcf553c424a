//! The strategies of bidirectional path tracing: the contribution of each, and its weight.

use crate::common::room::{LAMP, room, scene};
use crate::common::{backends_in_time, canon, films, settings, verify, with_gpu};
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::Scene;
use lumbre::statistics::{Estimate, sidak, two_sided_p};
use lumbre::techniques::Strategies;

const LONGEST: u32 = 4;
const SEEDS: u32 = 16;

#[test]
fn weights_are_those_of_the_definition() {
    verify(&["mis-weights", "path-weights"]);
}

/// The mean of what these have, and its variance.
fn estimate(films: &[Film], of: impl Fn(&Film) -> f64) -> Estimate {
    Estimate::of(&films.iter().map(of).collect::<Vec<f64>>())
}

/// Each strategy by itself finds all light of its path length, where all surfaces are matte, as `path` does; all of them weighted sum to the
/// image, sample by sample, and are in the mean what the technique gives without layers. `noise` is the most that the standard deviation of a
/// strategy may be.
fn each_brings_all_of_its_length(what: &str, scene: &Scene, spp: u32, noise: f64, on: fn(&Gpu) -> Vec<Backend>) {
    with_gpu(|gpu| {
        let lengths = Settings { lengths: LONGEST, max_depth: Some(LONGEST), ..settings(scene, "path", Backend::Bvh) };
        let truth = films(gpu, scene, &Settings { seed: 100, ..lengths }, SEEDS, 2 * spp);
        let strategies = Strategies::of(LONGEST, scene.camera(None).unwrap());
        let count = strategies.all().count();
        let image = estimate(&truth, |film| film.average()[1]);
        for backend in on(gpu) {
            let plain = Settings { max_depth: Some(LONGEST), ..settings(scene, "bdpt", backend) };
            let layered = Settings { strategies: Some(strategies), ..plain.clone() };
            let layered = films(gpu, scene, &layered, SEEDS, spp);
            for (index, strategy) in strategies.all().enumerate() {
                let found = estimate(&layered, |film| film.image_of(&film.strategies[index].unweighted).average()[1]);
                let truth = estimate(&truth, |film| film.length(strategy.segments() as usize - 1).average()[1]);
                // Of the strategy's light, or of the hundredth part of all where it has less.
                let (z, sigma) = (found.z(&truth), found.variance.sqrt() / found.mean.max(0.01 * image.mean));
                let name = format!("{what}, {} on {}", strategy.name(), backend.name());
                println!("{name}: {:.6}, sigma {:.2} %, z {z:.2}", found.mean, 100.0 * sigma);
                assert!(two_sided_p(z) > sidak(0.01, count), "{name}: z {z}");
                assert!(sigma < noise, "{name}: sigma {sigma} is too coarse");
            }
            // Layers have a shadow ray for each connection, the technique by itself one for all.
            let (found, alone) = (&layered, films(gpu, scene, &Settings { seed: 50, ..plain }, SEEDS, spp));
            let [found, alone] = [found, &alone].map(|films| estimate(films, |film| film.average()[1]));
            println!("{what} on {}: {:.6} weighted, {:.6} without layers", backend.name(), found.mean, alone.mean);
            assert!(found.z(&alone).abs() < 3.5, "{found:?} against {alone:?}");
            assert!(found.variance.sqrt() < 2e-3 * found.mean, "{found:?}: too coarse");
            let (film, image) = (&layered[0], layered[0].mean());
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

#[test]
fn in_the_cornell_box() {
    let scene = canon("cornell.xml", &[("size", "32")]);
    each_brings_all_of_its_length("cornell", &scene, 256, 0.02, backends_in_time);
}

/// Through a lens, which paths from the light run into (t = 0), and with filters wider than a pixel. One backend is enough: layers know
/// nothing of rays.
#[test]
fn to_a_lens() {
    let sensor = "<sensor type='thinlens'><float name='fov' value='40'/><float name='aperture_radius' value='1.5'/>
        <float name='focus_distance' value='5'/><transform name='to_world'><lookat origin='0, 1, 4' target='0, 0.8, 0' up='0, 1, 0'/></transform>
        <film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='24'/><rfilter type='tent'/></film></sensor>";
    let matte = "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='0.6'/></bsdf></bsdf>";
    let scene = scene(&[sensor, &room(matte, matte), LAMP].concat());
    let strategies = Strategies::of(LONGEST, scene.camera(None).unwrap());
    assert_eq!(strategies.all().filter(|strategy| strategy.t == 0).count(), 3);
    each_brings_all_of_its_length("a lens", &scene, 384, 0.05, |_| vec![Backend::Bvh]);
}
