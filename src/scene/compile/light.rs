//! Entries of the light table for lamps, and what lights are worth when one of them is to be selected.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::{DMat3, DVec3, Vec3};

use crate::layout::{
    LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light, NONE, Surface,
};
use crate::scene::SceneBuilder;
use crate::scene::light::{Falloff, Lamp};
use crate::scene::luminance::luminance;
use crate::scene::texture::Pattern;

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

/// The flux of a light into a scene of this radius, W: selection by power is in proportion to it.
pub(crate) fn power(light: &Light, scene_radius: f64) -> f64 {
    let strength = importance(light.radiance.map(f64::from));
    match light.kind {
        LIGHT_TRIANGLE | LIGHT_SPHERE => PI * strength * area(light).unwrap_or_default(),
        LIGHT_POINT => 4.0 * PI * strength,
        LIGHT_PROJECTOR => 4.0 * f64::from(light.v2[0]) * f64::from(light.v2[1]) * strength,
        LIGHT_SPOT => 2.0 * PI * (1.0 - f64::from(light.v2[0]).cos()) * strength,
        LIGHT_DIRECTIONAL => PI * scene_radius * scene_radius * strength,
        kind => unreachable_kind(kind, 0.0),
    }
}

/// Stands for the value that has no meaning for a kind of light: whoever adds a kind must say it, or the caller keeps such lights out.
pub(crate) fn unreachable_kind<T>(kind: u32, instead: T) -> T {
    debug_assert!(false, "light kind {kind} is not to come here");
    instead
}

/// Area of a light, where it has one: of a triangle's front, of a whole sphere.
pub(crate) fn area(light: &Light) -> Option<f64> {
    match light.kind {
        LIGHT_TRIANGLE => Some(triangle_area(light)),
        LIGHT_SPHERE => Some(4.0 * PI * f64::from(light.v1[0]).powi(2)),
        LIGHT_POINT | LIGHT_SPOT | LIGHT_DIRECTIONAL | LIGHT_PROJECTOR => None,
        kind => unreachable_kind(kind, None),
    }
}

/// Area of a triangle light.
pub(super) fn triangle_area(light: &Light) -> f64 {
    let [v0, v1, v2] = [light.position, light.v1, light.v2].map(|v| Vec3::from(v).as_dvec3());
    0.5 * (v1 - v0).cross(v2 - v0).length()
}

/// What its texture leaves of a light in the mean. `brightness` keeps the means of textures, which take a look at every
/// texel: a mesh of many lights shares one.
pub(super) fn textured_share(
    description: &SceneBuilder,
    light: &Light,
    surfaces: &[Surface],
    brightness: &mut HashMap<u32, f64>,
) -> f64 {
    let texture = match light.kind {
        LIGHT_TRIANGLE | LIGHT_SPHERE => surfaces[light.source as usize].emission_texture,
        LIGHT_SPOT | LIGHT_PROJECTOR => light.source,
        LIGHT_POINT | LIGHT_DIRECTIONAL => NONE,
        kind => unreachable_kind(kind, NONE),
    };
    Some(texture).filter(|texture| *texture != NONE).map_or(1.0, |texture| {
        *brightness
            .entry(texture)
            .or_insert_with(|| importance(texture_mean(description, texture, &mut HashMap::new())))
    })
}

/// Mean of a texture's values. `known` keeps those of what is in it: textures may share what they show, and then have far more ways down
/// than there are of them.
fn texture_mean(description: &SceneBuilder, index: u32, known: &mut HashMap<u32, [f64; 3]>) -> [f64; 3] {
    if let Some(mean) = known.get(&index) {
        return *mean;
    }
    let texture = &description.textures[index as usize];
    let mean = match texture.pattern {
        Pattern::Checkerboard(a, b) => {
            let mut square = |index: usize, colour: [f32; 3]| match texture.squares[index] {
                Some(inner) => texture_mean(description, inner, known),
                None => colour.map(f64::from),
            };
            let (a, b) = (square(0, a), square(1, b));
            [0, 1, 2].map(|channel| 0.5 * (a[channel] + b[channel]))
        }
        Pattern::Attribute(_) => [1.0; 3], // no light shows one
        Pattern::Image(image) => {
            let mean = description.images[image].mean();
            [0, 1, 2].map(|i| (mean[i] * f64::from(texture.scale[i]) + f64::from(texture.offset[i])).max(0.0))
        }
    };
    known.insert(index, mean);
    mean
}
