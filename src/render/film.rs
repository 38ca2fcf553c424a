//! The film on the host: sums per pixel, and what follows from them.

use crate::image::Image;
use crate::image::metrics::RELATIVE_FLOOR;
use crate::image::metrics::pixels::{HEAVY_TAIL, worst_share};
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
    /// Where the sampler spreads samples evenly: what it leaves of the error, and how that is known.
    pub halves: Option<Halves>,
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

/// The two independent halves of the samples of each pixel: those of even and of odd index. Samples of a half depend on each other, as they are
/// spread evenly, so their own variance says too much of the error; the halves' difference does not.
#[derive(Clone, Debug, Default)]
pub struct Halves {
    /// Sum of the samples of even index less that of the others, per pixel.
    pub differences: Vec<[f64; 3]>,
    /// Variance of a pixel's mean over that of as many independent samples, per tile of [`TILE`] x [`TILE`] pixels, row by row.
    ratios: Vec<f64>,
    /// How many independent pixels the whole image has for telling its error.
    pixels: f64,
}

/// What the pixels of a tile say of its variance.
#[derive(Clone, Copy, Debug, Default)]
struct TileVariance {
    /// Sum of the pixels' variances by their own samples.
    independent: f64,
    /// Sum of the squares of those.
    squares: f64,
    /// Sum of the pixels' variances by their halves.
    halves: f64,
    /// Sum of the differences of the halves, with their sign, each over the deviation that its samples state.
    errors: f64,
    /// Sum of the squares of those.
    error_squares: f64,
}

impl TileVariance {
    fn add(&mut self, independent: f64, halves: f64, error: f64) {
        // Samples whose squares are beyond single precision have no variance.
        if !(independent > 0.0 && independent.is_finite() && halves.is_finite()) {
            return;
        }
        self.independent += independent;
        self.squares += independent * independent;
        self.halves += halves;
        self.errors += error / independent.sqrt();
        self.error_squares += error * error / independent;
    }

    /// How many independent pixels it is that tell the ratio: fewer than there are where a few make most of the variance, and where all are
    /// off to the same side, because they share light subpaths.
    fn pixels(&self) -> f64 {
        if self.independent == 0.0 {
            return 0.0;
        }
        // Were the pixels independent, this would be the square of a normal number.
        let together = self.errors * self.errors / self.error_squares.max(f64::MIN_POSITIVE);
        self.independent * self.independent / self.squares / if together > 9.0 { together } else { 1.0 }
    }

    /// Variance of a pixel's mean over that of as many independent samples, averaged with 1 by the number of independent pixels.
    fn ratio(&self) -> f64 {
        if self.independent == 0.0 {
            return 1.0;
        }
        (self.pixels() * self.halves / self.independent + INDEPENDENT_PIXELS) / (self.pixels() + INDEPENDENT_PIXELS)
    }
}

/// Width and height in pixels of the tiles over which the ratio of variances is estimated.
const TILE: u32 = 16;

/// Few independent pixels cannot tell the ratio of a tile: it is averaged with 1, which has the weight of so many pixels.
const INDEPENDENT_PIXELS: f64 = 8.0;

/// Fewer independent pixels than that cannot tell the error of an image by their halves alone: it would be off by more than 9 %.
const PIXELS_OF_IMAGE: f64 = 256.0;

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
    /// Takes the samples' halves over, and estimates tile by tile what the sampler leaves of the variance.
    pub(super) fn set_differences(&mut self, differences: Vec<[f64; 3]>) {
        let tiles = |side: u32| side.div_ceil(TILE);
        let mut whole = TileVariance::default();
        let mut sums = vec![TileVariance::default(); tiles(self.width) as usize * tiles(self.height) as usize];
        for (pixel, difference) in differences.iter().enumerate() {
            let independent = self.variance_of_sample(pixel).iter().sum::<f64>() / self.counts[pixel].max(1) as f64;
            let halves = self.variance_by_halves(pixel, difference).iter().sum::<f64>();
            let error = difference.iter().sum::<f64>().signum() * halves.sqrt();
            sums[self.tile(pixel)].add(independent, halves, error);
            // What counts of a pixel in the relMSE.
            let n = self.counts[pixel].max(1) as f64;
            let weight = 1.0 / ((self.sums[pixel].iter().sum::<f64>() / (3.0 * n)).powi(2) + RELATIVE_FLOOR);
            whole.add(weight * independent, weight * halves, weight.sqrt() * error);
        }
        let ratios = sums.iter().map(TileVariance::ratio).collect();
        self.halves = Some(Halves { differences, ratios, pixels: whole.pixels() });
    }

    /// Takes it that the pixels of a sample share light subpaths: how few of them are independent cannot be seen from one image, so the error of
    /// the image is told by the variance of each pixel, [`Self::variance_of_mean`].
    pub(crate) fn pixels_are_correlated(&mut self) {
        if let Some(halves) = &mut self.halves {
            halves.pixels = 0.0;
        }
    }

    /// The tile that a pixel lies in.
    fn tile(&self, pixel: usize) -> usize {
        let (width, tile) = (self.width as usize, TILE as usize);
        pixel / width / tile * width.div_ceil(tile) + pixel % width / tile
    }

    /// The variance of a pixel's mean by its two halves alone, per channel: unbiased, with one degree of freedom.
    fn variance_by_halves(&self, pixel: usize, difference: &[f64; 3]) -> [f64; 3] {
        let n = self.counts[pixel] as f64;
        if n < 2.0 {
            return [0.0; 3];
        }
        // Of an odd number, one half has one sample more.
        let excess = n % 2.0;
        std::array::from_fn(|channel| {
            let difference = difference[channel] - excess * self.sums[pixel][channel] / n;
            difference * difference / (n * n - excess)
        })
    }

    /// Adds the samples of another film of the same shape that is independent of this one: of chains of their own, each scaled by its own estimate
    /// of the brightness.
    pub fn add(&mut self, other: &Self) {
        let [own, its] = [&*self, other].map(|film| film.spp() as f64);
        let add = |sums: &mut Vec<[f64; 3]>, others: &[[f64; 3]]| {
            sums.iter_mut().flatten().zip(others.iter().flatten()).for_each(|(sum, other)| *sum += other);
        };
        add(&mut self.sums, &other.sums);
        add(&mut self.squares, &other.squares);
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, other)| *count += other);
        self.lengths.iter_mut().zip(&other.lengths).for_each(|(sums, others)| add(sums, others));
        for (layers, others) in self.strategies.iter_mut().zip(&other.strategies) {
            add(&mut layers.unweighted, &others.unweighted);
            add(&mut layers.weighted, &others.weighted);
        }
        self.brightness = self.brightness.zip(other.brightness).map(|(a, b)| Estimate {
            mean: (own * a.mean + its * b.mean) / (own + its),
            variance: (own * own * a.variance + its * its * b.variance) / (own + its).powi(2),
        });
        self.halves = None;
        self.nonfinite += other.nonfinite;
        self.bad_samples.extend_from_slice(&other.bad_samples);
    }

    /// The same, multiplied by the factor of a checkpoint's `scale`, where it has one.
    pub fn scaled(mut self, scale: Option<[f64; 3]>) -> Self {
        if let Some([factor, mean, variance]) = scale {
            self.brightness = Some(Estimate { mean, variance });
            self.scale(factor);
        }
        self
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
        let differences = self.halves.iter_mut().flat_map(|halves| &mut halves.differences);
        differences.flatten().for_each(|difference| *difference *= factor);
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

    /// The unbiased estimate of the variance of one sample of a pixel by itself, per channel; 0 below two samples.
    fn variance_of_sample(&self, pixel: usize) -> [f64; 3] {
        let n = self.counts[pixel] as f64;
        std::array::from_fn(|channel| {
            let (sum, squares) = (self.sums[pixel][channel], self.squares[pixel][channel]);
            if n < 2.0 { 0.0 } else { ((squares - sum * sum / n) / (n - 1.0)).max(0.0) }
        })
    }

    /// The variance of a pixel's mean, per channel; 0 below two samples. That of independent samples is theirs over their number. Where the
    /// sampler spreads them evenly, that is multiplied by what their halves say of it in the pixel's surroundings, or by somewhat more:
    /// the halves of one pixel alone would tell with one degree of freedom.
    pub fn variance_of_mean(&self, pixel: usize) -> [f64; 3] {
        let ratio = self.halves.as_ref().map_or(1.0, |halves| halves.ratios[self.tile(pixel)]);
        let n = self.counts[pixel].max(1) as f64;
        self.variance_of_sample(pixel).map(|variance| ratio * variance / n)
    }

    /// The variance of each pixel's mean: [`Self::variance_of_mean`] as an image.
    pub fn mean_variance(&self) -> Image {
        self.per_pixel(|pixel| self.variance_of_mean(pixel))
    }

    /// The relMSE that the variance of the samples, or of their halves, lets expect: the mean over pixels and channels of the mean's variance
    /// over (mean² + 0.01). Nothing below two samples, where the variance is unknown, and where samples are correlated. A pixel's mean is large
    /// where its variance is, by the same bright samples, so the estimate is low by a share that falls with the number of samples: in the
    /// Cornell box 26 % at 16, 3 % at 128. (Means of neighbours in its place were 13 % low, medians and means of similar neighbours 55 %
    /// high.)
    pub fn error_estimate(&self) -> Option<ErrorEstimate> {
        if self.spp() < 2 || self.brightness.is_some() {
            return None;
        }
        let variance = |pixel| match &self.halves {
            Some(halves) if halves.pixels >= PIXELS_OF_IMAGE => {
                self.variance_by_halves(pixel, &halves.differences[pixel])
            }
            _ => self.variance_of_mean(pixel),
        };
        let error = |(pixel, mean): (usize, &[f32; 3])| {
            let channels = mean.iter().zip(variance(pixel));
            channels.map(|(m, v)| v / (f64::from(*m).powi(2) + RELATIVE_FLOOR)).sum::<f64>() / 3.0
        };
        let mut errors: Vec<f64> = self.mean().pixels.iter().enumerate().map(error).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Normal;

    /// A film of as many samples in each pixel, given one after the other.
    fn film(side: u32, spp: u64, mut sample: impl FnMut(usize, u64) -> f64) -> Film {
        let pixels: Vec<Vec<f64>> =
            (0..(side * side) as usize).map(|pixel| (0..spp).map(|index| sample(pixel, index)).collect()).collect();
        let sums = |value: &dyn Fn(&[f64]) -> f64| pixels.iter().map(|pixel| [value(pixel); 3]).collect::<Vec<_>>();
        let mut film = Film {
            width: side,
            height: side,
            counts: vec![spp; pixels.len()],
            sums: sums(&|all| all.iter().sum()),
            squares: sums(&|all| all.iter().map(|x| x * x).sum()),
            ..Film::default()
        };
        film.set_differences(sums(&|all| all.iter().zip([1.0, -1.0].iter().cycle()).map(|(x, sign)| x * sign).sum()));
        film
    }

    fn mean_variance(film: &Film) -> f64 {
        film.mean_variance().average()[0]
    }

    /// Independent numbers: the halves say what the samples say, of even and of odd numbers of samples.
    #[test]
    fn halves_of_independent_samples_tell_their_variance() {
        let mut random = Normal::new(3);
        for spp in [2, 3, 8, 9] {
            let film = film(128, spp, |_, _| 5.0 + random.uniform());
            let expected = 1.0 / 12.0 / spp as f64;
            let found = mean_variance(&film) / expected;
            assert!((found - 1.0).abs() < 0.03, "{spp} samples: {found}");
            let halves = film.error_estimate().unwrap().relmse * (5.5f64.powi(2) + RELATIVE_FLOOR) / expected;
            assert!((halves - 1.0).abs() < 0.05, "{spp} samples, by the halves alone: {halves}");
        }
    }

    /// Each half is one jittered stratum per sample: their mean has 1 / m^2 of the variance of m independent ones.
    #[test]
    fn halves_of_spread_samples_tell_what_is_left() {
        const SPP: u64 = 16;
        let mut random = Normal::new(4);
        let film = film(128, SPP, |_, index| 5.0 + ((index / 2) as f64 + random.uniform()) / (SPP / 2) as f64);
        let left = 1.0 / 12.0 / SPP as f64 / ((SPP / 2) as f64).powi(2);
        let stated = film.error_estimate().unwrap().relmse * (5.5f64.powi(2) + RELATIVE_FLOOR);
        assert!((stated / left - 1.0).abs() < 0.05, "{stated} of {left}");
        // Tiles of 256 pixels, each with the weight of 8 more of independent samples.
        let independent = 1.0 / 12.0 / SPP as f64;
        let expected = (256.0 * left + INDEPENDENT_PIXELS * independent) / (256.0 + INDEPENDENT_PIXELS);
        assert!((mean_variance(&film) / expected - 1.0).abs() < 0.05, "{} of {expected}", mean_variance(&film));
    }

    /// Pixels that are all off to the same side, as those that share light subpaths: one difference of halves cannot tell the error.
    #[test]
    fn halves_of_pixels_that_are_off_together_tell_little() {
        for seed in 0..20 {
            let mut random = Normal::new(seed);
            let shared: Vec<f64> = (0..64).map(|_| random.uniform()).collect();
            let film = film(32, 64, |pixel, index| 5.0 + shared[index as usize] + 0.01 * (pixel % 7) as f64);
            let expected = 1.0 / 12.0 / 64.0 / (5.53f64.powi(2) + RELATIVE_FLOOR);
            let found = film.error_estimate().unwrap().relmse / expected;
            assert!((0.5..1.6).contains(&found), "seed {seed}: {found}");
        }
    }
}
