//! The bias of images of one expectation, told from their noise.

use super::RELATIVE_FLOOR;
use crate::image::Image;

/// An estimate of what more samples do not take away, with its deviation if there were nothing of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredBias {
    /// Squared bias over (b² + 0.01), mean over pixels and channels: a relMSE. Unbiased, so noise can make it negative.
    pub relative: f64,
    /// Standard deviation of that where there is no bias.
    pub deviation: f64,
}

/// The squared bias of independent images of one expectation, against a reference `b` of known variance.
///
/// For two of them, (a1 - b)(a2 - b) has the expectation bias² + variance of b: their own noise drops out. This averages over
/// all pairs (a U-statistic, Hoeffding 1948) and takes the reference's variance off. Its variance without bias follows from the
/// images' own: 2 v² / (n (n - 1)) + 4 v w / n + 2 w² for variances v of an image and w of the reference; channels of a pixel
/// are taken as fully correlated, pixels as independent. Rare bright samples are not normal, and a few pixels that hold one can make
/// all of the sum: so the deviation is at least the one that the scatter of the pixels' contributions gives.
pub fn squared_bias(images: &[Image], reference: &Image, reference_variance: Option<&Image>) -> SquaredBias {
    let n = images.len() as f64;
    if images.len() < 2 {
        return SquaredBias::default();
    }
    let (mut sum, mut squares_of_pixels, mut variance) = (0.0, 0.0, 0.0);
    for pixel in 0..reference.pixels.len() {
        let (mut deviation, mut contribution) = (0.0, 0.0);
        for channel in 0..3 {
            let b = f64::from(reference.pixels[pixel][channel]);
            let w = reference_variance.map_or(0.0, |image| f64::from(image.pixels[pixel][channel]));
            let (mut total, mut squares) = (0.0, 0.0);
            for image in images {
                let d = f64::from(image.pixels[pixel][channel]) - b;
                total += d;
                squares += d * d;
            }
            let scale = 1.0 / (b * b + RELATIVE_FLOOR);
            let v = ((squares - total * total / n) / (n - 1.0)).max(0.0);
            contribution += scale * ((total * total - squares) / (n * (n - 1.0)) - w);
            deviation += scale * (2.0 * v * v / (n * (n - 1.0)) + 4.0 * v * w / n + 2.0 * w * w).sqrt();
        }
        variance += deviation * deviation;
        sum += contribution;
        squares_of_pixels += contribution * contribution;
    }
    let pixels = reference.pixels.len().max(1) as f64;
    let scatter = (squares_of_pixels - sum * sum / pixels).max(0.0);
    SquaredBias { relative: sum / (3.0 * pixels), deviation: variance.max(scatter).sqrt() / (3.0 * pixels) }
}
