//! What the loader of a scene keeps between its elements.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::object::Object;
use crate::image::Encoding;
use crate::scene::load::LoadOptions;
use crate::scene::{Mask, SceneBuilder, Side};

/// What a BSDF stands for: the materials of the front and of the back, and what the surface lets pass.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sides {
    pub front: Side,
    pub back: Side,
    pub mask: Option<Mask>,
}

/// What has been made so far; objects that several places refer to are made once.
pub(super) struct Loader {
    pub builder: SceneBuilder,
    pub materials: HashMap<*const Object, Sides>,
    pub textures: HashMap<*const Object, u32>,
    pub images: HashMap<(PathBuf, Encoding), usize>,
    pub groups: HashMap<*const Object, usize>,
    /// Shapes so far, those of merged shapes again each time.
    pub shapes: u32,
    /// Rough metals and rough glass get back what they lose to multiple scattering.
    pub energy_compensation: bool,
}

impl Loader {
    pub fn new(path: &Path, options: &LoadOptions) -> Self {
        Self {
            builder: SceneBuilder::new(path),
            materials: HashMap::new(),
            groups: HashMap::new(),
            shapes: 0,
            textures: HashMap::new(),
            images: HashMap::new(),
            energy_compensation: options.energy_compensation,
        }
    }
}
