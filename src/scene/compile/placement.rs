//! Where a scene is put: the origin that its single-precision coordinates are relative to, and the camera that stands in
//! where a file has none.

use glam::{DAffine3, DVec3};

use crate::scene::camera::{Camera, FovAxis, look_at};

/// The point that single precision is kept fine around: the world's own origin as long as the scene is near it, which
/// leaves round coordinates round; else the camera, where precision is seen.
pub(super) fn choose_origin(extent: Option<(DVec3, DVec3)>, camera: DVec3) -> DVec3 {
    let Some((min, max)) = extent else { return DVec3::ZERO };
    let (min, max) = (min.min(camera), max.max(camera));
    let far = min.abs().max(max.abs()).max_element();
    if far <= 4.0 * (max - min).length() { DVec3::ZERO } else { camera.round() }
}

/// A camera that sees the whole of the box from a little above.
pub(super) fn framing_camera(extent: Option<(DVec3, DVec3)>) -> Camera {
    let (min, max) = extent.unwrap_or((DVec3::splat(-1.0), DVec3::splat(1.0)));
    let (centre, radius) = ((min + max) / 2.0, ((max - min).length() / 2.0).max(1e-6));
    let fov: f64 = 40.0;
    let distance = radius / (fov.to_radians() / 2.0).sin();
    let from = centre + DVec3::new(0.5, 0.35, 1.0).normalize() * distance;
    let to_world = look_at(from, centre, DVec3::Y).unwrap_or(DAffine3::from_translation(from));
    Camera::new("default", to_world, fov, FovAxis::Smaller)
}
