//! The scene as the renderer takes it: flat arrays, validated, in single precision around a nearby origin.
//!
//! Loaders describe what a file holds to a [`SceneBuilder`] in double precision; [`SceneBuilder::finish`] places it,
//! drops what is degenerate, and checks the rest.

mod builder;
pub mod camera;
pub mod filter;
pub mod light;
pub mod load;
pub mod material;
mod mesh;
mod metals;
pub mod mitsuba;
pub mod needs;
pub mod obj;
pub mod ply;
mod serialized;
mod spectrum;

use std::ops::Range;
use std::path::PathBuf;

use glam::{DAffine3, DVec3};

pub use builder::{SceneBuilder, Side, SurfaceDescription};
pub use camera::Camera;
pub use filter::Filter;
pub use load::{LoadOptions, load};
pub use mesh::Mesh;
pub use needs::Needs;

use crate::bvh::Bounds;
use crate::layout::{Corners, Light, Material, Primitive, Surface};

/// A scene, ready to be uploaded.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Where it came from, for messages.
    pub source: PathBuf,
    /// Every camera; there is at least one.
    pub cameras: Vec<Camera>,
    /// The image that the file asks for.
    pub film: FilmSettings,
    /// The technique that the file asks for, if any.
    pub technique: TechniqueRequest,
    /// All triangles and spheres, group by group; within a group the triangles come first.
    pub primitives: Vec<Primitive>,
    /// Where the attributes of each primitive lie; empty where no mesh has any.
    pub corners: Vec<Corners>,
    /// Vertex normals, unit.
    pub normals: Vec<[f32; 3]>,
    /// What the primitives are made of.
    pub surfaces: Vec<Surface>,
    /// The parameters of the BSDFs.
    pub materials: Vec<Material>,
    /// The light table, with the probability of selecting each entry.
    pub lights: Vec<Light>,
    /// Radiance of the background, if it emits.
    pub background: Option<[f32; 3]>,
    /// Probability of selecting the background as the light to sample.
    pub background_probability: f32,
    /// Runs of primitives that are placed together.
    pub groups: Vec<Group>,
    /// Placements of groups, in the rebased world.
    pub instances: Vec<Instance>,
    /// World coordinates of the origin that all positions here are relative to.
    pub origin: DVec3,
    /// The box around everything that is placed, relative to `origin`.
    pub bounds: Bounds,
    /// What the user should know: defaults that stepped in, degenerate faces that were dropped.
    pub warnings: Vec<String>,
}

/// A run of primitives that are placed together.
#[derive(Clone, Debug)]
pub struct Group {
    /// Its name, for messages.
    pub name: String,
    /// Its triangles.
    pub triangles: Range<u32>,
    /// Its spheres, which follow them.
    pub spheres: Range<u32>,
}

impl Group {
    /// All of its primitives.
    pub fn primitives(&self) -> Range<usize> {
        self.triangles.start as usize..self.spheres.end as usize
    }
}

/// One placement of a group.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index of the group.
    pub group: usize,
    /// World (relative to the scene's origin) from group.
    pub to_world: DAffine3,
}

/// The image that a scene file asks for.
#[derive(Clone, Copy, Debug)]
pub struct FilmSettings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Reconstruction filter.
    pub filter: Filter,
}

/// What a scene file asks of the renderer; the command line goes before it.
#[derive(Clone, Debug, Default)]
pub struct TechniqueRequest {
    /// A technique of the table, with its parameters as `name=value`.
    pub integrator: Option<(String, Vec<(String, String)>)>,
    /// Samples per pixel.
    pub spp: Option<u32>,
    /// Longest path in segments; `Some(None)` is no limit.
    pub max_depth: Option<Option<u32>>,
    /// Segments before Russian roulette.
    pub rr_depth: Option<u32>,
}
