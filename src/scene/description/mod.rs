//! The description of a scene, in double precision and in the terms of its file: what loaders write and `compile` reads.

mod builder;
pub mod camera;
pub mod filter;
mod group;
pub mod light;
mod limits;
pub mod material;
mod mesh;
mod request;
mod surface;
pub mod texture;

pub use builder::SceneBuilder;
pub(super) use builder::WORLD;
pub use camera::Camera;
pub use filter::Filter;
pub(super) use group::{Group, Shape, union};
pub(super) use limits::ELEMENTS;
pub use mesh::{Attribute, Mesh};
pub use request::{FilmSettings, LightSelection, TechniqueRequest};
pub use surface::{Mask, Side, SurfaceDescription};
