//! Mitsuba 3 XML scenes: the same file renders here and there.
//!
//! `document` reads the text (`include`, `default`, `$name`), `object` turns it into objects with typed properties, and
//! one file per kind of object gives them their meaning. What is not supported is an error that names the element, its
//! line and what is valid; so is every property that nobody asked for.

mod bsdf;
mod document;
mod emitter;
mod integrator;
mod loader;
mod metals;
mod numbers;
mod object;
mod sensor;
mod shape;
mod spectrum;
mod texture;
mod transform;

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use crate::error::{Error, Result};
use crate::scene::SceneBuilder;
use crate::scene::description::WORLD;
use crate::scene::load::LoadOptions;
use loader::Loader;
use object::Object;

/// Reads a scene file, up to what [`SceneBuilder::finish`] does.
pub fn load(path: &Path, options: &LoadOptions) -> Result<SceneBuilder> {
    let root = document::read(path, &options.defines)?;
    if root.tag != "scene" {
        return Err(Error::scene_line(
            &root.file,
            root.line,
            format!("the root element is <{}>, and a Mitsuba scene's is <scene>", root.tag),
        ));
    }
    let scene = object::parse(&root)?;
    let mut loader = Loader {
        builder: SceneBuilder::new(path),
        materials: HashMap::new(),
        groups: HashMap::new(),
        textures: HashMap::new(),
        images: HashMap::new(),
        energy_compensation: options.energy_compensation,
    };
    for child in scene.objects() {
        loader.add(&child)?;
        loader.builder.within_limits()?;
    }
    scene.finish()?;
    loader.builder.warnings.extend(scene.take_warnings());
    Ok(loader.builder)
}

impl Loader {
    fn add(&mut self, object: &Rc<Object>) -> Result<()> {
        match object.tag.as_str() {
            "shape" => self.add_shape(object, WORLD),
            "bsdf" => self.material(object).map(|_| ()),
            "texture" => self.make_texture(object).map(|_| ()),
            "emitter" => self.add_emitter(object),
            "sensor" => self.add_sensor(object),
            "integrator" => self.set_integrator(object),
            tag => Err(object.error(format!(
                "<{tag}> is not supported here; supported are shape, bsdf, texture, emitter, sensor and integrator"
            ))),
        }
    }
}
