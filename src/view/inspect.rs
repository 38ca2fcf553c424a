//! What is known of a pixel that the user has clicked on.

use super::news::{Facts, Picture};

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

/// What there is to say of a pixel. The path through it, once something traces it, belongs here.
pub fn inspect(pixel: [u32; 2], picture: &Picture, facts: &Facts) -> Option<Inspection> {
    let [x, y] = pixel;
    let index = (x < picture.image.width && y < picture.image.height).then(|| y * picture.image.width + x)?;
    let value = *picture.image.pixels.get(index as usize)?;
    let scene = facts.scene.display().to_string();
    let scene = shlex::try_quote(&scene).map_or(scene.clone(), std::borrow::Cow::into_owned);
    let command = format!("lumbre trace {scene} --pixel {x},{y} -i {}", facts.technique.describe());
    Some(Inspection { pixel, value, command })
}
