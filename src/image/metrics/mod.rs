//! How far an image is from a reference, in linear values.

mod bias;
mod flip;
pub mod pixels;

use serde::Serialize;

pub use bias::{SquaredBias, squared_bias};
pub use flip::flip_map;

use crate::error::{Error, Result};
use crate::image::Image;

/// What relMSE adds to the reference's square, so that black pixels do not decide.
pub const RELATIVE_FLOOR: f64 = 1e-2;

/// The figures of `lumbre compare`. Pixels and channels where either image is not finite are counted and left out.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Comparison {
    /// Mean of (a - b)².
    pub mse: f64,
    /// Its root.
    pub rmse: f64,
    /// Mean of (a - b)² / (b² + 0.01).
    pub relmse: f64,
    /// Mean of |a - b| / (|b| + 0.01).
    pub mape: f64,
    /// Mean of FLIP (Andersson et al. 2020) over the sRGB pictures.
    pub flip: f64,
    /// Mean of a over mean of b.
    pub energy_ratio: f64,
    /// Largest |a - b|.
    pub max_abs: f64,
    /// Values that are not finite in either image.
    pub nonfinite: u64,
}

/// Compares an image with a reference of the same size.
pub fn compare(image: &Image, reference: &Image) -> Result<Comparison> {
    same_size(image, reference)?;
    let (mut count, mut nonfinite, mut mse, mut relmse, mut mape, mut max_abs) = (0u64, 0u64, 0.0, 0.0, 0.0, 0.0f64);
    let mut sums = [0.0; 2];
    for (a, b) in image.pixels.iter().flatten().zip(reference.pixels.iter().flatten()) {
        if !(a.is_finite() && b.is_finite()) {
            nonfinite += 1;
            continue;
        }
        let (a, b) = (f64::from(*a), f64::from(*b));
        let difference = a - b;
        count += 1;
        mse += difference * difference;
        relmse += difference * difference / (b * b + RELATIVE_FLOOR);
        mape += difference.abs() / (b.abs() + RELATIVE_FLOOR);
        max_abs = max_abs.max(difference.abs());
        sums[0] += a;
        sums[1] += b;
    }
    let count = count.max(1) as f64;
    let flip = flip_map(image, reference);
    Ok(Comparison {
        mse: mse / count,
        rmse: (mse / count).sqrt(),
        relmse: relmse / count,
        mape: mape / count,
        flip: flip.iter().map(|value| f64::from(*value)).sum::<f64>() / flip.len().max(1) as f64,
        energy_ratio: sums[0] / sums[1],
        max_abs,
        nonfinite,
    })
}

/// Fails where the images differ in size.
pub fn same_size(image: &Image, reference: &Image) -> Result<()> {
    if (image.width, image.height) == (reference.width, reference.height) {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "the image has {}x{} pixels and the reference {}x{}: they must be of one size",
        image.width, image.height, reference.width, reference.height
    )))
}

/// A picture of the signed relative difference per pixel: red where the image is brighter than the reference, blue where
/// it is darker, white where they agree; full colour stands for `scale`.
pub fn heat_map(image: &Image, reference: &Image, scale: f64) -> Image {
    let pixels = image.pixels.iter().zip(&reference.pixels).map(|(a, b)| {
        let value = (relative_difference(a, b) / scale).clamp(-1.0, 1.0) as f32;
        if value.is_nan() {
            return [0.0, 1.0, 0.0]; // not finite: a colour that nothing else has
        }
        let fade = 1.0 - value.abs();
        if value >= 0.0 { [1.0, fade, fade] } else { [fade, fade, 1.0] }
    });
    Image { width: image.width, height: image.height, pixels: pixels.collect() }
}

/// The value below which 99 % of the pixels' relative differences lie: a scale for [`heat_map`].
pub fn heat_scale(image: &Image, reference: &Image) -> f64 {
    let pairs = image.pixels.iter().zip(&reference.pixels);
    let mut values: Vec<f64> =
        pairs.map(|(a, b)| relative_difference(a, b).abs()).filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let at = values.len().saturating_sub(1) * 99 / 100;
    values.get(at).copied().filter(|value| *value > 0.0).unwrap_or(1.0)
}

/// (a - b) / (b + 0.01) of the mean of the channels.
fn relative_difference(a: &[f32; 3], b: &[f32; 3]) -> f64 {
    let mean = |pixel: &[f32; 3]| pixel.iter().map(|channel| f64::from(*channel)).sum::<f64>() / 3.0;
    (mean(a) - mean(b)) / (mean(b).abs() + RELATIVE_FLOOR)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[[f32; 3]]) -> Image {
        Image { width: pixels.len() as u32, height: 1, pixels: pixels.to_vec() }
    }

    #[test]
    fn figures_by_hand() {
        let a = image(&[[1.0, 2.0, 0.5], [0.0, 0.0, 0.0]]);
        let b = image(&[[1.5, 2.0, 0.5], [0.0, 0.0, 0.1]]);
        let found = compare(&a, &b).unwrap();
        // (0.25 + 0.01) / 6; relative: (0.25 / 2.26 + 0.01 / 0.02) / 6; MAPE: (0.5 / 1.51 + 0.1 / 0.11) / 6
        assert!((found.mse - 0.26 / 6.0).abs() < 1e-8);
        assert!((found.relmse - (0.25 / 2.26 + 0.5) / 6.0).abs() < 1e-6);
        assert!((found.mape - (0.5 / 1.51 + 0.1 / 0.11) / 6.0).abs() < 1e-6);
        assert!((found.energy_ratio - 3.5 / 4.1).abs() < 1e-6);
        assert!((found.max_abs - 0.5).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_left_out() {
        let a = image(&[[f32::NAN, 1.0, 1.0]]);
        let b = image(&[[1.0, f32::INFINITY, 1.0]]);
        let found = compare(&a, &b).unwrap();
        assert_eq!(found.nonfinite, 2);
        assert_eq!(found.mse, 0.0);
    }

    #[test]
    fn sizes_must_agree() {
        assert!(compare(&image(&[[0.0; 3]]), &image(&[[0.0; 3]; 2])).unwrap_err().to_string().contains("1x1"));
    }
}
