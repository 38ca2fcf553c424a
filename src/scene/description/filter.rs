//! Pixel reconstruction filters, sampled rather than splatted.
//!
//! A sample is placed under the filter with a density in proportion to the filter's absolute value, and weighted so that
//! its mean is the filtered image (Ernst, Stamminger and Greiner 2006). Pixels stay independent of each other, which is
//! what makes the film's sums reproducible and its variance meaningful.

use crate::layout::{FILTER_BOX, FILTER_CELLS, FILTER_GAUSSIAN, FILTER_LANCZOS, FILTER_MITCHELL, FILTER_TENT};

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
    /// sinc(x) sinc(x / lobes) with sinc(x) = sin(pi x) / (pi x), ending at `lobes` pixels (Lanczos; Turkowski 1990).
    Lanczos {
        /// Half its width in pixels.
        lobes: u32,
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
            Self::Lanczos { lobes } => f64::from(lobes),
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
            Self::Lanczos { lobes } => {
                let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
                let x = std::f64::consts::PI * x;
                sinc(x) * sinc(x / f64::from(lobes))
            }
        }
    }

    /// Its kind and parameters as the shaders take them.
    pub(crate) fn parameters(&self) -> (u32, [f32; 2]) {
        let (kind, parameters) = match *self {
            Self::Box => (FILTER_BOX, [0.0; 2]),
            Self::Tent { radius } => (FILTER_TENT, [radius, 0.0]),
            Self::Gaussian { stddev, radius } => (FILTER_GAUSSIAN, [stddev, radius]),
            Self::Mitchell { b, c } => (FILTER_MITCHELL, [b, c]),
            Self::Lanczos { lobes } => (FILTER_LANCZOS, [f64::from(lobes), 0.0]),
        };
        (kind, parameters.map(|parameter| parameter as f32))
    }

    /// Its integral, signed and of its absolute value, up to each of `STEPS` equal steps across it.
    fn running_integrals(&self) -> (Vec<f64>, Vec<f64>) {
        let step = 2.0 * self.radius() / STEPS as f64;
        let (mut signed, mut absolute) = (vec![0.0; STEPS + 1], vec![0.0; STEPS + 1]);
        for index in 0..STEPS {
            let value = self.value(-self.radius() + (index as f64 + 0.5) * step) * step;
            signed[index + 1] = signed[index] + value;
            absolute[index + 1] = absolute[index] + value.abs();
        }
        (signed, absolute)
    }

    /// Its integral.
    pub(crate) fn integral(&self) -> f64 {
        self.running_integrals().0[STEPS]
    }

    /// The positions that divide the integral of its absolute value into `FILTER_CELLS` equal parts: `filter_offset` in
    /// `shaders/core/camera.glsl` draws a cell, then a place in it, and weights by the filter's value there.
    pub(crate) fn cells(&self) -> Vec<f32> {
        let (_, sums) = self.running_integrals();
        let step = 2.0 * self.radius() / STEPS as f64;
        let position = |cell: u32| {
            let target = sums[STEPS] * f64::from(cell) / f64::from(FILTER_CELLS);
            let right = sums.partition_point(|sum| *sum < target).clamp(1, STEPS);
            let (low, high) = (sums[right - 1], sums[right]);
            let within = if high > low { (target - low) / (high - low) } else { 0.0 };
            (-self.radius() + (right as f64 - 1.0 + within) * step) as f32
        };
        let mut positions: Vec<f32> = (0..=FILTER_CELLS).map(position).collect();
        // The tails that the steps cannot tell from nothing belong to the outermost cells.
        (positions[0], positions[FILTER_CELLS as usize]) = (-self.radius() as f32, self.radius() as f32);
        positions
    }
}

/// Steps of the filter's quadrature.
const STEPS: usize = 1 << 14;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_and_weights_reproduce_the_moments_of_the_filter() {
        let third = 1.0 / 3.0;
        for filter in [
            Filter::Box,
            Filter::Tent { radius: 1.0 },
            Filter::GAUSSIAN,
            Filter::Mitchell { b: third, c: third },
            Filter::Mitchell { b: 0.0, c: 0.5 },
            Filter::Lanczos { lobes: 3 },
        ] {
            let (cells, integral) = (filter.cells(), filter.integral());
            // What the shader does, with the random number within a cell at the nodes of a quadrature.
            let moment = |power: i32| -> f64 {
                let nodes =
                    cells.windows(2).flat_map(|pair| (0..200).map(move |node| (pair, (f64::from(node) + 0.5) / 200.0)));
                let terms = nodes.map(|(pair, t)| {
                    let (left, right) = (f64::from(pair[0]), f64::from(pair[1]));
                    let x = left * (1.0 - t) + right * t;
                    filter.value(x) / integral * (right - left) * x.powi(power)
                });
                terms.sum::<f64>() / 200.0
            };
            let exact = |power: i32| -> f64 {
                let x = |index: u32| filter.radius() * ((f64::from(index) + 0.5) / 1e5 - 1.0);
                let sum =
                    |power: i32| (0..200_000).map(|index| filter.value(x(index)) * x(index).powi(power)).sum::<f64>();
                sum(power) / sum(0)
            };
            assert!((moment(0) - 1.0).abs() < 1e-5, "{filter:?}: the mean weight is {}", moment(0));
            for power in 1..5 {
                let (found, expected) = (moment(power), exact(power));
                assert!((found - expected).abs() < 1e-4, "{filter:?}: moment {power} is {found}, not {expected}");
            }
        }
    }
}
