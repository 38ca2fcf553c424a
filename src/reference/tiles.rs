//! Means of tiles of an image with what is known of their noise, and how far those of two images are apart.

use super::series::{Series, variance_of_mean};
use super::tails::SHIFT_OF_MEAN;
use super::truth::Truth;
use crate::image::Image;
use crate::statistics::student_two_sided;

/// Deviations within which nobody asks how probable they are.
const NEAR: f64 = 2.0;

/// Tiles along each side of a square of neighbours.
const PARENT: u32 = 4;
/// A tile's variance is no less than this, beside the median of its neighbours'.
const LEAST_SHARED: f64 = 0.5;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Left column.
    pub x: u32,
    /// Upper row.
    pub y: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

impl Tile {
    /// All tiles of that size, row by row; those at the right and lower border are smaller.
    pub fn all(width: u32, height: u32, size: u32) -> impl Iterator<Item = Self> {
        Self::stepping(width, height, size, size)
    }

    fn stepping(width: u32, height: u32, size: u32, step: u32) -> impl Iterator<Item = Self> {
        (0..height).step_by(step as usize).flat_map(move |y| {
            let tile = move |x| Self { x, y, width: size.min(width - x), height: size.min(height - y) };
            (0..width).step_by(step as usize).map(tile)
        })
    }

    /// The tiles of a grid, and those between them: shifted by half of their size in either direction.
    pub fn overlapping(width: u32, height: u32, size: u32) -> impl Iterator<Item = Self> {
        let step = if size < width.max(height) { (size / 2).max(1) } else { size };
        let all = Self::stepping(width, height, size, step);
        // What is left of the last ones at the border is a part of those before them.
        all.filter(move |tile| tile.x % size == 0 && tile.y % size == 0 || tile.width == size && tile.height == size)
    }

    /// The indices of its pixels in an image of that width.
    pub fn pixels(self, width: u32) -> impl Iterator<Item = usize> + Clone {
        (self.y..self.y + self.height)
            .flat_map(move |y| (self.x..self.x + self.width).map(move |x| (y * width + x) as usize))
    }

    /// Whether two have a pixel in common.
    pub fn overlaps(self, other: Self) -> bool {
        self.x < other.x + other.width
            && other.x < self.x + self.width
            && self.y < other.y + other.height
            && other.y < self.y + self.height
    }

    /// How many pixels it has.
    pub fn area(self) -> f64 {
        f64::from(self.width) * f64::from(self.height)
    }

    /// Whether it is a part of another one, and smaller.
    pub fn is_within(self, other: Self) -> bool {
        let (right, below) = (self.x + self.width, self.y + self.height);
        let inside =
            self.x >= other.x && self.y >= other.y && right <= other.x + other.width && below <= other.y + other.height;
        inside && self.area() < other.area()
    }

    fn mean(self, pixels: &[[f32; 3]], width: u32, channel: usize) -> f64 {
        let sum: f64 = self.pixels(width).map(|pixel| f64::from(pixels[pixel][channel])).sum();
        sum / self.area()
    }
}

/// The mean of a channel over a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileMean {
    /// The mean.
    pub mean: f64,
    /// Its variance.
    pub variance: f64,
    /// Degrees of freedom of that variance; infinite where it is known.
    pub freedom: f64,
    /// By how much the finer half of a blurred series is off, as far as its coarser half tells, and the variance of that; 0 for others.
    pub shift: (f64, f64),
    /// Variance that stands for the blur of the mean: see [`TileMeans`].
    pub blur: f64,
}

impl TileMean {
    /// Of a series. Its variance is that of its images' means, so that noise which the pixels share counts in full.
    pub fn of_series(series: &Series, tile: Tile, channel: usize) -> Self {
        let means: Vec<(f64, f64)> =
            series.weighted().map(|(weight, image)| (weight, tile.mean(image, series.width, channel))).collect();
        let mean = means.iter().map(|(weight, mean)| weight * mean).sum();
        let freedom = means.len().saturating_sub(1) as f64;
        if !series.is_blurred {
            let variance = variance_of_mean(means.iter().copied());
            return Self { mean, variance, freedom, shift: (0.0, 0.0), blur: 0.0 };
        }
        // Each half by itself, as their means differ; see `tails::blur`.
        let half = |first: usize| {
            let own: Vec<(f64, f64)> = means.iter().skip(first).step_by(2).copied().collect();
            let total: f64 = own.iter().map(|(weight, _)| weight).sum();
            let own = own.into_iter().map(move |(weight, mean)| (weight / total, mean));
            (own.clone().map(|(weight, mean)| weight * mean).sum::<f64>(), variance_of_mean(own))
        };
        let ((fine, v), (coarse, w)) = (half(0), half(1));
        let freedom = (freedom - 1.0).max(1.0);
        let mut found = Self { mean, variance: 0.25 * (v + w), freedom, shift: (coarse - fine, v + w), blur: 0.0 };
        found.blur = found.own_blur();
        found
    }

    /// Of an image with the variance of its pixels, which are independent; without one it counts as exact.
    pub fn of_truth(truth: &Truth, tile: Tile, channel: usize) -> Self {
        let (image, count) = (&truth.image, tile.area());
        let variance =
            truth.variance.as_ref().map_or(0.0, |variance| tile.mean(&variance.pixels, image.width, channel) / count);
        let mean = tile.mean(&image.pixels, image.width, channel);
        Self { mean, variance, freedom: f64::INFINITY, shift: (0.0, 0.0), blur: 0.0 }
    }

    /// Whether it is of a series of which not a single sample arrived.
    pub fn is_empty(&self) -> bool {
        self.freedom.is_finite() && self.mean == 0.0 && self.variance == 0.0
    }

    /// What of the difference of the halves is beyond their noise.
    fn own_blur(&self) -> f64 {
        let (shift, variance) = self.shift;
        SHIFT_OF_MEAN * (shift * shift - 4.0 * variance).max(0.0)
    }

    /// Deviations that another mean lies above this one, and the probability that chance puts it as far off (Welch 1947).
    /// 1 where that is no question.
    pub fn against(&self, other: &Self) -> (f64, f64) {
        let (va, vb) = (self.variance, other.variance);
        let difference = other.mean - self.mean;
        // Where not a single sample of the other arrived, that knows nothing.
        if other.is_empty() {
            return (0.0, 1.0);
        }
        // Rounding: images are of single precision.
        let rounding = (2e-6 * (self.mean.abs() + other.mean.abs())).powi(2) + 1e-16;
        let noise = va + vb + rounding;
        let freedom = noise * noise / (va * va / self.freedom + vb * vb / other.freedom).max(f64::MIN_POSITIVE);
        let deviations = difference / (noise + self.blur + other.blur).sqrt();
        // Most are near: their probability is of no interest, and takes the longest.
        let p =
            if deviations.abs() < NEAR { 1.0 } else { student_two_sided(deviations, freedom.clamp(1.0, 1e6) as u32) };
        (deviations, p)
    }
}

/// The means of all tiles of a size.
pub struct TileMeans {
    /// The tiles, row by row.
    pub tiles: Vec<Tile>,
    /// The means of their channels.
    pub means: Vec<[TileMean; 3]>,
}

impl TileMeans {
    /// Of an image. Neighbours, 4 x 4 of them, share what is known of noise and blur: a tile that no bright sample has met
    /// yet, while most of its neighbours have, is no better known than they are.
    pub fn of(width: u32, height: u32, size: u32, mean: &dyn Fn(Tile, usize) -> TileMean) -> Self {
        let tiles: Vec<Tile> = Tile::overlapping(width, height, size).collect();
        let mut means: Vec<[TileMean; 3]> =
            tiles.iter().map(|tile| std::array::from_fn(|channel| mean(*tile, channel))).collect();
        let across = width.div_ceil(size * PARENT).max(1) as usize;
        let down = height.div_ceil(size * PARENT).max(1) as usize;
        let parent = |tile: &Tile| {
            let (x, y) = (tile.x / (size * PARENT), tile.y / (size * PARENT));
            y as usize * across + x as usize
        };
        // Per parent and channel: the children's variances, and their squared shifts beside the noise of these.
        let mut shared = vec![[const { (Vec::new(), Vec::new()) }; 3]; across * down];
        for (tile, own) in tiles.iter().zip(&means) {
            for ((variances, shifts), mean) in shared[parent(tile)].iter_mut().zip(own) {
                variances.push(mean.variance);
                if mean.shift.1 > 0.0 {
                    // Of noise alone it is F-distributed, with the mean d / (d - 2).
                    let expected = mean.freedom / (mean.freedom - 2.0).max(0.5);
                    shifts.push(mean.shift.0.powi(2) / mean.shift.1 / expected);
                }
            }
        }
        let shared: Vec<[(f64, f64); 3]> = shared
            .into_iter()
            .map(|of_parent| {
                of_parent.map(|(mut variances, shifts): (Vec<f64>, Vec<f64>)| {
                    variances.sort_by(f64::total_cmp);
                    let mean = shifts.iter().sum::<f64>() / shifts.len().max(1) as f64;
                    (variances[variances.len() / 2], (mean - 1.0).max(0.0))
                })
            })
            .collect();
        for (tile, own) in tiles.iter().zip(&mut means) {
            for ((variance, shift), mean) in shared[parent(tile)].iter().zip(own) {
                mean.variance = mean.variance.max(LEAST_SHARED * variance);
                mean.blur = mean.own_blur() + SHIFT_OF_MEAN * shift * mean.shift.1;
            }
        }
        Self { tiles, means }
    }
}

/// A picture of where one image is brighter (red) or darker (blue) than a reference, in deviations of tiles; full colour stands for
/// `scale` of them. Each pixel gets the channel that differs most.
pub fn difference_map(width: u32, height: u32, reference: &TileMeans, other: &TileMeans, scale: f64) -> Image {
    let mut pixels = vec![[1.0; 3]; (width * height) as usize];
    for ((tile, own), other) in reference.tiles.iter().zip(&reference.means).zip(&other.means) {
        let all = own.iter().zip(other).map(|(own, other)| own.against(other).0);
        let most = all.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
        let value = (most / scale).clamp(-1.0, 1.0) as f32;
        let fade = 1.0 - value.abs();
        let colour = if value >= 0.0 { [1.0, fade, fade] } else { [fade, fade, 1.0] };
        tile.pixels(width).for_each(|pixel| pixels[pixel] = colour);
    }
    Image { width, height, pixels }
}
