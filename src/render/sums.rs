//! The sums of a film as the device keeps them, on the host: what a checkpoint holds, and what shards add up.

use serde::{Deserialize, Serialize};

use super::blocks::{self, Number, PLANES};
use super::counted::Counted;
use super::film::{Film, StrategyLayers};
use super::memory::LAYER_PIXEL_BYTES;
use crate::error::Result;
use crate::layout::FilmPixel;
use crate::techniques::{Correlated, Sampler, Settings, StateStream, Store, Strategies};

/// No film has as many layers.
const MOST_LAYERS: u32 = 256;

/// What must be known of a film to read its sums.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FilmShape {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Layers by path length or strategy.
    pub layers: u32,
    /// The strategies, where the layers are by strategy.
    pub strategies: Option<[u32; 2]>,
    /// Exponents of the units of sums and of squares over blocks.
    units: [i32; 2],
    /// Whether the samples of a pixel are two independent halves.
    has_halves: bool,
    /// Whether the pixels of one sample are correlated.
    pixels_are_correlated: bool,
    /// Whether the samples of one pixel are correlated: chains, which a shard has to itself.
    pub samples_are_correlated: bool,
}

impl FilmShape {
    pub(super) fn of(settings: &Settings, splat_unit: f32) -> Self {
        let correlated = settings.technique.row.correlated;
        Self {
            width: settings.width,
            height: settings.height,
            layers: settings.layers(),
            strategies: settings.strategies.map(|all| [all.longest, u32::from(all.lens)]),
            units: blocks::units(splat_unit),
            has_halves: settings.sampler == Sampler::Sobol,
            pixels_are_correlated: correlated != Correlated::Nothing,
            samples_are_correlated: correlated == Correlated::Samples,
        }
    }

    /// Whether there can be such a film.
    pub(super) fn is_possible(&self) -> bool {
        let sides = [self.width, self.height];
        sides.iter().all(|side| (1..=65536).contains(side)) && self.layers <= MOST_LAYERS
    }

    fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Bytes of the film and of its layers on the device, then of each plane over blocks. A buffer of nothing takes four bytes.
    pub(super) fn bytes(&self) -> Vec<u64> {
        let layers = self.pixels() * u64::from(self.layers) * LAYER_PIXEL_BYTES;
        let film = self.pixels() * size_of::<FilmPixel>() as u64;
        let planes = blocks::planes(self.layers);
        [film, layers.max(4)].into_iter().chain(vec![blocks::plane_bytes(self.pixels()); planes]).collect()
    }
}

/// Saves the film with what was counted to a stream, or restores it. Whole numbers take part where there are `any`.
pub(super) fn exchange(
    stream: &mut StateStream,
    [film, layers]: [&dyn Store; 2],
    blocks: &[&dyn Store],
    any: &mut bool,
    counted: &mut Counted,
) -> Result<()> {
    stream.buffer(film)?;
    stream.buffer(layers)?;
    let had = std::mem::take(any);
    let mut has = u32::from(had);
    stream.numbers([&mut has])?;
    *any = has > 0;
    for plane in blocks {
        match (*any, stream.restores() && had) {
            (true, _) => stream.buffer(*plane)?,
            (false, true) => plane.clear()?,
            (false, false) => {}
        }
    }
    counted.exchange(stream)
}

/// The sums of each pixel.
#[derive(Clone, Debug)]
pub(super) struct FilmSums {
    /// Over the samples after the last whole block.
    pub pixels: Vec<FilmPixel>,
    /// Of each layer over the same: the sum, then its low part.
    pub layers: Vec<[f32; 3]>,
    /// Over whole blocks, plane by plane, three of each pixel; empty where there is none.
    pub blocks: Vec<Number>,
}

impl FilmSums {
    /// The film, of pixels that have so many samples.
    pub fn film(&self, shape: &FilmShape, counts: Vec<u64>) -> Film {
        let layers = shape.layers as usize;
        // A block's sums, in whole numbers, and those that are under way, in floats.
        let count = self.pixels.len();
        let total = |pixel: usize, plane: usize, unit: i32, high: [f32; 3], low: [f32; 3]| -> [f64; 3] {
            std::array::from_fn(|channel| {
                let open = f64::from(high[channel]) + f64::from(low[channel]);
                let number = self.blocks.get(3 * (plane * count + pixel) + channel);
                number.map_or(open, |number| blocks::value(*number, unit) + open)
            })
        };
        let [unit, square] = shape.units;
        let pixels = || self.pixels.iter().enumerate();
        let layer = |layer: usize| {
            let sums = self.layers.chunks_exact(2 * layers).enumerate();
            sums.map(|(pixel, own)| total(pixel, PLANES + layer, unit, own[2 * layer], own[2 * layer + 1])).collect()
        };
        let mut film = Film {
            width: shape.width,
            height: shape.height,
            counts,
            sums: pixels().map(|(index, own)| total(index, 0, unit, own.sum, own.sum_low)).collect(),
            squares: pixels().map(|(index, own)| total(index, 1, square, own.squares, own.squares_low)).collect(),
            lengths: (0..layers).map(layer).collect(),
            ..Film::default()
        };
        if shape.has_halves {
            film.set_differences(
                pixels().map(|(index, own)| total(index, 2, unit, own.difference, [0.0; 3])).collect(),
            );
        }
        if shape.pixels_are_correlated {
            film.pixels_are_correlated();
        }
        if let Some([longest, lens]) = shape.strategies {
            let mut layers = std::mem::take(&mut film.lengths).into_iter();
            for strategy in (Strategies { longest, lens: lens > 0 }).all() {
                let mut next = || layers.next().unwrap_or_default();
                film.strategies.push(StrategyLayers { strategy, unweighted: next(), weighted: next() });
            }
        }
        film
    }

    /// Adds the sums of samples that follow on these, which must end with a whole block.
    pub fn append(&mut self, next: &Self) {
        if self.blocks.is_empty() {
            self.blocks.clone_from(&next.blocks);
        } else {
            self.blocks.iter_mut().zip(&next.blocks).for_each(|(own, other)| *own = blocks::sum(*own, *other));
        }
        self.pixels.clone_from(&next.pixels);
        self.layers.clone_from(&next.layers);
    }
}
