//! What the uniforms say of the camera, which can be moved while a scene is on the device.

use std::mem::offset_of;

use crate::error::Result;
use crate::gpu::Buffer;
use crate::layout::SceneUniforms;
use crate::scene::Scene;
use crate::scene::camera::ImagePlane;

/// The rays of an image, and what the camera stands in.
pub(super) fn set(uniforms: &mut SceneUniforms, scene: &Scene, plane: &ImagePlane) {
    let vector = |v: glam::DVec3| v.as_vec3().to_array();
    uniforms.camera_origin = vector(plane.origin);
    uniforms.camera_corner = vector(plane.corner);
    uniforms.camera_dx = vector(plane.dx);
    uniforms.camera_dy = vector(plane.dy);
    uniforms.lens_x = vector(plane.lens_x);
    uniforms.lens_y = vector(plane.lens_y);
    uniforms.focus = plane.focus as f32;
    uniforms.camera_absorption = scene.absorption_at(plane.origin);
}

/// Changes these alone in a uniform buffer.
pub(super) fn change(buffer: &Buffer, scene: &Scene, plane: &ImagePlane) -> Result<()> {
    // They follow each other: from the first of them to what comes next.
    const FIRST: usize = offset_of!(SceneUniforms, camera_origin);
    const END: usize = offset_of!(SceneUniforms, background);
    let mut uniforms = SceneUniforms::default();
    set(&mut uniforms, scene, plane);
    buffer.upload_at(FIRST as u64, &bytemuck::bytes_of(&uniforms)[FIRST..END])
}
