//! Lights that no surface carries, and the table that lights are selected from.

use std::f64::consts::PI;

use glam::{DMat3, DVec3, Vec3};

use crate::layout::{
    LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light, NONE,
};

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
    /// A point with a cone around `direction`: full intensity within `beam_width`, zero beyond `cutoff` (radians), and
    /// between them as `falloff` says.
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
        /// How the intensity falls between the two.
        falloff: Falloff,
        /// A texture that multiplies the intensity, and the light's axes (x, y, direction) in the world.
        texture: Option<(u32, DMat3)>,
    },
    /// A point that projects a texture along the third of its axes.
    Projector {
        /// Where it is.
        position: DVec3,
        /// Its axes in the world: left in the image, up in it, and the way it shines.
        axes: DMat3,
        /// The image of irradiance on the plane at distance 1, W/m².
        texture: u32,
        /// Factor on it.
        irradiance: [f64; 3],
        /// Tangents of half the angles of view, across and down the image.
        tangents: [f64; 2],
    },
    /// Parallel light that travels along `direction`.
    Directional {
        /// The way it travels, unit.
        direction: DVec3,
        /// On a surface that faces it, W/m².
        irradiance: [f64; 3],
    },
}

/// How a spot's intensity falls from the beam's edge to the cut-off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Falloff {
    /// Linearly with the angle, as Mitsuba has it.
    #[default]
    Angle,
    /// With the square of the cosine's way between its values there, as KHR_lights_punctual recommends.
    Cosine,
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
    /// The frame of a light that has one goes to the end of `tables`.
    pub(crate) fn entry(&self, origin: DVec3, tables: &mut Vec<f32>) -> Light {
        let mut frame = |axes: &DMat3| {
            let first = tables.len() as u32;
            for axis in [axes.x_axis, axes.y_axis, axes.z_axis] {
                tables.extend(axis.as_vec3().to_array());
            }
            [first, 0, 0]
        };
        let unframed = Light { source: NONE, ..Light::default() };
        let rgb = |value: [f64; 3]| value.map(|channel| channel as f32);
        match *self {
            Self::Point { position, intensity } => Light {
                kind: LIGHT_POINT,
                position: (position - origin).as_vec3().into(),
                radiance: rgb(intensity),
                ..unframed
            },
            Self::Spot { position, direction, intensity, cutoff, beam_width, falloff, texture } => Light {
                kind: LIGHT_SPOT,
                position: (position - origin).as_vec3().into(),
                v1: direction.as_vec3().into(),
                v2: [cutoff as f32, beam_width as f32, if falloff == Falloff::Cosine { 1.0 } else { 0.0 }],
                radiance: rgb(intensity),
                source: texture.map_or(NONE, |(texture, _)| texture),
                corners: texture.map_or([0; 3], |(_, axes)| frame(&axes)),
                ..unframed
            },
            Self::Projector { position, axes, texture, irradiance, tangents } => Light {
                kind: LIGHT_PROJECTOR,
                position: (position - origin).as_vec3().into(),
                v1: axes.z_axis.as_vec3().into(),
                v2: [tangents[0] as f32, tangents[1] as f32, 0.0],
                radiance: rgb(irradiance),
                source: texture,
                corners: frame(&axes),
                ..unframed
            },
            Self::Directional { direction, irradiance } => {
                Light { kind: LIGHT_DIRECTIONAL, v1: direction.as_vec3().into(), radiance: rgb(irradiance), ..unframed }
            }
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
        LIGHT_PROJECTOR => 4.0 * f64::from(light.v2[0]) * f64::from(light.v2[1]) * strength,
        LIGHT_SPOT => 2.0 * PI * (1.0 - f64::from(light.v2[0]).cos()) * strength,
        _ => PI * scene_radius * scene_radius * strength,
    }
}

/// Area of a triangle light.
pub(crate) fn triangle_area(light: &Light) -> f64 {
    let [v0, v1, v2] = [light.position, light.v1, light.v2].map(|v| Vec3::from(v).as_dvec3());
    0.5 * (v1 - v0).cross(v2 - v0).length()
}
