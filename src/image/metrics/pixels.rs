//! Squared relative errors pixel by pixel, and what of them a few bright samples do not decide.

use super::RELATIVE_FLOOR;
use crate::image::Image;

/// The share of the pixels that is left out as the worst: at least one.
pub const WORST: f64 = 1e-3;
/// Parts of an image whose means have a median: bright pixels in three of them do not decide it.
pub const PARTS: usize = 8;
/// Median of the square of a standard normal variable.
const MEDIAN_OF_SQUARE: f64 = 0.454_936;

/// Pixels below which none counts as an exception.
const FEW: usize = 100;
/// The share of the sum of squared errors from which on the worst [`WORST`] of the pixels decide it.
pub const HEAVY_TAIL: f64 = 0.3;

/// How many pixels are the worst [`WORST`] of so many: one at least, and none where there are few in all.
fn worst(count: usize) -> usize {
    if count < FEW { 0 } else { ((WORST * count as f64).ceil() as usize).max(1) }
}

/// Share of the sum of the pixels' squared errors that the worst [`WORST`] of them make. Their order changes.
pub fn worst_share(errors: &mut [f64]) -> f64 {
    let sum: f64 = errors.iter().sum();
    if sum <= 0.0 {
        return 0.0;
    }
    let from = errors.len() - worst(errors.len());
    if from == errors.len() {
        return 0.0;
    }
    errors.select_nth_unstable_by(from, f64::total_cmp);
    errors[from..].iter().sum::<f64>() / sum
}

/// What the squared relative errors of an image's pixels come to. The noise of the reference is taken off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelErrors {
    /// Their mean without the worst [`WORST`].
    pub trimmed: f64,
    /// Their median.
    pub median: f64,
    /// Their mean as the median of the means of [`PARTS`] parts of the image, into which they are dealt at random (Nemirovsky and Yudin 1983):
    /// bright samples count where they are so many that most parts have some, and not where they are few.
    pub of_parts: f64,
    /// Share of their sum that the worst [`WORST`] make.
    pub worst_share: f64,
}

/// Mean over the channels of value / (b² + 0.01) for each pixel; `value` gets a channel of the image and of the reference.
fn per_pixel(image: &Image, reference: &Image, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let pairs = image.pixels.iter().zip(&reference.pixels);
    let pixel = |(a, b): (&[f32; 3], &[f32; 3])| {
        let channel = |(a, b): (&f32, &f32)| {
            let (a, b) = (f64::from(*a), f64::from(*b));
            value(a, b) / (b * b + RELATIVE_FLOOR)
        };
        a.iter().zip(b).map(channel).sum::<f64>() / 3.0
    };
    pairs.map(pixel).collect()
}

/// (a - b)² / (b² + 0.01) of each pixel, the mean of its channels.
pub fn squared_errors(image: &Image, reference: &Image) -> Vec<f64> {
    per_pixel(image, reference, |a, b| (a - b).powi(2))
}

/// The figures of an image against a reference, with the variance of the reference's pixels and one more error of the kind that it has, where
/// these are known. Pixels that are not finite are left out.
///
/// The variance is taken off each pixel that stays in a mean. Off the median goes that of the reference's own squared errors, which is right
/// where the errors of both are distributed alike; where it has no more than variances, 0.455 times their median, as of normal errors.
pub fn pixel_errors(
    image: &Image,
    reference: &Image,
    variance: Option<&Image>,
    own_error: Option<&Image>,
) -> PixelErrors {
    let errors = squared_errors(image, reference);
    let noise = match variance {
        Some(variance) => per_pixel(variance, reference, |w, _| w),
        None => vec![0.0; errors.len()],
    };
    let of_parts = median_of_parts(errors.iter().zip(&noise).map(|(error, noise)| error - noise));
    let mut pixels: Vec<(f64, f64)> = errors.into_iter().zip(noise).filter(|(error, _)| error.is_finite()).collect();
    if pixels.is_empty() {
        return PixelErrors::default();
    }
    pixels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (most, tail) = pixels.split_at(pixels.len() - worst(pixels.len()));
    let sum = |pixels: &[(f64, f64)]| pixels.iter().map(|(error, noise)| error - noise).sum::<f64>();
    let errors = |pixels: &[(f64, f64)]| pixels.iter().map(|(error, _)| error).sum::<f64>();
    let median_of_own = match own_error {
        Some(own) => median(per_pixel(own, reference, |error, _| error * error)),
        None => MEDIAN_OF_SQUARE * median(pixels.iter().map(|(_, noise)| *noise).collect()),
    };
    let middle = pixels.len() / 2;
    let all = errors(&pixels);
    PixelErrors {
        of_parts,
        trimmed: sum(most) / most.len().max(1) as f64,
        median: pixels[middle].0 - median_of_own,
        worst_share: if all > 0.0 { errors(tail) / all } else { 0.0 },
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    values.sort_by(f64::total_cmp);
    values.get(middle).copied().unwrap_or(0.0)
}

/// A number that looks random, by its bits (the last step of MurmurHash3, Appleby 2011).
fn mixed(mut number: u32) -> u32 {
    number = (number ^ number >> 16).wrapping_mul(0x85eb_ca6b);
    number = (number ^ number >> 13).wrapping_mul(0xc2b2_ae35);
    number ^ number >> 16
}

/// The median of the means of parts into which the pixels are dealt, the same for every image.
fn median_of_parts(errors: impl Iterator<Item = f64>) -> f64 {
    let mut parts = [(0.0, 0.0); PARTS];
    for (pixel, error) in errors.enumerate().filter(|(_, error)| error.is_finite()) {
        let (sum, count) = &mut parts[mixed(pixel as u32) as usize % PARTS];
        *sum += error;
        *count += 1.0;
    }
    let mut means: Vec<f64> = parts.iter().filter(|(_, count)| *count > 0.0).map(|(sum, count)| sum / count).collect();
    means.sort_by(f64::total_cmp);
    let middle = means.len() / 2;
    match means.len() {
        0 => 0.0,
        n if n % 2 == 1 => means[middle],
        _ => 0.5 * (means[middle - 1] + means[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(values: impl Iterator<Item = f32>) -> Image {
        let pixels: Vec<[f32; 3]> = values.map(|value| [value; 3]).collect();
        Image { width: pixels.len() as u32, height: 1, pixels }
    }

    #[test]
    fn one_firefly_decides_the_mean_alone() {
        let reference = image((0..2000).map(|_| 1.0));
        let off = |k: u32| if k.is_multiple_of(2) { 1.1 } else { 0.8 };
        let calm = pixel_errors(&image((0..2000).map(off)), &reference, None, None);
        let struck =
            pixel_errors(&image((0..2000).map(|k| if k == 77 { 1000.0 } else { off(k) })), &reference, None, None);
        // Half of the pixels are 0.1 off, half 0.2: 0.01 and 0.04 over 1.01.
        assert!((calm.trimmed - 0.025 / 1.01).abs() < 2e-5, "{calm:?}");
        assert!((calm.median - 0.04 / 1.01).abs() < 1e-5 && calm.worst_share < 0.002, "{calm:?}");
        assert!((struck.trimmed / calm.trimmed - 1.0).abs() < 2e-3 && struck.median == calm.median, "{struck:?}");
        assert!(struck.worst_share > 0.99, "{struck:?}");
        assert!((struck.of_parts / calm.of_parts - 1.0).abs() < 0.05, "{struck:?} {calm:?}");
        assert!((calm.of_parts / calm.trimmed - 1.0).abs() < 0.05, "{calm:?}");
        // Sixty of them are what there is: the trimmed mean, too, has most of them.
        let many = |k: u32| if k % 33 == 7 { 1000.0 } else { off(k) };
        let rain = pixel_errors(&image((0..2000).map(many)), &reference, None, None);
        assert!((rain.of_parts / (999.0f64.powi(2) / 1.01 / 33.0) - 1.0).abs() < 0.3, "{rain:?}");
    }

    #[test]
    fn the_noise_of_the_reference_is_taken_off() {
        // An exact image against references with the noise of +-s: all of the error is theirs.
        let noisy = image((0..4000).map(|k| if k % 2 == 0 { 1.02 } else { 0.98 }));
        let variance = image((0..4000).map(|_| 4e-4));
        let found = pixel_errors(&image((0..4000).map(|_| 1.0)), &noisy, Some(&variance), None);
        assert!(found.trimmed.abs() < 1e-7 && found.of_parts.abs() < 1e-7, "{found:?}");
        // Half of all errors are +-s, and so is what is known of the reference's.
        let own = image((0..4000).map(|k| if k % 3 == 0 { 0.02 } else { -0.02 }));
        let found = pixel_errors(&image((0..4000).map(|_| 1.0)), &noisy, Some(&variance), Some(&own));
        assert!(found.median.abs() < 2e-5, "{found:?}");
    }
}
