//! glTF 2.0, as text (.gltf) or binary (.glb).
//!
//! The `gltf` crate's JSON types describe the elements; reading them, and every check of what they refer to, is here, because
//! that crate's own reader indexes without checks. An error names the element as glTF does: `meshes[2].primitives[0]`.

mod accessors;
mod buffers;
mod cameras;
mod document;
mod environment;
mod instancing;
mod lights;
mod materials;
mod meshopt;
mod nodes;
mod pose;
mod primitives;
mod range;
mod textures;
mod uri;

use std::path::Path;

use crate::error::Result;
use crate::scene::SceneBuilder;

/// Reads the file's default scene, or its first one, up to what [`SceneBuilder::finish`] does.
pub fn load(path: &Path) -> Result<SceneBuilder> {
    let document = document::Document::read(path)?;
    let buffers = buffers::Buffers::read(&document)?;
    let mut builder = SceneBuilder::new(path);
    document.warn(&mut builder.warnings);
    let scene = document.scene()?;
    environment::load(&document, &scene, &mut builder)?;
    let placements = nodes::placements(&document, &scene)?;
    lights::load(&document, &placements, &mut builder)?;
    cameras::load(&document, &placements, &mut builder)?;
    nodes::load_meshes(&document, &buffers, &placements, &mut builder)?;
    Ok(builder)
}
