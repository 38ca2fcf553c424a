//! The film on the host: sums per pixel, and what follows from them.

use crate::image::Image;
use crate::image::metrics::RELATIVE_FLOOR;
use crate::image::metrics::pixels::{HEAVY_TAIL, worst_share};
use crate::layout::FilmPixel;
use crate::statistics::Estimate;
use crate::techniques::Strategy;

/// Sums of the samples of each pixel, row by row from the upper left.
#[derive(Clone, Debug, Default)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples of each pixel. They differ by the last pass only, where that was cut short.
    pub counts: Vec<u64>,
    /// Sum of the samples.
    pub sums: Vec<[f64; 3]>,
    /// Sum of their squares.
    pub squares: Vec<[f64; 3]>,
    /// Sums by path length (index 0: one segment), where they were asked for.
    pub lengths: Vec<Vec<[f64; 3]>>,
    /// Sums by strategy, where they were asked for.
    pub strategies: Vec<StrategyLayers>,
    /// What all of it is scaled by, the mean over the image of the target of Markov chains, where the technique has some. Then its samples
    /// are correlated, and their variance does not tell the error.
    pub brightness: Option<Estimate>,
    /// Samples that were not finite and were dropped.
    pub nonfinite: u64,
    /// Where the first of them were.
    pub bad_samples: Vec<BadSample>,
}

/// The contribution of one strategy of bidirectional path tracing.
#[derive(Clone, Debug)]
pub struct StrategyLayers {
    /// The strategy.
    pub strategy: Strategy,
    /// Sums of its estimates by itself, with weight 1.
    pub unweighted: Vec<[f64; 3]>,
    /// Sums of its share of the image.
    pub weighted: Vec<[f64; 3]>,
}

/// A sample that was not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct BadSample {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Sample index within the pixel.
    pub sample: u32,
}

/// What the samples of a film say of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// relMSE.
    pub relmse: f64,
    /// Share of it that the worst thousandth of the pixels makes.
    pub worst_share: f64,
}

impl ErrorEstimate {
    /// Whether the error is at least that, and nobody knows by how much more: a few bright samples make most of it, and the next ones are
    /// still missing.
    pub fn is_at_least(&self) -> bool {
        self.worst_share > HEAVY_TAIL
    }
}

impl Film {
    /// Takes over the sums that the device kept as a float and its low part.
    pub(crate) fn from_device(
        width: u32,
        height: u32,
        counts: Vec<u64>,
        pixels: &[FilmPixel],
        layers: &[[f32; 3]],
        layer_count: usize,
    ) -> Self {
        let pair = |high: [f32; 3], low: [f32; 3]| {
            std::array::from_fn(|channel| f64::from(high[channel]) + f64::from(low[channel]))
        };
        let lengths = (0..layer_count)
            .map(|layer| {
                layers.chunks_exact(2 * layer_count).map(|pixel| pair(pixel[2 * layer], pixel[2 * layer + 1])).collect()
            })
            .collect();
        Self {
            width,
            height,
            counts,
            sums: pixels.iter().map(|pixel| pair(pixel.sum, pixel.sum_low)).collect(),
            squares: pixels.iter().map(|pixel| pair(pixel.squares, pixel.squares_low)).collect(),
            lengths,
            strategies: Vec::new(),
            brightness: None,
            nonfinite: 0,
            bad_samples: Vec::new(),
        }
    }

    /// Multiplies all samples.
    pub(crate) fn scale(&mut self, factor: f64) {
        if factor == 1.0 {
            return;
        }
        let layers = self.lengths.iter_mut().flatten();
        let strategies = self.strategies.iter_mut();
        let strategies = strategies.flat_map(|layers| layers.unweighted.iter_mut().chain(&mut layers.weighted));
        self.sums.iter_mut().chain(layers).chain(strategies).flatten().for_each(|sum| *sum *= factor);
        self.squares.iter_mut().flatten().for_each(|square| *square *= factor * factor);
    }

    fn per_pixel(&self, value: impl Fn(usize) -> [f64; 3]) -> Image {
        let pixels = (0..self.counts.len()).map(|pixel| value(pixel).map(|channel| channel as f32)).collect();
        Image { width: self.width, height: self.height, pixels }
    }

    /// The image. With layers by path length it is their sum, rounded once, so that adding the layers up gives exactly it.
    pub fn mean(&self) -> Image {
        if self.lengths.is_empty() {
            return self.image_of(&self.sums);
        }
        let layers: Vec<Image> = (0..self.lengths.len()).map(|layer| self.length(layer)).collect();
        self.per_pixel(|pixel| {
            std::array::from_fn(|channel| layers.iter().map(|layer| f64::from(layer.pixels[pixel][channel])).sum())
        })
    }

    /// The contribution of paths of `layer + 1` segments; the last layer holds all longer ones too.
    pub fn length(&self, layer: usize) -> Image {
        self.image_of(&self.lengths[layer])
    }

    /// The image of sums over the samples of each pixel.
    pub fn image_of(&self, sums: &[[f64; 3]]) -> Image {
        self.per_pixel(|pixel| sums[pixel].map(|sum| sum / self.counts[pixel].max(1) as f64))
    }

    /// The unbiased estimate of the variance of one sample, per pixel and channel; 0 below two samples.
    pub fn sample_variance(&self) -> Image {
        self.per_pixel(|pixel| self.variance_of_sample(pixel))
    }

    /// The unbiased estimate of the variance of one sample of a pixel, per channel; 0 below two samples.
    pub(crate) fn variance_of_sample(&self, pixel: usize) -> [f64; 3] {
        let n = self.counts[pixel] as f64;
        std::array::from_fn(|channel| {
            let (sum, squares) = (self.sums[pixel][channel], self.squares[pixel][channel]);
            if n < 2.0 { 0.0 } else { ((squares - sum * sum / n) / (n - 1.0)).max(0.0) }
        })
    }

    /// The variance of each pixel's mean: that of one sample over their number.
    pub fn mean_variance(&self) -> Image {
        let variance = self.sample_variance();
        self.per_pixel(|pixel| {
            variance.pixels[pixel].map(|channel| f64::from(channel) / self.counts[pixel].max(1) as f64)
        })
    }

    /// The relMSE that the variance of the samples lets expect: the mean over pixels and channels of the mean's variance over
    /// (mean² + 0.01). Nothing below two samples, where the variance is unknown, and where samples are correlated. A pixel's mean is large
    /// where its variance is, by the same bright samples, so the estimate is low by a share that falls with the number of samples: in the
    /// Cornell box 26 % at 16, 3 % at 128. (Means of neighbours in its place were 13 % low, medians and means of similar neighbours 55 %
    /// high.)
    pub fn error_estimate(&self) -> Option<ErrorEstimate> {
        if self.spp() < 2 || self.brightness.is_some() {
            return None;
        }
        let (mean, variance) = (self.mean(), self.mean_variance());
        let pixel = |(mean, variance): (&[f32; 3], &[f32; 3])| {
            let channels = mean.iter().zip(variance);
            channels.map(|(m, v)| f64::from(*v) / (f64::from(*m).powi(2) + RELATIVE_FLOOR)).sum::<f64>() / 3.0
        };
        let mut errors: Vec<f64> = mean.pixels.iter().zip(&variance.pixels).map(pixel).collect();
        let sum: f64 = errors.iter().sum();
        let worst_share = worst_share(&mut errors);
        Some(ErrorEstimate { relmse: sum / errors.len().max(1) as f64, worst_share })
    }

    /// The fewest samples that any pixel has.
    pub fn spp(&self) -> u64 {
        self.counts.iter().copied().min().unwrap_or(0)
    }

    /// The average over all pixels, per channel.
    pub fn average(&self) -> [f64; 3] {
        self.mean().average()
    }
}
