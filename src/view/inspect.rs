//! What is known of a pixel that the user has clicked on.

use super::news::{Facts, Picture};
use super::wanted::Choice;

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
pub fn inspect(pixel: [u32; 2], picture: &Picture, facts: &Facts, choice: &Choice) -> Option<Inspection> {
    let [x, y] = pixel;
    let (width, height) = (picture.image.width, picture.image.height);
    let index = (x < width && y < height).then(|| y * width + x)?;
    let value = *picture.image.pixels.get(index as usize)?;
    let scene = facts.scene.display().to_string();
    let scene = shlex::try_quote(&scene).map_or(scene.clone(), std::borrow::Cow::into_owned);
    let samples = picture.spp.ceil().max(1.0);
    let command = format!(
        "lumbre trace {scene} -i {} --size {width}x{height} --backend {} --sampler {} --seed {} --pixel {x},{y} --brightest-of {samples}",
        facts.technique.describe(),
        facts.backend.name(),
        facts.sampler.name(),
        choice.seed
    );
    Some(Inspection { pixel, value, command })
}
