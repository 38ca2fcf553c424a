//! Opening a scene file of any format: a module for each, which describes what a file holds to a [`SceneBuilder`](super::SceneBuilder).

pub mod gltf;
mod limits;
mod missing;
pub mod mitsuba;
pub mod obj;
mod options;
pub mod ply;
mod ply_attributes;
mod polygons;
mod serialized;
mod tangents;

use std::path::Path;

use super::{Needs, Scene};
use crate::error::{Error, Result, one_of};
use crate::files::{FILE_BYTES, STANDARD_INPUT, take_standard_input};

pub use missing::{Missing, missing, scene_files};
pub use options::{LoadOptions, SceneFormat};

/// The format of a scene file.
fn format_of(path: &Path, options: &LoadOptions) -> Result<SceneFormat> {
    if let Some(format) = options.format {
        return Ok(format);
    }
    let extensions = SceneFormat::ALL.map(|(name, _)| name);
    if path == Path::new(STANDARD_INPUT) {
        let message = format!("a scene from standard input (-): say its format with --format {}", one_of(extensions));
        return Err(Error::Usage(message));
    }
    if let Some(format) = SceneFormat::by_extension(path) {
        return Ok(format);
    }
    std::fs::metadata(path).map_err(|error| Error::read(path, error))?;
    Err(Error::Usage(format!(
        "{}: a scene is a file with the extension .xml (Mitsuba 3), .gltf, .glb, .obj or .ply, or --format says which of them it is like",
        path.display()
    )))
}

/// Reads a scene. `-` is standard input, which is read to its end; files that such a scene refers to are looked for in the working folder.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene> {
    let format = format_of(path, options)?;
    if format != SceneFormat::Xml
        && let Some((name, _)) = options.defines.first()
    {
        return Err(Error::Usage(format!("-D {name}: only Mitsuba scenes (.xml) have parameters")));
    }
    if format != SceneFormat::Xml && options.energy_compensation {
        return Err(Error::Usage(String::from(
            "energy compensation is for rough metals and rough glass of Mitsuba scenes (.xml): other formats have none",
        )));
    }
    if path == Path::new(STANDARD_INPUT) {
        take_standard_input(FILE_BYTES)?;
    }
    let mut builder = match format {
        SceneFormat::Xml => mitsuba::load(path, options)?,
        SceneFormat::Gltf => gltf::load(path)?,
        SceneFormat::Obj => obj::load(path)?,
        SceneFormat::Ply => ply::load(path)?,
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
