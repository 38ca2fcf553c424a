//! What the coating of plastic does to light that crosses it, integrated once per material.

use glam::DVec3;

use super::microfacets::Microfacets;
use crate::layout::PLASTIC_CELLS;

/// Shares of the light from a direction of cosine `mu` that a rough boundary reflects and transmits once.
fn rough_boundary(mu: f64, facets: Microfacets, eta: f64, rule: &[(f64, f64, f64)]) -> (f64, f64) {
    facets.scattered(DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu), Some(eta), rule)
}

/// The midpoint rule over the unit square.
fn midpoints() -> Vec<(f64, f64, f64)> {
    const SIDE: usize = 48;
    let at = |index: usize| (index as f64 + 0.5) / SIDE as f64;
    (0..SIDE * SIDE).map(|cell| (at(cell / SIDE), at(cell % SIDE), 1.0 / (SIDE * SIDE) as f64)).collect()
}

/// Transmittance of a rough coating from outside, at [`PLASTIC_CELLS`] cosines from 0 to 1, and the share of diffuse light
/// that it reflects from inside.
pub fn rough_coating(facets: Microfacets, eta: f64) -> (Vec<f32>, f64) {
    let rule = midpoints();
    let last = f64::from(PLASTIC_CELLS - 1);
    let cosines: Vec<f64> = (0..PLASTIC_CELLS).map(|cell| (f64::from(cell) / last).max(1e-6)).collect();
    let table = cosines.iter().map(|mu| rough_boundary(*mu, facets, eta, &rule).1 as f32).collect();
    // The trapezoidal rule over the same cosines.
    let inside: f64 = cosines
        .iter()
        .enumerate()
        .map(|(cell, mu)| {
            let end = if cell == 0 || cell == cosines.len() - 1 { 0.5 } else { 1.0 };
            end / last * 2.0 * mu * rough_boundary(*mu, facets, 1.0 / eta, &rule).0
        })
        .sum();
    (table, inside)
}

#[cfg(test)]
mod tests {
    use super::super::fresnel::{diffuse_reflectance, fresnel};
    use super::*;

    /// A coating that is almost smooth transmits what Fresnel's equations say.
    #[test]
    fn an_almost_smooth_coating_is_a_smooth_one() {
        let (table, inside) = rough_coating(Microfacets::isotropic(1e-4, false), 1.5);
        for (cell, value) in table.iter().enumerate().skip(8) {
            let mu = cell as f64 / f64::from(PLASTIC_CELLS - 1);
            assert!((f64::from(*value) - (1.0 - fresnel(mu, 1.5))).abs() < 1e-3, "cosine {mu}: {value}");
        }
        assert!((inside - diffuse_reflectance(1.0 / 1.5)).abs() < 5e-3, "{inside}");
    }
}
