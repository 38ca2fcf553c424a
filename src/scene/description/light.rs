//! Lights that no surface carries.

use glam::{DMat3, DVec3};

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
