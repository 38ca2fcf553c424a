//! Cameras, which look along -z of their nodes with +x to the right.

use std::f32::consts::PI;

use glam::{DMat3, DVec3};
use gltf::json::camera::Type;
use gltf::json::validation::Checked;

use super::document::{Document, shown};
use super::nodes::Placement;
use crate::error::Result;
use crate::scene::camera::{Camera, FovAxis, Projection, look_at};
use crate::scene::{FilmSettings, SceneBuilder};

/// Pixels down the image; the camera's aspect ratio gives those across.
const HEIGHT: u32 = 512;

/// Adds the cameras that nodes carry. A node's scale does not change what a camera sees.
pub(super) fn load(document: &Document, placements: &[Placement], builder: &mut SceneBuilder) -> Result<()> {
    for placement in placements {
        let (node, at) = (&document.nodes[placement.node], placement.element());
        let Some(index) = node.camera else { continue };
        let camera = document.get(&document.cameras, "cameras", index, &at)?;
        let name = format!("cameras[{index}]");
        let label = camera.name.as_ref().or(node.name.as_ref());
        let label = label.map_or_else(|| format!("camera{}", builder.cameras.len()), |label| shown(label));
        let map = |axis: DVec3| placement.to_world.transform_vector3(axis);
        let from = placement.to_world.translation;
        let to_world = look_at(from, from + map(DVec3::NEG_Z), map(DVec3::Y))
            .ok_or_else(|| document.wrong(&at, "is scaled to nothing, and its camera has no direction"))?;
        let positive = |what: &str, value: f32| match value {
            _ if value.is_finite() && value > 0.0 => Ok(f64::from(value)),
            _ => Err(document.wrong(&name, format!("{what} is {value}, and must be finite and above 0"))),
        };
        let (mut camera, aspect) = match (&camera.type_, &camera.perspective, &camera.orthographic) {
            (Checked::Valid(Type::Perspective), Some(view), _) => {
                if !(view.yfov > 0.0 && view.yfov < PI) {
                    return Err(document.wrong(&name, format!("yfov is {}, and must be between 0 and pi", view.yfov)));
                }
                let fov = f64::from(view.yfov).to_degrees();
                let aspect = view.aspect_ratio.map(|aspect| positive("aspectRatio", aspect)).transpose()?;
                (Camera::new(&label, to_world, fov, FovAxis::Y), aspect)
            }
            (Checked::Valid(Type::Orthographic), _, Some(view)) => {
                let (across, down) = (positive("xmag", view.xmag)?, positive("ymag", view.ymag)?);
                let mut to_world = to_world;
                to_world.matrix3 *= DMat3::from_diagonal(DVec3::new(across, across, 1.0));
                let mut camera = Camera::new(&label, to_world, 90.0, FovAxis::X);
                camera.projection = Projection::Orthographic;
                (camera, Some(across / down))
            }
            _ => return Err(document.wrong(&name, "its type is unknown or what it says of that type is missing")),
        };
        if let Some(aspect) = aspect {
            let width = (f64::from(HEIGHT) * aspect).round().clamp(1.0, 16.0 * f64::from(HEIGHT)) as u32;
            let film = FilmSettings { width, height: HEIGHT, ..builder.film };
            if builder.cameras.is_empty() {
                builder.film = film;
            } else {
                camera.film = Some(film);
            }
        }
        builder.cameras.push(camera);
    }
    Ok(())
}
