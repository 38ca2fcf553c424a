//! Images of many samples that others are held against, rendered once and kept in `tests/truths`: a test has the time for a few of its own.
//!
//! A truth is the mean and its variance of a rendering by a technique that the test holds others against. Where there is time
//! (`make thorough`) it is rendered anew each time. `LUMBRE_TEST_TRUTHS=make` does so and writes the files of the tests that run:
//! whoever changes a scene that one shows has to.

use std::path::{Path, PathBuf};

use lumbre::gpu::Gpu;
use lumbre::image::{Image, NamedLayer, Picture, read_image, read_layer, write_picture};
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::Scene;
use lumbre::statistics::Estimate;

const VARIANCE: &str = "variance";

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/truths").join(format!("{name}.exr"))
}

/// A film with these means and variances of them.
fn of(mean: &Image, variance: &Image) -> Film {
    let estimate = |(mean, variance): (&[f32; 3], &[f32; 3])| {
        [0, 1, 2].map(|channel| Estimate { mean: mean[channel].into(), variance: variance[channel].into() })
    };
    let pixels: Vec<[Estimate; 3]> = mean.pixels.iter().zip(&variance.pixels).map(estimate).collect();
    super::film_of(mean.width, mean.height, &pixels)
}

/// The image of a scene with these settings after so many samples, of which the file tells mean and variance.
pub fn truth(gpu: &Gpu, name: &str, scene: &Scene, settings: &Settings, spp: u32) -> Film {
    let path = file(name);
    let is_made = std::env::var("LUMBRE_TEST_TRUTHS").is_ok_and(|what| what == "make");
    if is_made || super::has_time() {
        let film = super::render(gpu, scene, settings, spp);
        if !is_made {
            return film;
        }
        let layers = vec![NamedLayer::colours(VARIANCE, film.mean_variance())];
        let what = format!("{}, {spp} samples per pixel, seed {}", settings.technique.describe(), settings.seed);
        let header = vec![(String::from("settings"), what)];
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        write_picture(&path, &Picture { image: film.mean(), layers, header }).unwrap();
    }
    let image = read_image(&path).unwrap_or_else(|error| panic!("{error}: LUMBRE_TEST_TRUTHS=make makes it"));
    assert_eq!((image.width, image.height), (settings.width, settings.height), "{}", path.display());
    of(&image, &read_layer(&path, VARIANCE).unwrap().unwrap())
}
