//! The radius within which a sample looks for vertices of light subpaths.
//!
//! Knaus and Zwicker 2011, "Progressive photon mapping: a probabilistic approach", equation 20: its square shrinks by
//! (k + alpha) / (k + 1) after the k-th sample. Then the mean of the samples has both less blur and less noise the more there are.

use std::cell::Cell;

use super::super::table::merging::{ALPHA, RADIUS};
use super::super::technique::Technique;
use crate::scene::Scene;

/// Where the samples of one rendering stand among those of several that are to have one mean: sample `k` gets the radius of sample
/// `first + k * stride`, times `scale`. So many renderings together shrink it as one long one would.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MergeSchedule {
    /// The sample that the rendering's first one stands for.
    pub first: u32,
    /// Samples from one to the next.
    pub stride: u32,
    /// Factor on the radius.
    pub scale: f32,
}

impl MergeSchedule {
    /// Of a rendering that stands alone.
    pub const ALONE: Self = Self { first: 0, stride: 1, scale: 1.0 };
}

/// The radius of each sample.
#[derive(Clone, Debug)]
pub(in super::super) struct MergeRadius {
    /// Which of them a rendering's samples get.
    pub schedule: MergeSchedule,
    /// Of the first sample.
    first: f64,
    alpha: f64,
    /// A sample with its square in squares of the first one: where the next one goes on from.
    known: Cell<(u32, f64)>,
}

impl MergeRadius {
    /// By the technique's parameters `radius` and `alpha`, as a share of the radius of [`Scene::core`], with so many light subpaths in each
    /// sample. The more these are, the closer they lie: a radius that falls like the root of their number meets as many of them.
    pub fn of(technique: &Technique, scene: &Scene, light_paths: u32) -> Self {
        let [radius, alpha] = [RADIUS, ALPHA].map(|parameter| technique.number(&parameter));
        let share = if radius > 0.0 { radius } else { 1.0 / f64::from(light_paths.max(1)).sqrt() };
        Self::new(share * f64::from(scene.core().1), alpha)
    }

    fn new(first: f64, alpha: f64) -> Self {
        Self { schedule: MergeSchedule::ALONE, first, alpha, known: Cell::new((0, 1.0)) }
    }

    /// Of the sample with this index: of that alone, so that it does not matter how a rendering is cut into frames.
    pub fn at(&self, sample: u32) -> f32 {
        let MergeSchedule { first, stride, scale } = self.schedule;
        let sample = first.saturating_add(sample.saturating_mul(stride));
        let (mut from, mut factor) = self.known.get();
        if from > sample {
            (from, factor) = (0, 1.0);
        }
        for k in (from + 1..=sample).map(f64::from) {
            factor *= (k + self.alpha) / (k + 1.0);
        }
        self.known.set((sample, factor));
        (self.first * factor.sqrt()) as f32 * scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r^2 falls like samples^(alpha - 1): Gamma(n + alpha) / Gamma(n + 1) over Gamma(1 + alpha).
    #[test]
    fn it_shrinks_by_the_law() {
        let radius = MergeRadius::new(2.0, 0.5);
        assert_eq!(radius.at(0), 2.0);
        assert!((f64::from(radius.at(1)).powi(2) - 4.0 * 0.75).abs() < 1e-6);
        let gamma_of_three_halves = 0.886_226_925_452_758;
        let squared = (f64::from(radius.at(9999)) / 2.0).powi(2);
        assert!((squared * 100.0 * gamma_of_three_halves - 1.0).abs() < 1e-4, "{squared}");
        // Whatever was asked for before.
        assert_eq!(radius.at(7), MergeRadius::new(2.0, 0.5).at(7));
    }

    #[test]
    fn renderings_in_turn_have_the_radii_of_one() {
        let alone = MergeRadius::new(2.0, 0.5);
        for turn in 0..3 {
            let mut part = MergeRadius::new(2.0, 0.5);
            part.schedule = MergeSchedule { first: turn, stride: 3, scale: 0.5 };
            for k in 0..5 {
                assert_eq!(part.at(k), 0.5 * alone.at(3 * k + turn));
            }
        }
    }

    #[test]
    fn with_alpha_1_it_stays() {
        assert_eq!(MergeRadius::new(0.5, 1.0).at(1000), 0.5);
    }
}
