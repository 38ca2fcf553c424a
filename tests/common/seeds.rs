//! Comparing techniques by independent seeds, where a film's own variance does not tell the error of a mean over its pixels.

use super::{assert_same_mean, film_of, films, render, settings, tile_average, truth, with_gpu};
use lumbre::layout::backend::Backend;
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::Scene;
use lumbre::statistics::Estimate;

/// Pixels on a side of the image.
pub const SIZE: u32 = 48;
/// Pixels on a side of a tile.
pub const TILE: u32 = 16;

/// Settings for a small image.
pub fn small(scene: &Scene, technique: &str) -> Settings {
    Settings { width: SIZE, height: SIZE, ..settings(scene, technique, Backend::Bvh) }
}

/// Techniques whose pixels or samples are correlated against an independent one, tile by tile: tiles of one seed's image are correlated, so the
/// mean of each is taken first, and its variance from how the seeds differ.
pub fn agree(
    techniques: &[&str],
    what: &str,
    scene: &Scene,
    reference: &str,
    [seeds, spp]: [u32; 2],
    change: impl Fn(&mut Settings),
) {
    with_gpu(|gpu| {
        let mut truth = small(scene, reference);
        truth.seed = 1000;
        change(&mut truth);
        // `bdpt` of a scene of the canon takes longer than all chains.
        let truth = match what.strip_suffix(".xml").filter(|_| reference == "bdpt") {
            Some(stem) => tiles(&truth::truth(gpu, &format!("{stem}-small-bdpt"), scene, &truth, seeds * spp)),
            None => tiles(&render(gpu, scene, &truth, seeds * spp)),
        };
        for technique in techniques {
            let mut settings = small(scene, technique);
            change(&mut settings);
            assert_same_mean(
                &format!("{what}: {technique}"),
                &tiles_over(&films(gpu, scene, &settings, seeds, spp)),
                &truth,
                1,
            );
        }
    });
}

/// The means of a film's tiles, with the variance that it states.
fn means(film: &Film) -> (u32, u32, Vec<[Estimate; 3]>) {
    let (across, down) = (film.width.div_ceil(TILE), film.height.div_ceil(TILE));
    let tile = |index: u32| {
        let (x, y) = (index % across * TILE, index / across * TILE);
        tile_average(film, x..(x + TILE).min(film.width), y..(y + TILE).min(film.height))
    };
    (across, down, (0..across * down).map(tile).collect())
}

/// A film whose pixels are the means of another one's tiles, with the variance that this one states.
pub fn tiles(film: &Film) -> Film {
    let (across, down, means) = means(film);
    film_of(across, down, &means)
}

/// A film whose pixels are the means of films' tiles, with the variance that the films differ by.
pub fn tiles_over(films: &[Film]) -> Film {
    let all: Vec<_> = films.iter().map(means).collect();
    let over = |tile: usize| {
        std::array::from_fn(|channel| {
            Estimate::of(&all.iter().map(|(_, _, means)| means[tile][channel].mean).collect::<Vec<f64>>())
        })
    };
    let (across, down, first) = &all[0];
    film_of(*across, *down, &(0..first.len()).map(over).collect::<Vec<_>>())
}
