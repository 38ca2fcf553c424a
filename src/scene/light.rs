//! Lights that no surface carries, and the table that lights are selected from.

use glam::{DVec3, Vec3};
use std::f64::consts::PI;

use crate::layout::{LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light};

/// A light without a surface, in world coordinates.
#[derive(Clone, Copy, Debug)]
pub enum Lamp {
    /// An isotropic point of this intensity, W/sr.
    Point {
        /// Where it is.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: [f64; 3],
    },
    /// A point with a cone around `direction`: full intensity within `beam_width`, zero beyond `cutoff` (radians).
    Spot {
        /// Where it is.
        position: DVec3,
        /// The axis, unit.
        direction: DVec3,
        /// Radiant intensity on the axis, W/sr.
        intensity: [f64; 3],
        /// Half angle at which it ends.
        cutoff: f64,
        /// Half angle up to which it is constant.
        beam_width: f64,
    },
    /// Parallel light that travels along `direction`.
    Directional {
        /// The way it travels, unit.
        direction: DVec3,
        /// On a surface that faces it, W/m².
        irradiance: [f64; 3],
    },
}

/// Relative luminance of a linear sRGB colour (ITU-R BT.709).
pub fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// A weight that is positive wherever any channel is: a blue light must be found too.
pub(crate) fn importance(rgb: [f64; 3]) -> f64 {
    let peak = rgb.iter().copied().fold(0.0, f64::max);
    luminance(rgb).max(0.1 * peak)
}

impl Lamp {
    /// Its entry of the light table (still without its probability), relative to `origin`.
    pub(crate) fn entry(&self, origin: DVec3) -> Light {
        let rgb = |value: [f64; 3]| value.map(|channel| channel as f32);
        match *self {
            Self::Point { position, intensity } => Light {
                kind: LIGHT_POINT,
                position: (position - origin).as_vec3().into(),
                radiance: rgb(intensity),
                ..Light::default()
            },
            Self::Spot { position, direction, intensity, cutoff, beam_width } => Light {
                kind: LIGHT_SPOT,
                position: (position - origin).as_vec3().into(),
                v1: direction.as_vec3().into(),
                v2: [cutoff as f32, beam_width as f32, 0.0],
                radiance: rgb(intensity),
                ..Light::default()
            },
            Self::Directional { direction, irradiance } => Light {
                kind: LIGHT_DIRECTIONAL,
                v1: direction.as_vec3().into(),
                radiance: rgb(irradiance),
                ..Light::default()
            },
        }
    }
}

/// The flux that a light brings to a scene of this radius, W: what selection is in proportion to.
pub(crate) fn power(light: &Light, scene_radius: f64) -> f64 {
    let strength = importance(light.radiance.map(f64::from));
    match light.kind {
        LIGHT_TRIANGLE => PI * strength * triangle_area(light),
        LIGHT_SPHERE => PI * strength * 4.0 * PI * f64::from(light.v1[0]).powi(2),
        LIGHT_POINT => 4.0 * PI * strength,
        LIGHT_SPOT => 2.0 * PI * (1.0 - f64::from(light.v2[0]).cos()) * strength,
        _ => PI * scene_radius * scene_radius * strength,
    }
}

/// Area of a triangle light.
pub(crate) fn triangle_area(light: &Light) -> f64 {
    let [v0, v1, v2] = [light.position, light.v1, light.v2].map(|v| Vec3::from(v).as_dvec3());
    0.5 * (v1 - v0).cross(v2 - v0).length()
}

/// Fills in the probability and the alias table (Walker 1977, in Vose's order) of every entry. Weights of zero leave an
/// entry out.
pub(crate) fn fill_alias_table(lights: &mut [Light], weights: &[f64], total_probability: f64) {
    let sum: f64 = weights.iter().sum();
    let count = lights.len();
    let mut share: Vec<f64> = weights.iter().map(|weight| weight / sum * count as f64).collect();
    for (light, share) in lights.iter_mut().zip(&share) {
        light.probability = (share / count as f64 * total_probability) as f32;
    }
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..count).partition(|index| share[*index] < 1.0);
    while let (Some(lesser), Some(greater)) = (small.last().copied(), large.last().copied()) {
        small.pop();
        lights[lesser].keep = share[lesser] as f32;
        lights[lesser].alias = greater as u32;
        share[greater] -= 1.0 - share[lesser];
        if share[greater] < 1.0 {
            large.pop();
            small.push(greater);
        }
    }
    // What rounding leaves over has a share of one.
    for rest in small.into_iter().chain(large) {
        lights[rest].keep = 1.0;
        lights[rest].alias = rest as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The probability with which the table selects each entry.
    fn selected(lights: &[Light]) -> Vec<f64> {
        let mut probability = vec![0.0; lights.len()];
        for (index, light) in lights.iter().enumerate() {
            probability[index] += f64::from(light.keep) / lights.len() as f64;
            probability[light.alias as usize] += (1.0 - f64::from(light.keep)) / lights.len() as f64;
        }
        probability
    }

    #[test]
    fn alias_table_selects_in_proportion() {
        let skewed = |count: usize| (0..count).map(|index| 1e-3 + (index as f64 * 0.37).sin().powi(8) * 1e4).collect();
        let cases: [Vec<f64>; 5] =
            [vec![3.0], vec![1.0, 5.0, 0.0, 0.25, 3.75, 2.0], vec![1.0; 7], skewed(5), skewed(1000)];
        for weights in cases {
            let mut lights = vec![Light::default(); weights.len()];
            fill_alias_table(&mut lights, &weights, 0.5);
            let sum: f64 = weights.iter().sum();
            for ((weight, light), found) in weights.iter().zip(&lights).zip(selected(&lights)) {
                let expected = weight / sum;
                assert!((found - expected).abs() < 1e-6, "{found} against {expected}");
                assert!((f64::from(light.probability) - 0.5 * expected).abs() < 1e-6 * expected.max(1e-3));
            }
        }
    }
}
