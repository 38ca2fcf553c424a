//! What of a description single precision must hold beside its geometry: loaders check what they read, and this what comes of it.

use glam::DVec3;

use crate::error::{Error, Result};
use crate::scene::light::Lamp;
use crate::scene::single;
use crate::scene::{Camera, FilmSettings, SceneBuilder};

/// Coordinates beyond this would not survive single precision's arithmetic: squares of distances overflow.
pub(super) const MAX_COORDINATE: f64 = 1e18;

/// Fails where what emits, a camera or a placement does not fit.
pub(super) fn check(description: &SceneBuilder) -> Result<()> {
    let wrong = |what: &str, message: String| Error::scene(&description.source, format!("{what}: {message}"));
    let fits =
        |what: &str, values: &[f64]| single::check(values.iter().copied()).map_err(|message| wrong(what, message));
    let stands = |what: &str, position: DVec3| match position.abs().max_element() {
        far if far < MAX_COORDINATE && position.is_finite() => Ok(()),
        _ => Err(wrong(
            what,
            format!("it stands at {position}: coordinates must be finite and below {MAX_COORDINATE:e}"),
        )),
    };
    for surface in &description.surfaces {
        fits("the radiance of a surface", &surface.emission)?;
    }
    for lamp in &description.lamps {
        match lamp {
            Lamp::Point { position, intensity, .. } | Lamp::Spot { position, intensity, .. } => {
                stands("a light", *position)?;
                fits("the intensity of a light", intensity)?;
            }
            Lamp::Projector { position, irradiance, .. } => {
                stands("a projector", *position)?;
                fits("the irradiance of a projector", irradiance)?;
            }
            Lamp::Directional { irradiance, .. } => fits("the irradiance of a light", irradiance)?,
        }
    }
    if let Some(rgb) = &description.background {
        fits("the radiance of the background", rgb)?;
    }
    for (group, to_world) in &description.instances {
        let name = &description.groups[*group].name;
        fits(&format!("an entry of the matrix that places '{name}'"), &to_world.to_cols_array())?;
    }
    for camera in &description.cameras {
        let name = format!("camera '{}'", camera.name);
        stands(&name, camera.to_world.translation)?;
        fits(&format!("{name}: its rays"), &rays(camera, description.film))?;
    }
    Ok(())
}

/// All that the device is told of a camera's rays.
fn rays(camera: &Camera, film: FilmSettings) -> Vec<f64> {
    let film = camera.film.unwrap_or(film);
    let plane = camera.image_plane(film.width, film.height);
    let vectors = [plane.corner, plane.dx, plane.dy, plane.lens_x, plane.lens_y, plane.origin];
    vectors.into_iter().flat_map(|vector| vector.to_array()).chain([plane.focus]).collect()
}
