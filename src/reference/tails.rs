//! The error of a mean from independent images, and whether a few of their values decide it.

use super::certificate::OwnError;
use super::series::Series;
use crate::image::metrics::RELATIVE_FLOOR;
use crate::image::metrics::pixels::{HEAVY_TAIL, worst_share};
use crate::statistics::{Interval, student_quantile};

/// The square of how far the mean of a series is off whose one half is blurred by twice the squared radius of the other, beside the difference
/// of the halves.
pub(super) const SHIFT_OF_MEAN: f64 = 2.25;
/// How many values the tail's index is estimated from, of so many that there are.
const TAIL: f64 = 2e-3;
/// The fewest values for that.
const LEAST_TAIL: usize = 10;

/// The relMSE of a series' mean.
///
/// Each image is held against the mean of the others. How these errors scatter, in logarithms, says within which range one more error of
/// the kind lies (Student's prediction interval), and so the error of the mean: this sees noise that neighbouring pixels share, and bright
/// samples as far as some images have them and some do not.
///
/// Errors are relative to the medians of the images, which do not know the brightest samples: a firefly makes the mean of its pixel large, and
/// would look small beside that. Where the brightest samples are what there is, that is too much; so the interval begins where it does beside
/// the means.
pub fn own_error(series: &Series) -> OwnError {
    let parts: Vec<(f64, &[[f32; 3]])> = series.weighted().collect();
    if parts.len() < 2 {
        let relmse = Interval { mean: 0.0, low: 0.0, high: f64::INFINITY };
        return OwnError { relmse, bias: 0.0, largest_share: 1.0, tail_index: None, at_least: true };
    }
    let mean = series.mean();
    let (relmse, mut values) = prediction(&parts, &mean.pixels, &medians(&parts));
    let (beside_means, _) = prediction(&parts, &mean.pixels, &mean.pixels);
    values.sort_by(f64::total_cmp);
    let tail_index = tail_index(&values);
    let share = worst_share(&mut values);
    OwnError {
        relmse: Interval { low: relmse.low.min(beside_means.low), ..relmse },
        bias: 0.0,
        largest_share: share,
        tail_index,
        at_least: share > HEAVY_TAIL,
    }
}

/// The relMSE of the mean relative to `base`, with its interval, and what each pixel of each image contributes to it.
fn prediction(parts: &[(f64, &[[f32; 3]])], mean: &[[f32; 3]], base: &[[f32; 3]]) -> (Interval, Vec<f64>) {
    let n = parts.len() as f64;
    let (mut errors, mut values) = (Vec::new(), Vec::new());
    for (weight, image) in parts {
        let mut sum = 0.0;
        for ((own, all), base) in image.iter().zip(mean).zip(base) {
            let channel = |c: usize| f64::from(own[c] - all[c]).powi(2) / (f64::from(base[c]).powi(2) + RELATIVE_FLOOR);
            let value = (0..3).map(channel).sum::<f64>() / 3.0;
            sum += value;
            values.push(weight * value);
        }
        // The variance of the mean of all, as this image sees it: its distance from the mean has 1 - weight of its own variance.
        errors.push(sum / image.len().max(1) as f64 * weight / (1.0 - weight));
    }
    let mean = errors.iter().sum::<f64>() / n;
    if mean <= 0.0 {
        return (Interval::default(), values);
    }
    let logs: Vec<f64> = errors.iter().map(|error| error.max(f64::MIN_POSITIVE).ln()).collect();
    let middle = logs.iter().sum::<f64>() / n;
    let scatter = (logs.iter().map(|log| (log - middle).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let reach = student_quantile(0.975, parts.len() as u32 - 1) * scatter * (1.0 + 1.0 / n).sqrt();
    (Interval { mean, low: mean * (-reach).exp(), high: mean * reach.exp() }, values)
}

/// The median of the images in each pixel and channel.
fn medians(parts: &[(f64, &[[f32; 3]])]) -> Vec<[f32; 3]> {
    let pixels = parts.first().map_or(0, |(_, image)| image.len());
    let mut values = vec![0.0; parts.len()];
    let mut median = |pixel: usize, channel: usize| {
        for (value, (_, image)) in values.iter_mut().zip(parts) {
            *value = image[pixel][channel];
        }
        values.sort_by(f32::total_cmp);
        0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
    };
    (0..pixels).map(|pixel| std::array::from_fn(|channel| median(pixel, channel))).collect()
}

/// Hill's estimate of the index of the tail of what the sorted values are the squares of: P(|x| > t) falls like t^-index.
fn tail_index(sorted: &[f64]) -> Option<f64> {
    let count = ((TAIL * sorted.len() as f64) as usize).max(LEAST_TAIL);
    let from = sorted.len().checked_sub(count + 1)?;
    let threshold = sorted[from];
    let sum: f64 = sorted[from + 1..].iter().map(|value| (value / threshold).ln()).sum();
    (threshold > 0.0 && sum > 0.0).then(|| 2.0 * count as f64 / sum)
}

/// relMSE of the blur of a mean half of whose images are blurred by twice the squared radius of the others, as it is estimated, and so
/// many standard deviations of that more.
///
/// Blur moves a pixel in proportion to the squared radius (Knaus and Zwicker 2011, section 4), so the two halves differ by as much as the
/// finer one is off, and the mean of both is off by one and a half times that. Products of the differences of independent pairs have the
/// expectation of its square without their noise.
pub(super) fn blur(series: &Series, deviations: f64) -> f64 {
    let parts: Vec<&[[f32; 3]]> = series.weighted().map(|(_, image)| image).collect();
    let pairs: Vec<_> = parts.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
    let n = pairs.len() as f64;
    if pairs.len() < 2 {
        return f64::INFINITY;
    }
    let mean = series.mean();
    let (mut sum, mut squares) = (0.0, 0.0);
    // The same without each of the pairs (jackknife, Tukey 1958), whose scatter knows that pixels share noise.
    let mut without = vec![0.0; pairs.len()];
    let mut differences = vec![0.0; pairs.len()];
    for (pixel, all) in mean.pixels.iter().enumerate() {
        let mut contribution = 0.0;
        for (channel, all) in all.iter().enumerate() {
            for (difference, (fine, coarse)) in differences.iter_mut().zip(&pairs) {
                *difference = f64::from(coarse[pixel][channel]) - f64::from(fine[pixel][channel]);
            }
            let total: f64 = differences.iter().sum();
            let own: f64 = differences.iter().map(|difference| difference * difference).sum();
            let b = f64::from(*all);
            let scale = 1.0 / (b * b + RELATIVE_FLOOR) / 3.0;
            contribution += scale * (total * total - own) / (n * (n - 1.0));
            for (without, difference) in without.iter_mut().zip(&differences) {
                let (total, own) = (total - difference, own - difference * difference);
                *without += scale * (total * total - own) / ((n - 1.0) * (n - 2.0).max(1.0));
            }
        }
        sum += contribution;
        squares += contribution * contribution;
    }
    let pixels = mean.pixels.len().max(1) as f64;
    let middle = without.iter().sum::<f64>() / n;
    let scatter: f64 = without.iter().map(|value| (value - middle).powi(2)).sum();
    // Two pairs leave nothing to compare; then pixels must do.
    let of_pixels = (squares - sum * sum / pixels).max(0.0);
    let deviation = ((n - 1.0) / n * scatter).max(of_pixels).sqrt() / pixels;
    SHIFT_OF_MEAN * ((sum / pixels).max(0.0) + deviations * deviation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::statistics::random::Normal;

    fn series(images: usize, mut value: impl FnMut(usize, usize) -> f64) -> Series {
        let mut series = Series::new(32, 32, images, true);
        for index in 0..images {
            let pixels = (0..32 * 32).map(|pixel| [value(index, pixel) as f32; 3]).collect();
            series.add(index, &Image { width: 32, height: 32, pixels }, 1.0);
        }
        series
    }

    /// In 200 trials the stated interval holds the true error of the mean in 95 %, whether pixels have noise of their own or blocks of them
    /// share it.
    #[test]
    fn the_interval_holds_the_true_error() {
        for shared in [1, 64] {
            let mut random = Normal::new(7 + shared as u64);
            let mut covered = 0;
            for _ in 0..200 {
                let mut current = 0.0;
                let found = series(16, |_, pixel| {
                    if pixel % shared == 0 {
                        current = random.next();
                    }
                    1.0 + 0.1 * current
                });
                let truth =
                    found.mean().pixels.iter().map(|pixel| (f64::from(pixel[0]) - 1.0).powi(2) / 1.01).sum::<f64>()
                        / 1024.0;
                let own = own_error(&found);
                assert!(!own.at_least && own.relmse.contains(own.relmse.mean));
                covered += usize::from(own.covers(truth));
            }
            assert!((184..=200).contains(&covered), "{covered} of 200, noise shared by {shared}");
        }
    }

    #[test]
    fn few_bright_samples_are_noticed() {
        let mut random = Normal::new(3);
        let found = series(16, |_, _| if random.uniform() < 2e-4 { 500.0 } else { 1.0 + 0.01 * random.next() });
        let own = own_error(&found);
        assert!(own.at_least && own.largest_share > 0.9, "{own:?}");
        let truth =
            found.mean().pixels.iter().map(|pixel| (f64::from(pixel[0]) - 1.0).powi(2) / 1.01).sum::<f64>() / 1024.0;
        assert!(own.covers(truth) && (0.5..2.0).contains(&(own.relmse.mean / truth)), "{own:?} beside {truth}");
        let mut calm = Normal::new(3);
        let own = own_error(&series(16, |_, _| 1.0 + 0.01 * calm.next()));
        assert!(!own.at_least && own.largest_share < 0.02 && own.tail_index.unwrap() > 4.0, "{own:?}");
    }

    #[test]
    fn blur_is_bounded() {
        let mut random = Normal::new(11);
        // The finer half is off by 0.02 everywhere, the coarser one by twice that.
        let found = series(16, |index, _| 1.0 + 0.02 * f64::from(1 + (index % 2) as u8) + 0.05 * random.next());
        let bound = blur(&found, 2.0);
        let truth = 0.03f64.powi(2) / (1.03f64.powi(2) + 0.01);
        assert!((truth..3.0 * truth).contains(&bound), "{bound:e} against {truth:e}");
        let clean = blur(&series(16, |_, _| 1.0 + 0.05 * random.next()), 2.0);
        assert!(clean < 0.3 * truth, "{clean:e}");
    }
}
