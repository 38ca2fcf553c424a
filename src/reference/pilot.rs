//! Every technique that may make a reference, for a moment each: how noisy it is, and what it lacks.

use serde::{Deserialize, Serialize};

use super::candidates::Candidate;
use super::certificate::Pilot;
use super::series::Series;
use super::tails::blur;
use super::tiles::{Tile, TileMean};
use crate::image::Image;
use crate::image::metrics::RELATIVE_FLOOR;
use crate::image::metrics::pixels::worst_share;

/// Tiles by which parts of the image are told apart.
pub(super) const TILE: u32 = 8;
/// Deviations beyond which a technique that finds some light by chance is taken to have missed it.
const MISSED: f64 = 3.0;
/// Deviations beyond which it is not to be relied upon in a tile.
const SUSPECTED: f64 = 1.0;
/// Blur of a long rendering falls with the number of samples like radius^4, samples^(2 (alpha - 1)) with the default alpha.
const BLUR_FALLS: f64 = -2.0 / 3.0;
/// Deviations that the blur of a technique is given beyond its estimate: enough not to take it for nothing.
const PILOT_DOUBT: f64 = 0.5;
/// The share of the image's mean noise that each tile gets besides its own: a tile may have shown too little of it.
const SHARED: f64 = 0.2;

/// A technique as it was tried.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Tried {
    /// What is said of it.
    pub pilot: Pilot,
    /// Whether its image is blurred.
    pub is_consistent: bool,
    /// Seconds that one sample of all pixels takes.
    pub seconds_per_sample: f64,
    /// relMSE x seconds of its noise in each tile.
    pub tiles: Vec<f64>,
    /// relMSE of the light that it was seen to lack in each tile or beside it.
    pub lacks: Vec<f64>,
}

impl Tried {
    /// The relMSE that it is expected to have after so many seconds.
    pub fn expected(&self, seconds: f64) -> f64 {
        self.pilot.noise / seconds + self.lacking(seconds)
    }

    /// The relMSE that it is expected to have in one tile after so many seconds.
    pub fn expected_in(&self, tile: usize, seconds: f64) -> f64 {
        let lacking = if self.is_consistent { self.lacking(seconds) } else { self.lacks[tile] };
        self.tiles[tile] / seconds.max(f64::MIN_POSITIVE) + lacking
    }

    fn lacking(&self, seconds: f64) -> f64 {
        let falls = if self.is_consistent { (seconds / self.pilot.seconds).max(1.0).powf(BLUR_FALLS) } else { 1.0 };
        self.pilot.lacking * falls
    }
}

/// Sums up what was tried. Errors of all are relative to one image, the median of theirs.
pub(super) fn judge(candidates: &[(Candidate, Series, f64)]) -> Vec<Tried> {
    let means: Vec<Image> = candidates.iter().map(|(_, series, _)| series.mean()).collect();
    let Some(first) = means.first() else { return Vec::new() };
    let median = |pixel: usize, channel: usize| {
        let mut values: Vec<f32> = means.iter().map(|image| image.pixels[pixel][channel]).collect();
        values.sort_by(f32::total_cmp);
        values[values.len() / 2]
    };
    let base: Vec<[f32; 3]> =
        (0..first.pixels.len()).map(|pixel| std::array::from_fn(|channel| median(pixel, channel))).collect();
    let scale = |pixel: usize, channel: usize| 1.0 / (f64::from(base[pixel][channel]).powi(2) + RELATIVE_FLOOR) / 3.0;
    let size = (first.width, first.height);
    let tiles: Vec<Tile> = Tile::all(first.width, first.height, TILE).collect();
    let mut all: Vec<Tried> = candidates
        .iter()
        .map(|(candidate, series, seconds_per_sample)| {
            let variance = series.variance();
            let of_tile = |tile: &Tile| {
                let pixels = tile.pixels(first.width);
                let noise =
                    |pixel: usize| (0..3).map(|c| f64::from(variance.pixels[pixel][c]) * scale(pixel, c)).sum::<f64>();
                pixels.map(noise).sum::<f64>() / f64::from(tile.width * tile.height) * series.seconds
            };
            let tiles: Vec<f64> = tiles.iter().map(of_tile).collect();
            let noise = typical_noise(&variance, &scale) * series.seconds;
            Tried {
                pilot: Pilot {
                    technique: candidate.technique.describe(),
                    seconds: series.seconds,
                    noise,
                    lacking: if candidate.is_consistent { blur(series, PILOT_DOUBT) } else { 0.0 },
                    by_chance: candidate.by_chance.clone(),
                },
                is_consistent: candidate.is_consistent,
                seconds_per_sample: *seconds_per_sample,
                lacks: vec![0.0; tiles.len()],
                tiles: tiles.iter().map(|own| (1.0 - SHARED) * own + SHARED * noise).collect(),
            }
        })
        .collect();
    // The least noisy one that aims at all light shows what others have missed.
    let finder = (0..all.len())
        .filter(|index| all[*index].pilot.by_chance.is_none())
        .min_by(|a, b| all[*a].expected(1.0).total_cmp(&all[*b].expected(1.0)));
    let Some(finder) = finder else { return all };
    for index in 0..all.len() {
        if all[index].pilot.by_chance.is_some() {
            let lacking = |deviations| missed(&candidates[index].1, &candidates[finder].1, &size, deviations);
            let sure = lacking(MISSED);
            all[index].pilot.lacking = sure.iter().sum::<f64>() / sure.len().max(1) as f64;
            all[index].lacks = beside(&lacking(SUSPECTED), first.width.div_ceil(TILE) as usize);
        }
    }
    all
}

/// The mean noise of the pixels without the worst thousandth: whether a moment shows a rare bright sample is luck, and would decide.
fn typical_noise(variance: &Image, scale: &dyn Fn(usize, usize) -> f64) -> f64 {
    let of_pixel = |(index, pixel): (usize, &[f32; 3])| -> f64 {
        pixel.iter().enumerate().map(|(channel, value)| f64::from(*value) * scale(index, channel)).sum()
    };
    let mut noise: Vec<f64> = variance.pixels.iter().enumerate().map(of_pixel).collect();
    let sum: f64 = noise.iter().sum();
    let share = worst_share(&mut noise);
    sum * (1.0 - share) / noise.len().max(1) as f64
}

/// relMSE of the light that one series has and another one lacks, in each tile where they differ by so many deviations.
fn missed(series: &Series, finder: &Series, size: &(u32, u32), least: f64) -> Vec<f64> {
    let lacking = |tile: Tile| -> f64 {
        let channel = |channel: usize| {
            let own = TileMean::of_series(series, tile, channel);
            let other = TileMean::of_series(finder, tile, channel);
            let (deviations, _) = own.against(&other);
            let difference = other.mean - own.mean;
            if deviations > least { difference.powi(2) / (other.mean.powi(2) + RELATIVE_FLOOR) / 3.0 } else { 0.0 }
        };
        (0..3).map(channel).sum()
    };
    Tile::all(size.0, size.1, TILE).map(lacking).collect()
}

/// The largest value of each tile and its eight neighbours, in rows of so many.
fn beside(tiles: &[f64], across: usize) -> Vec<f64> {
    let down = tiles.len() / across.max(1);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let largest = |index: usize| {
        let (x, y) = (index % across, index / across);
        let all = near(y, down).flat_map(|y| near(x, across).map(move |x| tiles[y * across + x]));
        all.fold(0.0, f64::max)
    };
    (0..tiles.len()).map(largest).collect()
}
