//! Means of rectangles of films, and how far those of two films are apart for their noise.

use std::ops::Range;

use crate::render::film::Film;
use crate::statistics::Estimate;

/// The mean over all pixels and its variance, per channel, from the film's own variance.
pub fn average(film: &Film) -> [Estimate; 3] {
    tile_average(film, 0..film.width, 0..film.height)
}

/// The same over a rectangle.
pub fn tile_average(film: &Film, columns: Range<u32>, rows: Range<u32>) -> [Estimate; 3] {
    let count = f64::from(columns.end - columns.start) * f64::from(rows.end - rows.start);
    let mut sums = [Estimate::default(); 3];
    for y in rows {
        for x in columns.clone() {
            let pixel = (y * film.width + x) as usize;
            let n = film.counts[pixel].max(1) as f64;
            for (channel, total) in sums.iter_mut().enumerate() {
                let (sum, squares) = (film.sums[pixel][channel], film.squares[pixel][channel]);
                total.mean += sum / n / count;
                total.variance += ((squares - sum * sum / n) / (n - 1.0).max(1.0)).max(0.0) / n / (count * count);
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
