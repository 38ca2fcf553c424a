//! lumbre: a light-transport laboratory on raw Vulkan.

pub mod backend;
pub mod bvh;
pub mod error;
pub mod film;
pub mod gpu;
pub mod input;
pub mod integrator;
pub mod layout;
pub mod metrics;
pub mod output;
pub mod rays;
pub mod render;
pub mod scene;

pub use error::{Error, Result};
