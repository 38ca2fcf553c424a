//! Mitsuba 3 XML scenes: the same file renders here and there.
//!
//! `document` reads the text (`include`, `default`, `path`, `$name`), `parse` turns it into objects with typed properties
//! (`object`), and one file per kind of object gives them their meaning. What is not supported is an error that names the element, its
//! line and what is valid; so is every property that nobody asked for.

mod bsdf;
mod constant;
mod document;
mod emitter;
mod integrator;
mod loader;
mod metals;
mod missing;
mod numbers;
mod object;
mod parse;
mod refused;
mod sensor;
mod shape;
mod spectrum;
mod texture;
mod transform;
mod value;

use std::path::Path;
use std::rc::Rc;

use crate::error::Result;
use crate::scene::SceneBuilder;
use crate::scene::description::WORLD;
use crate::scene::load::LoadOptions;
use document::Element;
use loader::Loader;
use object::Object;

pub(super) use missing::missing;

/// Reads a scene file, up to what [`SceneBuilder::finish`] does.
pub fn load(path: &Path, options: &LoadOptions) -> Result<SceneBuilder> {
    let root = document::read(path, &options.defines)?;
    check_root(&root)?;
    let scene = parse::parse(&root)?;
    let mut loader = Loader::new(path, options);
    for child in scene.objects() {
        loader.add(&child)?;
        loader.builder.within_limits()?;
    }
    scene.finish()?;
    loader.builder.warnings.extend(scene.take_warnings());
    Ok(loader.builder)
}

fn check_root(root: &Element) -> Result<()> {
    match root.tag.as_str() {
        "scene" => Ok(()),
        tag => Err(root.error(format!("the root element is <{tag}>, and a Mitsuba scene's is <scene>"))),
    }
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
            tag if refused::reason(tag, &object.plugin).is_some() => Err(object.unknown_plugin(&[])),
            // Of sensors and shapes that refer to it.
            "film" | "sampler" | "rfilter" if object.id.is_some() => Ok(()),
            tag => Err(object.error(format!(
                "<{tag}> is not supported here; supported are shape, bsdf, texture, emitter, sensor and integrator"
            ))),
        }
    }
}
