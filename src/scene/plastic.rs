//! What the coating of plastic does to light that crosses it, integrated once per material.

use crate::layout::PLASTIC_CELLS;

/// Fresnel reflectance of a dielectric whose far side has `eta` times the index of the near side (Born and Wolf, section
/// 1.5.2).
pub fn fresnel(cos_i: f64, eta: f64) -> f64 {
    let sin2_t = (1.0 - cos_i * cos_i).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// Share of diffuse light that a smooth boundary reflects: 2 times the integral of F(mu) mu.
pub fn diffuse_reflectance(eta: f64) -> f64 {
    // The integrand has a kink at the critical angle, which the midpoint rule over many cells does not mind.
    const CELLS: usize = 100_000;
    let cell = 1.0 / CELLS as f64;
    (0..CELLS).map(|index| (index as f64 + 0.5) * cell).map(|mu| 2.0 * mu * fresnel(mu, eta) * cell).sum()
}

/// Which microfacets a rough coating has, of which roughness.
#[derive(Clone, Copy, Debug)]
pub enum Microfacets {
    /// GGX.
    Ggx(f64),
    /// Beckmann.
    Beckmann(f64),
}

impl Microfacets {
    /// Share of the microfacets facing a direction of this cosine that it sees, as shaders have it.
    fn g1(self, cosine: f64) -> f64 {
        match self {
            Self::Ggx(alpha) => 1.0 / (1.0 + lambda(cosine, alpha)),
            Self::Beckmann(alpha) => {
                let a = cosine / (alpha * (1.0 - cosine * cosine).max(1e-40).sqrt());
                if a >= 1.6 { 1.0 } else { (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a) }
            }
        }
    }
}

fn lambda(cosine: f64, alpha: f64) -> f64 {
    let tan2 = (1.0 - cosine * cosine).max(0.0) / (cosine * cosine);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Shares of the light from a direction of cosine `mu` that a rough boundary reflects and transmits once.
fn rough_boundary(mu: f64, facets: Microfacets, eta: f64) -> (f64, f64) {
    const SIDE: usize = 48;
    let sine = (1.0 - mu * mu).max(0.0).sqrt();
    let (mut reflected, mut transmitted) = (0.0, 0.0);
    for i in 0..SIDE {
        for j in 0..SIDE {
            let (u, v) = ((i as f64 + 0.5) / SIDE as f64, (j as f64 + 0.5) / SIDE as f64);
            let phi = std::f64::consts::TAU * u;
            // A normal, and what it weighs: D (wo.h) / (wo.z pdf) times the masking of `mu`.
            let h = match facets {
                Microfacets::Ggx(alpha) => {
                    // One that is visible (Dupuy and Benyoub 2023).
                    let length = (alpha * alpha * sine * sine + mu * mu).sqrt();
                    let w = [alpha * sine / length, 0.0, mu / length];
                    let z = (1.0 - v) * (1.0 + w[2]) - w[2];
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    [alpha * (r * phi.cos() + w[0]), alpha * (r * phi.sin()), z + w[2]]
                }
                Microfacets::Beckmann(alpha) => {
                    let slope = alpha * (-(1.0 - v).ln()).sqrt();
                    [slope * phi.cos(), slope * phi.sin(), 1.0]
                }
            };
            let norm = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
            let h = h.map(|value| value / norm);
            let cos_h = sine * h[0] + mu * h[2];
            if cos_h <= 0.0 {
                continue;
            }
            let weight = match facets {
                Microfacets::Ggx(_) => 1.0,
                Microfacets::Beckmann(_) => facets.g1(mu) * cos_h / (mu * h[2]),
            };
            let f = fresnel(cos_h, eta);
            let out = 2.0 * cos_h * h[2] - mu;
            if out > 0.0 {
                reflected += weight * f * facets.g1(out);
            }
            if f < 1.0 {
                let cos_t = (1.0 - (1.0 - cos_h * cos_h) / (eta * eta)).max(0.0).sqrt();
                let down = -mu / eta + h[2] * (cos_h / eta - cos_t);
                if down < 0.0 {
                    transmitted += weight * (1.0 - f) * facets.g1(-down);
                }
            }
        }
    }
    let count = (SIDE * SIDE) as f64;
    (reflected / count, transmitted / count)
}

/// Transmittance of a rough coating from outside, at [`PLASTIC_CELLS`] cosines from 0 to 1, and the share of diffuse light
/// that it reflects from inside.
pub fn rough_coating(facets: Microfacets, eta: f64) -> (Vec<f32>, f64) {
    let last = f64::from(PLASTIC_CELLS - 1);
    let cosines: Vec<f64> = (0..PLASTIC_CELLS).map(|cell| (f64::from(cell) / last).max(1e-6)).collect();
    let table = cosines.iter().map(|mu| rough_boundary(*mu, facets, eta).1 as f32).collect();
    // The trapezoidal rule over the same cosines.
    let inside: f64 = cosines
        .iter()
        .enumerate()
        .map(|(cell, mu)| {
            let end = if cell == 0 || cell == cosines.len() - 1 { 0.5 } else { 1.0 };
            end / last * 2.0 * mu * rough_boundary(*mu, facets, 1.0 / eta).0
        })
        .sum();
    (table, inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From outside at an index of 1.5: 0.0918, from inside 0.5963 (Egan and Hilgeman 1973, table).
    #[test]
    fn diffuse_reflectance_is_the_published_one() {
        assert!((diffuse_reflectance(1.5) - 0.0918).abs() < 1e-4, "{}", diffuse_reflectance(1.5));
        assert!((diffuse_reflectance(1.0 / 1.5) - 0.5963).abs() < 1e-4, "{}", diffuse_reflectance(1.0 / 1.5));
    }

    /// A coating that is almost smooth transmits what Fresnel's equations say.
    #[test]
    fn an_almost_smooth_coating_is_a_smooth_one() {
        let (table, inside) = rough_coating(Microfacets::Ggx(1e-4), 1.5);
        for (cell, value) in table.iter().enumerate().skip(8) {
            let mu = cell as f64 / f64::from(PLASTIC_CELLS - 1);
            assert!((f64::from(*value) - (1.0 - fresnel(mu, 1.5))).abs() < 1e-3, "cosine {mu}: {value}");
        }
        assert!((inside - diffuse_reflectance(1.0 / 1.5)).abs() < 5e-3, "{inside}");
    }
}
