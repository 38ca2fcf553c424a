//! An environment, of which glTF has none: `extras` of the scene can name an image,
//! `{"lumbre": {"environment": {"uri": "sky.hdr", "intensity": 1, "rotation_degrees": 0}}}`.

use std::path::Path;

use glam::DMat3;
use gltf::json::Value;
use serde::Deserialize;

use super::document::{Document, SceneEntry};
use super::uri::{Resource, resolve};
use crate::error::Result;
use crate::files::{FILE_BYTES, read_bytes};
use crate::image::{Encoding, decode_texture};
use crate::scene::SceneBuilder;
use crate::scene::texture::{Pattern, TextureDescription, Wrap};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Extras {
    environment: Option<Environment>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Environment {
    uri: String,
    #[serde(default = "one")]
    intensity: f32,
    #[serde(default)]
    rotation_degrees: f64,
}

fn one() -> f32 {
    1.0
}

/// Adds the environment, if there is one.
pub(super) fn load(document: &Document, scene: &SceneEntry, builder: &mut SceneBuilder) -> Result<()> {
    let Some(extras) = scene.extras.get("lumbre") else { return Ok(()) };
    let element = format!("{}.extras.lumbre", scene.element);
    let extras: Extras =
        serde_json::from_value(Value::clone(extras)).map_err(|error| document.wrong(&element, error))?;
    let Some(environment) = extras.environment else { return Ok(()) };
    let element = format!("{element}.environment");
    let intensity = document.amount(&element, "intensity", environment.intensity)?;
    if !environment.rotation_degrees.is_finite() {
        return Err(document.wrong(&element, "rotation_degrees is not finite"));
    }
    let folder = document.path.parent().unwrap_or(Path::new(""));
    let image = match resolve(folder, &environment.uri).map_err(|message| document.wrong(&element, message))? {
        Resource::File(path) => decode_texture(&read_bytes(&path, FILE_BYTES)?, &path, Encoding::Srgb)?,
        Resource::Data(encoded) => {
            let bytes = encoded.decode().map_err(|message| document.wrong(&element, message))?;
            let inside = format!("{}: {element}", document.path.display());
            decode_texture(&bytes, Path::new(&inside), Encoding::Srgb)?
        }
    };
    let pattern = Pattern::Image(builder.image(image));
    let wrap = [Wrap::Repeat, Wrap::Clamp]; // around the horizon, and not across the poles
    let texture = builder.texture(TextureDescription { wrap, ..TextureDescription::new(pattern) });
    builder.background = Some([f64::from(intensity); 3]);
    builder.environment = Some((texture, DMat3::from_rotation_y(environment.rotation_degrees.to_radians())));
    Ok(())
}
