//! What a command left: its figures and its image.

use std::path::PathBuf;

use serde_json::Value;

use crate::error::{Error, Result};
use crate::image::{Image, read_layer};
use crate::statistics::Estimate;

/// A rendering that is done.
#[derive(Debug)]
pub struct Run {
    /// What it is called on the page's commands.
    pub name: String,
    /// The image.
    pub image: Image,
    pub(super) file: PathBuf,
    pub(super) figures: Value,
}

impl Run {
    fn number(&self, key: &str) -> f64 {
        self.figures.pointer(key).and_then(Value::as_f64).unwrap_or(f64::NAN)
    }

    /// Seconds of rendering, without reading the scene and making kernels.
    pub fn seconds(&self) -> f64 {
        self.number("/seconds/render")
    }

    /// Rays traced.
    pub fn rays(&self) -> f64 {
        self.number("/rays")
    }

    /// Samples of each pixel.
    pub fn spp(&self) -> f64 {
        self.number("/spp")
    }

    /// Rays of one sample, on average.
    pub fn rays_per_sample(&self) -> f64 {
        self.rays() / (self.spp() * (self.number("/width") * self.number("/height")))
    }

    /// The relMSE that the image's own variance lets expect.
    pub fn own_relmse(&self) -> f64 {
        self.number("/estimated_relmse")
    }

    /// The device that it ran on.
    pub fn device(&self) -> String {
        let field = |key: &str| self.figures.get(key).and_then(Value::as_str).unwrap_or_default();
        format!("{} ({})", field("device"), field("driver"))
    }

    /// A further layer of the image.
    pub fn layer(&self, name: &str) -> Result<Image> {
        read_layer(&self.file, name)?.ok_or_else(|| Error::read(&self.file, format!("it has no layer {name}")))
    }

    /// The mean over the image, and its variance where the image has the layer `variance`.
    pub fn mean(&self) -> Result<Estimate> {
        self.mean_of([0.0, 0.0, 1.0, 1.0])
    }

    /// The mean over a part of the image (left, top, right and bottom as shares of its sides), and its variance where the image has the
    /// layer `variance`.
    pub fn mean_of(&self, part: [f64; 4]) -> Result<Estimate> {
        let variance = self.layer("variance")?;
        let mean = average(&part_of(&self.image, part));
        let within = part_of(&variance, part);
        Ok(Estimate { mean, variance: average(&within) / (3 * within.pixels.len()).max(1) as f64 })
    }
}

/// The mean of all channels.
pub fn average(image: &Image) -> f64 {
    image.average().iter().sum::<f64>() / 3.0
}

/// A part of an image, by shares of its sides; one pixel at least.
pub fn part_of(image: &Image, [left, top, right, bottom]: [f64; 4]) -> Image {
    let range = |from: f64, to: f64, side: u32| {
        let at = |share: f64| (share * f64::from(side)).round() as u32;
        let from = at(from).min(side.saturating_sub(1));
        from..at(to).clamp(from + 1, side.max(from + 1))
    };
    let (columns, rows) = (range(left, right, image.width), range(top, bottom, image.height));
    let pixels = rows
        .clone()
        .flat_map(|y| columns.clone().map(move |x| (y * image.width + x) as usize))
        .filter_map(|index| image.pixels.get(index).copied())
        .collect();
    Image { width: columns.len() as u32, height: rows.len() as u32, pixels }
}

/// How far an image is from another: what `lumbre compare` says.
#[derive(Clone, Debug)]
pub struct Compared {
    pub(super) figures: Value,
}

impl Compared {
    /// Mean of (a - b)² / (b² + 0.01).
    pub fn relmse(&self) -> f64 {
        self.figures.get("relmse").and_then(Value::as_f64).unwrap_or(f64::NAN)
    }

    /// Mean of the image over mean of the reference.
    pub fn energy_ratio(&self) -> f64 {
        self.figures.get("energy_ratio").and_then(Value::as_f64).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_an_image() {
        let pixels = (0..8).map(|value| [value as f32; 3]).collect();
        let image = Image { width: 4, height: 2, pixels };
        let part = part_of(&image, [0.5, 0.0, 1.0, 0.5]);
        assert_eq!((part.width, part.height, average(&part)), (2, 1, 2.5));
        let point = part_of(&image, [1.0, 1.0, 1.0, 1.0]);
        assert_eq!((point.width, point.height, average(&point)), (1, 1, 7.0));
    }
}
