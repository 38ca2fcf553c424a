//! What of a rendering is shown: the image, or one of the layers beside it.

use super::display::Scale;
use crate::error::Result;
use crate::image::Image;
use crate::image::metrics::{heat_map, heat_scale};
use crate::render::Renderer;
use crate::render::aovs::{AovRow, find};
use crate::render::film::Film;

/// The most samples of AOVs, which are made anew for each picture.
const AOV_SAMPLES: u32 = 16;

/// What is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layer {
    /// The image.
    #[default]
    Image,
    /// The contribution of paths of so many segments.
    Length(u32),
    /// The contribution of a strategy (s, t), by itself or with its weight.
    Strategy {
        /// Vertices from the light.
        s: u32,
        /// Vertices from the camera.
        t: u32,
        /// With its weight under MIS.
        weighted: bool,
    },
    /// An AOV of that name.
    Aov(&'static str),
    /// The standard deviation of each pixel's mean.
    Deviation,
    /// The relative difference to the reference: red where the image is brighter, blue where it is darker.
    Difference,
}

impl Layer {
    /// What it is called.
    pub fn name(&self) -> String {
        match self {
            Self::Image => String::from("image"),
            Self::Length(segments) => format!("length {segments}"),
            Self::Strategy { s, t, weighted } => {
                format!("s = {s}, t = {t}{}", if *weighted { "" } else { ", unweighted" })
            }
            Self::Aov(name) => name.replace('_', " "),
            Self::Deviation => String::from("standard deviation"),
            Self::Difference => String::from("difference to the reference"),
        }
    }

    /// How its values become colours.
    pub fn scale(&self) -> Scale {
        match self {
            Self::Aov("normal" | "geometric_normal") => Scale::Direction,
            Self::Aov("position" | "depth" | "uv") => Scale::Range,
            Self::Aov("material_id" | "object_id") => Scale::Number,
            Self::Difference => Scale::Colour,
            _ => Scale::Radiance,
        }
    }

    /// Its values in a film; the image where the film does not have it.
    pub fn of(&self, film: &Film, renderer: &Renderer, reference: Option<&Image>) -> Result<Image> {
        Ok(match self {
            Self::Length(segments) if (1..=film.lengths.len()).contains(&(*segments as usize)) => {
                film.length(*segments as usize - 1)
            }
            Self::Strategy { s, t, weighted } => {
                let found = film.strategies.iter().find(|own| (own.strategy.s, own.strategy.t) == (*s, *t));
                let sums = found.map(|own| if *weighted { &own.weighted } else { &own.unweighted });
                sums.map_or_else(|| film.mean(), |sums| film.image_of(sums))
            }
            Self::Aov(name) => match (renderer.aovs_of(renderer.spp().min(AOV_SAMPLES))?, find(name)) {
                (Some(aovs), Some(row)) => {
                    let values = aovs.values(row);
                    Image { width: film.width, height: film.height, pixels: spread(row, values) }
                }
                _ => film.mean(),
            },
            Self::Deviation => {
                let mut image = film.mean_variance();
                image.pixels.iter_mut().flatten().for_each(|value| *value = value.sqrt());
                image
            }
            Self::Difference => match reference {
                Some(reference) => {
                    let mean = film.mean();
                    heat_map(&mean, reference, heat_scale(&mean, reference))
                }
                None => film.mean(),
            },
            Self::Image | Self::Length(_) => film.mean(),
        })
    }
}

/// The values of an AOV of one channel are grey.
fn spread(row: &AovRow, mut values: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
    if row.channels.len() == 1 {
        values.iter_mut().for_each(|value| *value = [value[0]; 3]);
    }
    values
}
