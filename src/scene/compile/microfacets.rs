//! Rough surfaces as the shaders have them (`shaders/materials/microfacet.glsl`), in double precision: for what is integrated
//! over them once per material.

use std::f64::consts::TAU;

use glam::DVec3;

use super::fresnel::fresnel;

/// A distribution of microfacets and how they mask each other.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets {
    /// Roughness along the two tangents.
    pub alpha: [f64; 2],
    /// Beckmann's slopes instead of GGX's.
    pub beckmann: bool,
    /// Masking with correlated heights; of GGX only.
    pub correlated: bool,
}

impl Microfacets {
    /// Equal roughness along both tangents, masked from both sides independently.
    pub fn isotropic(alpha: f64, beckmann: bool) -> Self {
        Self { alpha: [alpha; 2], beckmann, correlated: false }
    }

    /// Slope of `w` as the microfacets see it: alpha times the tangent of its angle.
    fn stretched(&self, w: DVec3) -> f64 {
        (self.alpha[0] * w.x).hypot(self.alpha[1] * w.y) / w.z.abs()
    }

    /// Smith's auxiliary function of GGX (Walter et al. 2007, equation 34).
    fn lambda(&self, w: DVec3) -> f64 {
        0.5 * (self.stretched(w).hypot(1.0) - 1.0)
    }

    /// Share of the microfacets facing `w` that it sees; Beckmann's by the approximation of Walter et al. 2007, section 5.2.
    pub fn g1(&self, w: DVec3) -> f64 {
        if !self.beckmann {
            return 1.0 / (1.0 + self.lambda(w));
        }
        let a = 1.0 / self.stretched(w).max(1e-20);
        if a >= 1.6 { 1.0 } else { (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a) }
    }

    /// A normal out of those that shaders sample for `wo`, from two numbers in 0 to 1: GGX's that are visible (Dupuy and
    /// Benyoub 2023); of Beckmann's, all. The first number is the azimuth.
    fn normal(&self, wo: DVec3, u: f64, v: f64) -> DVec3 {
        let [along, across] = self.alpha;
        let phi = TAU * u;
        let h = if self.beckmann {
            let slope = (-(1.0 - v).ln()).sqrt();
            DVec3::new(along * slope * phi.cos(), across * slope * phi.sin(), 1.0)
        } else {
            let w = DVec3::new(along * wo.x, across * wo.y, wo.z).normalize();
            let z = (1.0 - v) * (1.0 + w.z) - w.z;
            let r = (1.0 - z * z).max(0.0).sqrt();
            DVec3::new(along * (r * phi.cos() + w.x), across * (r * phi.sin() + w.y), z + w.z)
        };
        h.normalize()
    }

    /// D G2 (wo.h) / (wo.z pdf) of such a normal: what it weighs besides Fresnel.
    fn weight(&self, wo: DVec3, wi: DVec3, h: DVec3) -> f64 {
        if self.beckmann {
            return self.g1(wo) * self.g1(wi) * wo.dot(h) / (wo.z * h.z);
        }
        if self.correlated {
            let lambda = self.lambda(wo);
            return (1.0 + lambda) / (1.0 + lambda + self.lambda(wi));
        }
        self.g1(wi)
    }

    /// Shares of the light along `wo` (on the side of +z) that are reflected and transmitted once, by facets of relative
    /// index `eta`, or by perfect mirrors where there is none. `rule` is a quadrature rule over the unit square of numbers that
    /// normals are made of: points with their weights, which sum to 1.
    pub fn scattered(&self, wo: DVec3, eta: Option<f64>, rule: &[(f64, f64, f64)]) -> (f64, f64) {
        let (mut reflected, mut transmitted) = (0.0, 0.0);
        for (u, v, share) in rule {
            let h = self.normal(wo, *u, *v);
            let cos_h = wo.dot(h);
            if cos_h <= 0.0 {
                continue;
            }
            let f = eta.map_or(1.0, |eta| fresnel(cos_h, eta));
            let out = 2.0 * cos_h * h - wo;
            if out.z > 0.0 {
                reflected += share * f * self.weight(wo, out, h);
            }
            if let Some(eta) = eta.filter(|_| f < 1.0) {
                let cos_t = (1.0 - (1.0 - cos_h * cos_h) / (eta * eta)).max(0.0).sqrt();
                let down = h * (cos_h / eta - cos_t) - wo / eta;
                if down.z < 0.0 {
                    transmitted += share * (1.0 - f) * self.weight(wo, down, h);
                }
            }
        }
        (reflected, transmitted)
    }
}
