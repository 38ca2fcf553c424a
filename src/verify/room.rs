//! A small room: a floor, a wall, a block and a ball under a lamp.

use glam::{DAffine3, DQuat, DVec3};

use super::geometry::{lamp, look};
use crate::error::Result;
use crate::scene::material::{self, MaterialDescription};
use crate::scene::{Mesh, Scene, SceneBuilder, SurfaceDescription};

/// What makes a material.
pub(super) type Makes = fn() -> MaterialDescription;

/// A matte one.
pub(super) const MATTE: Makes = || material::diffuse([0.3, 0.5, 0.7]).into();

/// A rough metal.
pub(super) const ROUGH_METAL: Makes =
    || material::conductor([0.2, 0.92, 1.1], [3.9, 2.45, 2.14], [1.0; 3], Some([0.3; 2])).into();

/// The room with a block and a ball of these materials, `scale` times as large as it is.
pub(super) fn scaled(block: Makes, ball: Makes, size: u32, scale: f64, radiance: f64) -> Result<Scene> {
    let mut builder = SceneBuilder::new("room");
    let white = builder.matte([0.7, 0.6, 0.5]);
    let v = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * scale;
    builder.parallelogram(v(-3.0, 0.0, -3.0), v(0.0, 0.0, 6.0), v(6.0, 0.0, 0.0), white);
    builder.parallelogram(v(-3.0, -3.0, -1.5), v(6.0, 0.0, 0.0), v(0.0, 6.0, 0.0), white);
    let of = |builder: &mut SceneBuilder, makes: Makes| {
        let id = builder.material(makes());
        builder.surface(SurfaceDescription { front: Some(id), ..SurfaceDescription::default() })
    };
    let surface = of(&mut builder, block);
    let turn = DQuat::from_rotation_y(30f64.to_radians());
    let place = DAffine3::from_scale_rotation_translation(DVec3::splat(0.5 * scale), turn, v(-0.9, 0.52, 0.0));
    builder.mesh(0, "block", Mesh::cube(), place, surface);
    let surface = of(&mut builder, ball);
    builder.sphere(0, "ball", v(0.8, 0.6, 0.2), 0.6 * scale, surface);
    let light = lamp(&mut builder, [9.0, 8.0, 7.0].map(|channel| channel * radiance));
    builder.parallelogram(v(-0.6, 2.6, -0.6), v(1.2, 0.0, 0.0), v(0.0, 0.0, 1.2), light);
    look(&mut builder, size, v(0.0, 1.0, 6.0), v(0.0, 0.8, 0.0), 40.0)?;
    builder.finish()
}

/// The room as it is.
pub(super) fn lit(block: Makes, ball: Makes, size: u32) -> Result<Scene> {
    scaled(block, ball, size, 1.0, 1.0)
}
