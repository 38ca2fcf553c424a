//! What is known of a pixel that the user has clicked on.

use super::news::{Facts, Picture};
use super::wanted::Wanted;

/// A pixel, and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// Its column and row.
    pub pixel: [u32; 2],
    /// Its value, linear, when it was clicked on.
    pub value: [f32; 3],
    /// The command that traces a path through it.
    pub command: String,
}

/// What there is to say of a pixel before its brightest sample is traced.
pub fn inspect(pixel: [u32; 2], picture: &Picture, facts: &Facts, wanted: &Wanted) -> Option<Inspection> {
    let [x, y] = pixel;
    let (width, height) = (picture.image.width, picture.image.height);
    let index = (x < width && y < height).then(|| y * width + x)?;
    let value = *picture.image.pixels.get(index as usize)?;
    let samples = picture.spp.ceil().max(1.0);
    let asks = ["--pixel", &format!("{x},{y}"), "--brightest-of", &samples.to_string()];
    let command =
        crate::trace::command(&facts.scene, &wanted.options, &wanted.choice.overrides, &facts.settings, &asks);
    Some(Inspection { pixel, value, command })
}
