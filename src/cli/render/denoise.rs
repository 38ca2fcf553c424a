//! `--denoise`: which techniques it goes with, and what it is fed.

use lumbre::denoise::{Denoiser, Features};
use lumbre::error::{Error, Result, one_of};
use lumbre::image::Image;
use lumbre::render::aovs::{AovFilm, find};
use lumbre::techniques::{Correlated, TECHNIQUES, TechniqueRow};

/// Fails for a technique whose noise is none to a denoiser, which knows that of independent pixels alone.
pub(super) fn check(technique: &TechniqueRow) -> Result<()> {
    let is_independent = |row: &TechniqueRow| row.correlated == Correlated::Nothing;
    if is_independent(technique) {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "--denoise with {}: its noise is correlated from pixel to pixel, which a denoiser takes for the picture; valid are {}",
        technique.name,
        one_of(TECHNIQUES.iter().filter(|row| is_independent(row)).map(|row| row.name))
    )))
}

/// The image without its noise.
pub(super) fn denoise(denoiser: &Denoiser, image: &Image, aovs: &AovFilm) -> Result<Image> {
    let [albedo, normal] = ["albedo", "normal"].map(|name| find(name).map_or(Vec::new(), |row| aovs.values(row)));
    denoiser.denoise(image, Features { albedo: &albedo, normal: &normal })
}
