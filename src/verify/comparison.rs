//! Comparisons of films with what is expected of them and with each other, in the noise that they state: the rows of the suite and the
//! tests hold what they measure by these alone.

use std::ops::Range;

use super::figure::{Figure, Worst};
use crate::render::film::Film;
use crate::statistics::{Estimate, sidak, two_sided_z};

/// The mean over all pixels and its variance, per channel, from the film's own variance.
pub fn average(film: &Film) -> [Estimate; 3] {
    tile_average(film, 0..film.width, 0..film.height)
}

/// The mean over a rectangle and its variance, per channel, from the film's own variance.
pub fn tile_average(film: &Film, columns: Range<u32>, rows: Range<u32>) -> [Estimate; 3] {
    let count = f64::from(columns.end - columns.start) * f64::from(rows.end - rows.start);
    let mut sums = [Estimate::default(); 3];
    for y in rows {
        for x in columns.clone() {
            let pixel = (y * film.width + x) as usize;
            let n = film.counts[pixel].max(1) as f64;
            for ((total, sum), variance) in sums.iter_mut().zip(film.sums[pixel]).zip(film.variance_of_mean(pixel)) {
                total.mean += sum / n / count;
                total.variance += variance / (count * count);
            }
        }
    }
    sums
}

/// Where two films of the same size are farthest apart.
#[derive(Clone, Debug)]
pub struct LargestZ {
    /// By how many standard deviations of both the means differ there; what is no number is farther than anything.
    pub z: f64,
    /// The tile and channel, and both means.
    pub place: String,
    /// Tiles and channels that were compared.
    pub count: usize,
}

/// Compares the means of two films tile by tile and channel by channel.
pub fn largest_z(a: &Film, b: &Film, tile: u32) -> LargestZ {
    let mut largest = LargestZ { z: 0.0, place: String::from("no tile"), count: 0 };
    for y in (0..a.height).step_by(tile as usize) {
        for x in (0..a.width).step_by(tile as usize) {
            let (columns, rows) = (x..(x + tile).min(a.width), y..(y + tile).min(a.height));
            let (left, right) = (tile_average(a, columns.clone(), rows.clone()), tile_average(b, columns, rows));
            for (channel, (l, r)) in left.iter().zip(&right).enumerate() {
                let z = l.z(r);
                largest.count += 1;
                if z.abs() > largest.z.abs() || z.is_nan() && !largest.z.is_nan() || largest.count == 1 {
                    largest.z = z;
                    largest.place = format!("tile ({x}, {y}), channel {channel}: {:.5} against {:.5}", l.mean, r.mean);
                }
            }
        }
    }
    largest
}

/// Holds a mean against its expected value: off by at most this share, or by three of its standard deviations, whichever is more. An
/// estimate whose three deviations exceed ten times the share and 1 % as well fails: it could not see a fault. `worst` names the place to
/// look at.
pub fn mean(
    technique: &str,
    what: &str,
    found: Estimate,
    expected: f64,
    share: f64,
    worst: impl Into<String>,
) -> Figure {
    let sigma = found.variance.sqrt() / expected.abs();
    if sigma < (10.0 * share / 3.0).max(3.4e-3) {
        return Figure::relative(technique, what, found.mean, expected, share.max(3.0 * sigma)).worst(worst);
    }
    let place = format!("standard deviation {sigma:.1e}: too few samples to tell");
    Figure { figure: f64::NAN, ..Figure::relative(technique, what, f64::NAN, expected, share) }.worst(place)
}

/// Holds two films of the same scene against each other: the largest z of all tiles and channels at the 1 % level of all together (Sidak),
/// and that of the whole image, each channel at the level `whole`.
pub fn same_mean(technique: &str, what: &str, a: &Film, b: &Film, tile: u32, whole: f64) -> [Figure; 2] {
    let LargestZ { z, place, count } = largest_z(a, b, tile);
    let of_tiles = format!("{what}: largest |z| of {count} tiles and channels");
    let of_tiles = Figure::at_most(technique, of_tiles, z.abs(), two_sided_z(sidak(0.01, count))).worst(place);
    let mut largest = Worst::default();
    for (channel, (a, b)) in average(a).iter().zip(&average(b)).enumerate() {
        largest.see(a.z(b).abs(), || format!("channel {channel}: {:.5} against {:.5}", a.mean, b.mean));
    }
    [of_tiles, largest.figure(technique, format!("{what}: |z| of the whole image"), two_sided_z(whole))]
}

/// The largest difference of a film's mean over a rectangle from that of another, over the latter, of the channels that the other has light
/// in. Not a number where one of the differences is none, or where the other has light in no channel.
pub fn largest_off(found: &Film, truth: &Film, columns: Range<u32>, rows: Range<u32>) -> f64 {
    let [found, truth] = [found, truth].map(|film| tile_average(film, columns.clone(), rows.clone()));
    let lit = found.into_iter().zip(truth).filter(|(_, truth)| truth.mean > 0.0);
    let off = lit.map(|(found, truth)| found.mean / truth.mean - 1.0);
    let farther = |worst: f64, off: f64| if worst.is_nan() || worst.abs() > off.abs() { worst } else { off };
    off.reduce(farther).unwrap_or(f64::NAN)
}

/// Pixels whose sums are not the same bits.
pub fn differing(a: &Film, b: &Film) -> f64 {
    a.sums.iter().zip(&b.sums).filter(|(a, b)| a != b).count() as f64
}

/// The pixel that is farthest from the mean of all, for its noise.
pub(super) fn oddest_pixel(film: &Film, channel: usize) -> String {
    let (mean, variance) = (film.mean(), film.mean_variance());
    let all = film.average()[channel];
    let off = |pixel: usize| {
        let deviation = f64::from(variance.pixels[pixel][channel]).sqrt().max(1e-6 * all.abs()).max(1e-30);
        (f64::from(mean.pixels[pixel][channel]) - all).abs() / deviation
    };
    let odd = (0..mean.pixels.len()).max_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(0);
    let (x, y) = (odd as u32 % film.width.max(1), odd as u32 / film.width.max(1));
    format!("pixel ({x}, {y}): {:.5}, {:.1} standard deviations off the mean", mean.pixels[odd][channel], off(odd))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(values: &[f64], variance: f64) -> Film {
        let two = |value: f64| [2.0 * value; 3];
        Film {
            width: values.len() as u32,
            height: 1,
            counts: vec![2; values.len()],
            sums: values.iter().map(|value| two(*value)).collect(),
            squares: values.iter().map(|value| two(value * value + variance)).collect(),
            ..Film::default()
        }
    }

    #[test]
    fn the_tile_that_is_farthest_off_is_named() {
        let (a, b) = (film(&[1.0, 1.0, 1.0, 2.0], 0.5), film(&[1.0, 1.0, 1.0, 5.0], 0.5));
        let all = largest_z(&a, &b, 1);
        assert_eq!((all.count, all.place.as_str()), (12, "tile (3, 0), channel 0: 2.00000 against 5.00000"));
        assert!((all.z + 3.0).abs() < 1e-12, "{}", all.z);
        // A mean over two pixels has half of the difference, and the root of half of the deviation.
        assert!((largest_z(&a, &b, 2).z + 1.5 * 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(largest_z(&a, &a, 1).z, 0.0);
        assert!(largest_z(&a, &film(&[1.0, f64::NAN, 1.0, 9.0], 0.5), 1).z.is_nan());
    }
}
