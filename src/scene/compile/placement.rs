//! Where a scene is put: the origin that its single-precision coordinates are relative to, and the camera that stands in
//! where a file has none.

use glam::{DAffine3, DVec3};

use super::ranges::MAX_COORDINATE;
use crate::error::{Error, Result};
use crate::scene::SceneBuilder;
use crate::scene::camera::{Camera, FovAxis, look_at};
use crate::scene::description::{WORLD, union};

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

/// The box around everything that is placed, in world coordinates; nothing where there is no geometry. A group that is
/// placed more than once counts by its box, not by its vertices, which may be many times all that the scene holds.
pub(super) fn world_extent(description: &SceneBuilder) -> Result<Option<(DVec3, DVec3)>> {
    let mut placements = vec![0usize; description.groups.len()];
    description.instances.iter().for_each(|(group, _)| placements[*group] += 1);
    let boxes: Vec<Option<(DVec3, DVec3)>> = description
        .groups
        .iter()
        .zip(&placements)
        .map(|(group, count)| if *count > 1 { group.extent(&DAffine3::IDENTITY) } else { None })
        .collect();
    let mut all = description.groups[WORLD].extent(&DAffine3::IDENTITY);
    for (group, to_world) in &description.instances {
        let placed = match boxes[*group] {
            Some((min, max)) => {
                let corner = |index: usize| {
                    let pick = |axis: usize| if index >> axis & 1 == 0 { min[axis] } else { max[axis] };
                    to_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
                };
                (0..8).map(|index| (corner(index), corner(index))).reduce(union)
            }
            None => description.groups[*group].extent(to_world),
        };
        all = all.into_iter().chain(placed).reduce(union);
    }
    match all {
        Some((min, max))
            if !(min.is_finite() && max.is_finite() && min.abs().max(max.abs()).max_element() < MAX_COORDINATE) =>
        {
            Err(Error::scene(
                &description.source,
                format!("the scene spans {min} to {max}: coordinates must be finite and below {MAX_COORDINATE:e}"),
            ))
        }
        extent => Ok(extent),
    }
}
