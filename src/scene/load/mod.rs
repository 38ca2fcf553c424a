//! Opening a scene file of any format: a module for each, which describes what a file holds to a [`SceneBuilder`].

pub mod gltf;
mod limits;
pub mod mitsuba;
pub mod obj;
mod options;
pub mod ply;
mod serialized;

use std::path::Path;

use super::description::WORLD;
use super::{Needs, Scene, SceneBuilder};
use crate::error::{Error, Result};

pub use options::LoadOptions;

/// Reads a scene; the extension says which format it is in.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    if extension != "xml"
        && let Some((name, _)) = options.defines.first()
    {
        return Err(Error::Usage(format!("-D {name}: only Mitsuba scenes (.xml) have parameters")));
    }
    if extension != "xml" && options.energy_compensation {
        return Err(Error::Usage(String::from(
            "energy compensation is for rough metals and rough glass of Mitsuba scenes (.xml): other formats have none",
        )));
    }
    let mut builder = match extension.as_str() {
        "xml" => mitsuba::load(path, options)?,
        "gltf" | "glb" => gltf::load(path)?,
        "obj" => obj::load(path)?,
        "ply" => {
            let mut builder = SceneBuilder::new(path);
            let surface = builder.matte([0.5; 3]);
            let mesh = ply::read(path)?;
            builder.mesh(WORLD, &path.display().to_string(), mesh, glam::DAffine3::IDENTITY, surface);
            builder
        }
        _ => {
            std::fs::metadata(path).map_err(|error| Error::read(path, error))?;
            return Err(Error::Usage(format!(
                "{}: a scene is a file with the extension .xml (Mitsuba 3), .gltf, .glb, .obj or .ply",
                path.display()
            )));
        }
    };
    builder.light_selection = options.lights;
    builder.mip_maps = options.mip_maps;
    let mut scene = builder.finish()?;
    if options.energy_compensation && scene.compensations.is_empty() {
        scene.warnings.push(String::from("it has no rough metal or rough glass: energy compensation changes nothing"));
    }
    if options.mip_maps && !Needs::of(&scene).mip_maps {
        scene.warnings.push(String::from("no image colours a material: mip maps change nothing"));
    }
    Ok(scene)
}
