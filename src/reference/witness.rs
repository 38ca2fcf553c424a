//! An independent run of another technique that looks at a reference tile by tile.

use super::certificate::{Difference, Witness};
use super::series::Series;
use super::tiles::{Tile, TileMean, TileMeans};
use crate::metrics::RELATIVE_FLOOR;
use crate::metrics::stats::sidak;

/// Probability of a false alarm in all of the image.
const ALPHA: f64 = 0.01;
/// Each size of tile is this many times the one before it, beginning with one pixel.
const STEP: u32 = 4;
/// The most places that are named.
const NAMED: usize = 12;
/// Deviations that a difference in one of many tiles has when it is seen.
const DETECTED: f64 = 4.5;
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
    let (mut tests, mut unseen, mut found, mut detectable) = (0, 0, Vec::new(), Vec::new());
    for size in &sizes {
        let count = 3 * Tile::all(width, height, *size).count();
        let level = sidak(sidak(ALPHA, sizes.len()), count);
        tests += count;
        let own = TileMeans::of(width, height, *size, reference);
        let other = TileMeans::of(width, height, *size, witness);
        for ((tile, own), other) in own.tiles.iter().zip(&own.means).zip(&other.means) {
            for (own, other) in own.iter().zip(other) {
                let (deviations, p) = own.against(other);
                if *size == SPOKEN_OF {
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
        detectable: detectable.get(detectable.len() / 2).copied().unwrap_or(0.0),
        differences: differences.collect(),
    }
}
