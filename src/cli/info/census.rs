//! The figures of `lumbre info`, as its JSON has them.

use std::collections::{BTreeMap, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};

use serde::Serialize;

use lumbre::image::{Texels, TextureImage};
use lumbre::layout::LIGHTS;
use lumbre::render::{KernelSize, Prediction};
use lumbre::scene::{Group, Needs, Power, Scene};

use super::sampling::Sampling;

/// The JSON object of `lumbre info`; its keys are a contract.
#[derive(Serialize)]
pub(super) struct Census {
    schema: &'static str,
    pub scene: String,
    pub width: u32,
    pub height: u32,
    pub filter: String,
    pub cameras: Vec<String>,
    pub triangles: Count,
    pub spheres: Count,
    pub groups: usize,
    pub instances: usize,
    /// Lower and upper corner, in world coordinates.
    pub bounds: [[f64; 3]; 2],
    pub surfaces: usize,
    pub materials: usize,
    /// Entries of the light table by kind.
    pub lights: BTreeMap<&'static str, usize>,
    pub background: bool,
    /// Flux by kind of emitter.
    pub power: BTreeMap<&'static str, Power>,
    /// What the chosen technique cannot sample.
    pub sampling: Sampling,
    pub textures: usize,
    pub images: Vec<Image>,
    pub repeated_images: Vec<Repeat>,
    pub needs: Vec<&'static str>,
    pub left_out: Vec<&'static str>,
    pub warnings: Vec<String>,
    /// One entry per backend.
    pub memory: Vec<Memory>,
    /// What each technique's kernels keep for this scene, on `bvh`.
    pub kernels: Vec<KernelSize>,
}

/// How many there are of something.
#[derive(Serialize)]
pub(super) struct Count {
    /// In memory.
    pub unique: u64,
    /// In the scene: once per instance.
    pub placed: u64,
}

/// An image that textures show.
#[derive(Serialize)]
pub(super) struct Image {
    pub source: String,
    pub width: u32,
    pub height: u32,
    pub format: &'static str,
    pub bytes: u64,
}

/// An image that holds what an earlier one does.
#[derive(Serialize)]
pub(super) struct Repeat {
    pub image: usize,
    pub same_as: usize,
    /// Bytes that it takes for nothing.
    pub bytes: u64,
}

/// What rendering on one backend takes on the device.
#[derive(Serialize)]
#[serde(untagged)]
pub(super) enum Memory {
    Known(Prediction),
    Unknown { backend: &'static str, unknown: String },
}

impl Census {
    pub fn of(scene: &Scene, sampling: Sampling, memory: Vec<Memory>, kernels: Vec<KernelSize>) -> Self {
        let needs = Needs::of(scene);
        let (used, left_out) = needs.describe();
        let corner = |corner: glam::Vec3| (scene.origin + corner.as_dvec3()).to_array();
        let mut lights = BTreeMap::new();
        for light in &scene.lights {
            *lights.entry(LIGHTS[light.kind as usize].prefix).or_default() += 1;
        }
        Self {
            schema: "lumbre-info-1",
            scene: scene.source.display().to_string(),
            width: scene.film.width,
            height: scene.film.height,
            filter: format!("{:?}", scene.film.filter),
            cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
            triangles: count(scene, |group| group.triangles.len()),
            spheres: count(scene, |group| group.spheres.len()),
            groups: scene.groups.len(),
            instances: scene.instances.len(),
            bounds: [corner(scene.bounds.min), corner(scene.bounds.max)],
            surfaces: scene.surfaces.len(),
            materials: scene.materials.len(),
            lights,
            background: needs.background,
            power: scene.powers(),
            sampling,
            textures: scene.textures.len(),
            images: scene.images.iter().map(Image::of).collect(),
            repeated_images: repeated(&scene.images),
            needs: used,
            left_out,
            warnings: scene.warnings.clone(),
            memory,
            kernels,
        }
    }
}

fn count(scene: &Scene, of: impl Fn(&Group) -> usize) -> Count {
    Count {
        unique: scene.groups.iter().map(|group| of(group) as u64).sum(),
        placed: scene.instances.iter().map(|placed| of(&scene.groups[placed.group]) as u64).sum(),
    }
}

impl Image {
    fn of(image: &TextureImage) -> Self {
        Self {
            source: image.source.display().to_string(),
            width: image.width,
            height: image.height,
            format: match image.texels {
                Texels::Srgb8(_) => "8-bit sRGB",
                Texels::Linear8(_) => "8-bit linear",
                Texels::Float(_) => "32-bit float",
            },
            bytes: image.bytes().len() as u64,
        }
    }
}

/// The images that hold what an earlier one does, texel by texel.
fn repeated(images: &[TextureImage]) -> Vec<Repeat> {
    let mut seen: HashMap<u64, Vec<usize>> = HashMap::new();
    let mut found = Vec::new();
    for (index, image) in images.iter().enumerate() {
        let mut hasher = DefaultHasher::new();
        (image.width, image.height, image.texels.format(), image.bytes()).hash(&mut hasher);
        let alike = seen.entry(hasher.finish()).or_default();
        let same = alike.iter().find(|other| {
            let other = &images[**other];
            let shape = |image: &TextureImage| (image.width, image.height, image.texels.format());
            shape(other) == shape(image) && other.bytes() == image.bytes()
        });
        match same {
            Some(same) => found.push(Repeat { image: index, same_as: *same, bytes: image.bytes().len() as u64 }),
            None => alike.push(index),
        }
    }
    found
}
