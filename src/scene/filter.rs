//! Pixel reconstruction filters, sampled rather than splatted.
//!
//! A sample is placed under the filter with a density in proportion to the filter's absolute value, and weighted so that
//! its mean is the filtered image (Ernst, Stamminger and Greiner 2006). Pixels stay independent of each other, which is
//! what makes the film's sums reproducible and its variance meaningful.

use crate::layout::FILTER_CELLS;

/// A separable reconstruction filter; lengths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant over the pixel.
    Box,
    /// Falls linearly to zero at `radius`.
    Tent {
        /// Where it ends.
        radius: f64,
    },
    /// A Gaussian cut off at `radius`, lowered so that it ends at zero.
    Gaussian {
        /// Standard deviation.
        stddev: f64,
        /// Where it ends.
        radius: f64,
    },
    /// The cubic of Mitchell and Netravali 1988, ending at two pixels.
    Mitchell {
        /// Its parameter B.
        b: f64,
        /// Its parameter C.
        c: f64,
    },
}

impl Filter {
    /// Mitsuba's default.
    pub const GAUSSIAN: Self = Self::Gaussian { stddev: 0.5, radius: 2.0 };

    /// Where the filter ends.
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Box => 0.5,
            Self::Tent { radius } | Self::Gaussian { radius, .. } => radius,
            Self::Mitchell { .. } => 2.0,
        }
    }

    /// Its value at a distance from the pixel's centre, up to a constant factor.
    pub fn value(&self, x: f64) -> f64 {
        let x = x.abs();
        if x > self.radius() {
            return 0.0;
        }
        match *self {
            Self::Box => 1.0,
            Self::Tent { radius } => 1.0 - x / radius,
            Self::Gaussian { stddev, radius } => {
                let bell = |x: f64| (-x * x / (2.0 * stddev * stddev)).exp();
                bell(x) - bell(radius)
            }
            Self::Mitchell { b, c } => {
                let (x2, x3) = (x * x, x * x * x);
                if x < 1.0 {
                    ((12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)) / 6.0
                } else {
                    ((-b - 6.0 * c) * x3
                        + (6.0 * b + 30.0 * c) * x2
                        + (-12.0 * b - 48.0 * c) * x
                        + (8.0 * b + 24.0 * c))
                        / 6.0
                }
            }
        }
    }

    /// The table that `filter_offset` in `shaders/lib/camera.glsl` reads: `FILTER_CELLS + 1` positions that divide the
    /// integral of the filter's absolute value into equal parts, then the weight of each cell. Within a cell the density
    /// is uniform, and the weight makes up for what the filter has more or less there on average.
    pub fn table(&self) -> Vec<f32> {
        const STEPS: usize = 1 << 14;
        let cells = FILTER_CELLS as usize;
        let radius = self.radius();
        let step = 2.0 * radius / STEPS as f64;
        let at = |index: usize| -radius + (index as f64 + 0.5) * step;
        let mut magnitude = vec![0.0; STEPS + 1];
        let mut signed = vec![0.0; STEPS + 1];
        for index in 0..STEPS {
            let value = self.value(at(index)) * step;
            magnitude[index + 1] = magnitude[index] + value.abs();
            signed[index + 1] = signed[index] + value;
        }
        let (total, integral) = (magnitude[STEPS], signed[STEPS]);
        // The position where `sums`, a running integral over the steps, has this value.
        let position = |target: f64| {
            let right = magnitude.partition_point(|sum| *sum < target).clamp(1, STEPS);
            let (low, high) = (magnitude[right - 1], magnitude[right]);
            right as f64 - 1.0 + if high > low { (target - low) / (high - low) } else { 0.0 }
        };
        let bounds: Vec<f64> = (0..=cells).map(|cell| position(total * cell as f64 / cells as f64)).collect();
        let signed_up_to = |position: f64| {
            let whole = (position as usize).min(STEPS - 1);
            signed[whole] + (signed[whole + 1] - signed[whole]) * (position - whole as f64)
        };
        let mut table: Vec<f32> = bounds.iter().map(|bound| (-radius + bound * step) as f32).collect();
        // Each cell is chosen with probability 1 / cells and stands for its share of the filter's integral.
        table.extend(
            bounds
                .windows(2)
                .map(|pair| ((signed_up_to(pair[1]) - signed_up_to(pair[0])) / integral * cells as f64) as f32),
        );
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_reproduce_the_moments_of_the_filter() {
        for filter in [
            Filter::Box,
            Filter::Tent { radius: 1.0 },
            Filter::GAUSSIAN,
            Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        ] {
            let table = filter.table();
            let (bounds, weights) = table.split_at(FILTER_CELLS as usize + 1);
            let moment = |power: i32| -> f64 {
                let cell = |(pair, weight): (&[f32], &f32)| {
                    let (low, high) = (f64::from(pair[0]), f64::from(pair[1]));
                    let n = f64::from(power + 1);
                    f64::from(*weight) * (high.powf(n) - low.powf(n)) / (n * (high - low)).max(1e-30)
                };
                bounds.windows(2).zip(weights).map(cell).sum::<f64>() / f64::from(FILTER_CELLS)
            };
            let steps = 200_000;
            let exact = |power: i32| -> f64 {
                let radius = filter.radius();
                let x = |index: usize| -radius + (index as f64 + 0.5) * 2.0 * radius / f64::from(steps);
                let sum =
                    |p: i32| (0..steps as usize).map(|index| filter.value(x(index)) * x(index).powi(p)).sum::<f64>();
                sum(power) / sum(0)
            };
            assert!((moment(0) - 1.0).abs() < 1e-6, "{filter:?}: the weights' mean is {}", moment(0));
            assert!(moment(1).abs() < 1e-5, "{filter:?}: first moment {}", moment(1));
            assert!(
                (moment(2) - exact(2)).abs() < 2e-3 * exact(2).abs().max(0.1),
                "{filter:?}: {} against {}",
                moment(2),
                exact(2)
            );
        }
    }
}
