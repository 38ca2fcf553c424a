//! An independent run of another technique that looks at a reference tile by tile.

use super::certificate::{Difference, Witness};
use super::series::Series;
use super::tiles::{Tile, TileMean, TileMeans};
use crate::image::metrics::RELATIVE_FLOOR;
use crate::statistics::sidak;

/// Probability of a false alarm in all of the image.
const ALPHA: f64 = 0.01;
/// Each size of tile is this many times the one before it, beginning with one pixel.
const STEP: u32 = 4;
/// The most places that are named.
const NAMED: usize = 12;
/// Deviations that a difference in one of many tiles has when it is seen.
const DETECTED: f64 = 4.5;
/// A smaller tile within is named in a tile's place where it has this many times the deviations that a difference which is the same everywhere
/// would give it.
const MORE_THAN_ITS_SHARE: f64 = 1.4;
/// Tiles of this size are those that [`Witness::detectable`] speaks of.
const SPOKEN_OF: u32 = 16;

/// What reference and witness find only by chance, in words: what a difference is likely to be.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kinds<'a> {
    /// Of what made the reference.
    pub of_reference: Option<&'a str>,
    /// Of the witness.
    pub of_witness: Option<&'a str>,
}

impl Kinds<'_> {
    fn likely(&self, witness_is_brighter: bool, pixels: u32) -> String {
        let missing = if witness_is_brighter { self.of_reference } else { self.of_witness };
        match missing {
            Some(kind) => kind.to_owned(),
            None if pixels == 1 => String::from("a glint, or a rare bright sample"),
            None if pixels <= STEP * STEP => String::from("glints or an edge"),
            None => String::from("a scale, or light of another kind in all of the tile"),
        }
    }
}

/// Holds a reference against a witness: Welch's test for each tile of all sizes and each channel, at the level that gives all of them
/// together a false alarm in one of a hundred images (Sidak 1967), the sizes among each other likewise.
///
/// A witness that finds some light only by chance may have missed it, so where it is darker that says nothing against the reference.
pub fn hold_against(
    (width, height): (u32, u32),
    reference: &dyn Fn(Tile, usize) -> TileMean,
    series: &Series,
    technique: &str,
    kinds: Kinds,
) -> Witness {
    let witness = &|tile: Tile, channel: usize| TileMean::of_series(series, tile, channel);
    let mut sizes = vec![1];
    while sizes.last().is_some_and(|size| *size < width.max(height)) {
        sizes.push(sizes[sizes.len() - 1].saturating_mul(STEP));
    }
    let spoken_of = sizes.iter().copied().filter(|size| *size <= SPOKEN_OF).max().unwrap_or(1);
    let (mut tests, mut unseen, mut found, mut detectable) = (0, 0, Vec::new(), Vec::new());
    for size in &sizes {
        let own = TileMeans::of(width, height, *size, reference);
        let other = TileMeans::of(width, height, *size, witness);
        let count = 3 * own.tiles.len();
        let level = sidak(sidak(ALPHA, sizes.len()), count);
        tests += count;
        for ((tile, own), other) in own.tiles.iter().zip(&own.means).zip(&other.means) {
            for (own, other) in own.iter().zip(other) {
                // A pixel that no sample has met yet is no black one.
                if *size == 1 && own.is_empty() {
                    continue;
                }
                let (deviations, p) = own.against(other);
                let is_black = own.mean == 0.0 && other.mean == 0.0;
                if *size == spoken_of && !is_black {
                    let noise = own.variance + other.variance + own.blur + other.blur;
                    detectable.push(DETECTED * noise.sqrt() / own.mean.abs().max(RELATIVE_FLOOR));
                }
                if p < level && deviations < 0.0 && kinds.of_witness.is_some() {
                    unseen += 1;
                } else if p < level {
                    found.push((*tile, own.mean, other.mean, deviations));
                }
            }
        }
    }
    found.sort_by(|a, b| b.3.abs().total_cmp(&a.3.abs()));
    // A tile is not named where the difference is one of a smaller tile within.
    let all = found.clone();
    found.retain(|(tile, .., deviations)| {
        let has_more =
            |other: Tile, own: f64| own / deviations > MORE_THAN_ITS_SHARE * (other.area() / tile.area()).sqrt();
        !all.iter().any(|(other, .., own)| other.is_within(*tile) && has_more(*other, *own))
    });
    let mut named: Vec<(Tile, f64, f64, f64)> = Vec::new();
    for candidate in found {
        if named.len() < NAMED && !named.iter().any(|(tile, ..)| tile.overlaps(candidate.0)) {
            named.push(candidate);
        }
    }
    detectable.sort_by(f64::total_cmp);
    let differences = named.into_iter().map(|(Tile { x, y, width, height }, reference, witness, deviations)| {
        let likely = kinds.likely(deviations > 0.0, width * height);
        Difference { x, y, width, height, reference, witness, deviations, likely }
    });
    Witness {
        technique: technique.to_owned(),
        spp: series.spp(),
        seconds: series.seconds,
        by_chance: kinds.of_witness.map(str::to_owned),
        unseen,
        tests: tests as u64,
        // Of nothing but black nobody has seen anything.
        detectable: detectable.get(detectable.len() / 2).copied().unwrap_or(1.0),
        differences: differences.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::statistics::random::Normal;

    /// Images of 32 x 32 pixels with the mean 1 and the noise that `value` draws.
    fn series(random: &mut Normal, images: usize, value: impl Fn(&mut Normal) -> f64) -> Series {
        let mut series = Series::new(32, 32, images, false);
        for index in 0..images {
            let pixels = (0..32 * 32).map(|_| [0; 3].map(|_| value(random) as f32)).collect();
            series.add(index, &Image { width: 32, height: 32, pixels }, 1.0);
        }
        series
    }

    fn look(a: &Series, b: &Series) -> Witness {
        let own = |tile: Tile, channel: usize| TileMean::of_series(a, tile, channel);
        hold_against((32, 32), &own, b, "witness", Kinds::default())
    }

    /// In 60 pairs of the same expectation, false alarms are as rare as the level says: with normal noise, and with samples of which one in
    /// 2000 is 300 times as bright.
    #[test]
    fn false_alarms_are_rare() {
        let normal = |random: &mut Normal| 1.0 + 0.3 * random.next();
        let rare = |random: &mut Normal| {
            if random.uniform() < 5e-4 { 300.0 } else { 1.0 + 0.1 * random.next() }
        };
        let noises: [&dyn Fn(&mut Normal) -> f64; 2] = [&normal, &rare];
        for (name, noise) in ["normal", "rare"].into_iter().zip(noises) {
            let mut random = Normal::new(17);
            let alarms = (0..60)
                .filter(|_| {
                    let (a, b) = (series(&mut random, 16, noise), series(&mut random, 16, noise));
                    !look(&a, &b).differences.is_empty()
                })
                .count();
            println!("{name}: {alarms} false alarms in 60");
            // 0.6 are expected; more than 4 come by chance less than once in a thousand times.
            assert!(alarms <= 4, "{name}: {alarms}");
        }
    }

    #[test]
    fn differences_of_all_sizes_are_found_where_they_are() {
        let mut random = Normal::new(5);
        let a = series(&mut random, 16, |random| 1.0 + 0.1 * random.next());
        for (size, by) in [(1, 0.4), (4, 0.08), (16, 0.02), (32, 0.01)] {
            let mut b = series(&mut random, 16, |random| 1.0 + 0.1 * random.next());
            for image in &mut b.images {
                for y in 0..size {
                    for x in 0..size {
                        image[y * 32 + x][1] += by;
                    }
                }
            }
            let found = look(&a, &b);
            let first = found.differences.first().expect("a difference");
            assert!(first.deviations > 0.0 && first.x == 0, "{size}: {}", first.describe());
            assert_eq!(first.likely.contains("glint"), size <= 4, "{size}: {}", first.describe());
        }
    }
}
