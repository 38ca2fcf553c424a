//! The radius within which a sample looks for vertices of light paths.
//!
//! Knaus and Zwicker 2011, "Progressive photon mapping: a probabilistic approach", equation 20: its square shrinks by
//! (k + alpha) / (k + 1) after the k-th sample. Then the mean of the samples has both less blur and less noise the more there are.

use super::settings::Technique;
use crate::scene::Scene;

/// The radius of each sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct MergeRadius {
    /// Of the first one; 0 where the technique has no such thing.
    first: f64,
    alpha: f64,
}

impl MergeRadius {
    /// By the technique's parameters `radius` and `alpha`, as a share of the radius of [`Scene::core`], with so many light paths in each
    /// sample. The more these are, the closer they lie: a radius that falls like the root of their number meets as many of them.
    pub fn of(technique: &Technique, scene: &Scene, light_paths: u32) -> Self {
        let number = |name: &str| technique.value(name).and_then(|text| text.parse::<f64>().ok());
        let (Some(radius), Some(alpha)) = (number("radius"), number("alpha")) else {
            return Self { first: 0.0, alpha: 1.0 };
        };
        let share = if radius > 0.0 { radius } else { 1.0 / f64::from(light_paths.max(1)).sqrt() };
        Self { first: share * f64::from(scene.core().1), alpha }
    }

    /// Of the sample with this index: of that alone, so that it does not matter how a rendering is cut into frames.
    pub fn at(&self, sample: u32) -> f32 {
        if self.first == 0.0 {
            return 0.0; // most techniques: nothing to multiply up, frame after frame
        }
        let factor: f64 = (1..=sample).map(f64::from).map(|k| (k + self.alpha) / (k + 1.0)).product();
        (self.first * factor.sqrt()) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r^2 falls like samples^(alpha - 1): Gamma(n + alpha) / Gamma(n + 1) over Gamma(1 + alpha).
    #[test]
    fn it_shrinks_by_the_law() {
        let radius = MergeRadius { first: 2.0, alpha: 0.5 };
        assert_eq!(radius.at(0), 2.0);
        assert!((f64::from(radius.at(1)).powi(2) - 4.0 * 0.75).abs() < 1e-6);
        let gamma_of_three_halves = 0.886_226_925_452_758;
        let squared = (f64::from(radius.at(9999)) / 2.0).powi(2);
        assert!((squared * 100.0 * gamma_of_three_halves - 1.0).abs() < 1e-4, "{squared}");
    }

    #[test]
    fn with_alpha_1_it_stays() {
        assert_eq!(MergeRadius { first: 0.5, alpha: 1.0 }.at(1000), 0.5);
    }
}
