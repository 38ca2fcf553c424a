//! Reflectances of smooth boundaries: Fresnel's equations, and their means over directions.

use super::quadrature::gauss_legendre;

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

/// Fresnel reflectance of a conductor of relative index `eta + i k` (Born and Wolf, section 14.2), as shaders have it.
fn fresnel_conductor(cosine: f64, eta: f64, k: f64) -> f64 {
    let cos2 = cosine * cosine;
    let sin2 = 1.0 - cos2;
    let t0 = eta * eta - k * k - sin2;
    let a2_plus_b2 = (t0 * t0 + 4.0 * eta * eta * k * k).sqrt();
    let a = (0.5 * (a2_plus_b2 + t0)).max(0.0).sqrt();
    let (t1, t2) = (a2_plus_b2 + cos2, 2.0 * cosine * a);
    let perpendicular = (t1 - t2) / (t1 + t2);
    let (t3, t4) = (cos2 * a2_plus_b2 + sin2 * sin2, t2 * sin2);
    0.5 * (perpendicular + perpendicular * (t3 - t4) / (t3 + t4))
}

/// Cosine-weighted mean of a conductor's Fresnel reflectance: 2 times the integral over mu of F(mu) mu.
pub fn mean_fresnel(eta: f64, k: f64) -> f64 {
    gauss_legendre(64).iter().map(|(mu, weight)| weight * 2.0 * mu * fresnel_conductor(*mu, eta, k)).sum()
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
}
