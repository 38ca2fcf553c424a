//! Everything in a scene that would be refused, rather than the first of it.

use std::collections::HashSet;
use std::path::Path;
use std::rc::Rc;

use super::loader::Loader;
use super::object::Object;
use super::{document, parse};
use crate::error::{Error, Result};
use crate::scene::description::WORLD;
use crate::scene::load::{LoadOptions, Missing};

/// Tries each object of a scene by itself.
pub(in crate::scene::load) fn missing(path: &Path, options: &LoadOptions) -> Missing {
    match read(path, options) {
        Ok(missing) => missing,
        Err(error) => Missing { refused: vec![error.to_string()], ..Missing::default() },
    }
}

fn read(path: &Path, options: &LoadOptions) -> Result<Missing> {
    let root = document::read(path, &options.defines)?;
    super::check_root(&root)?;
    let (scene, wrong) = parse::parse_what_is_right(&root)?;
    let mut loader = Loader::new(path, options);
    let mut found = Found { seen: HashSet::new(), refused: wrong.iter().map(Error::to_string).collect() };
    found.try_children(&mut loader, &scene);
    found.refused.extend(loader.builder.technique.refused.take());
    let mut builder = loader.builder;
    builder.warnings.extend(scene.take_warnings());
    let mut missing = Missing { refused: Vec::new(), warnings: builder.warnings.clone(), names: root.file.named() };
    if found.refused.is_empty() {
        match builder.finish() {
            Ok(scene) => missing.warnings = scene.warnings,
            Err(error) => missing.refused.push(error.to_string()),
        }
    }
    // What contains something that is refused is refused for the same reason.
    let mut told = HashSet::new();
    missing.refused.extend(found.refused.into_iter().filter(|message| told.insert(message.clone())));
    missing.warnings.dedup();
    Ok(missing)
}

struct Found {
    seen: HashSet<*const Object>,
    refused: Vec<String>,
}

impl Found {
    /// Tries what is within an object, and then that object.
    fn try_children(&mut self, loader: &mut Loader, object: &Rc<Object>) {
        for child in object.objects() {
            if self.seen.insert(Rc::as_ptr(&child)) {
                self.try_children(loader, &child);
                let read = match child.tag.as_str() {
                    // These are read by what holds them.
                    "film" | "sampler" | "rfilter" => Ok(()),
                    "emitter" if matches!(child.plugin.as_str(), "area" | "directionalarea") => Ok(()),
                    "shape" => loader.add_shape(&child, WORLD),
                    _ => loader.add(&child),
                };
                self.note(&child, read);
            }
        }
    }

    fn note(&mut self, object: &Object, read: Result<()>) {
        let Err(error) = read else { return };
        let (message, unasked) = (error.to_string(), object.unasked());
        // Where the end was reached, all that nobody asked for is known.
        match unasked.first() {
            Some(first) if first.to_string() == message => self.refused.extend(unasked.iter().map(Error::to_string)),
            _ => self.refused.push(message),
        }
    }
}
