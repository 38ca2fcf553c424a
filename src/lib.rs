//! lumbre: a light-transport laboratory on raw Vulkan.
//!
//! One program, and this library under it, renders a scene with any technique of its [table](techniques::TECHNIQUES) on
//! any Vulkan 1.3 device, through [ray queries or a compute BVH](layout::backend::BACKENDS), and says how long it took and how
//! noisy the result is.
//!
//! Data flows one way: a scene file becomes a [`scene::Scene`], what it uses becomes [`scene::Needs`], both go to the
//! device as a [`render::Renderer`], whose samples come back as a [`render::film::Film`] and leave through [`image`].
//!
//! ```
//! use glam::DVec3;
//! use lumbre::layout::backend::Backend;
//! use lumbre::gpu::{Gpu, Instance};
//! use lumbre::render::{Settings, Technique, render};
//! use lumbre::scene::{Camera, SceneBuilder, SurfaceDescription};
//!
//! # fn main() -> lumbre::Result<()> {
//! // A floor under a small square light.
//! let mut builder = SceneBuilder::new("example");
//! let floor = builder.matte([0.5; 3]);
//! let light = builder.surface(SurfaceDescription { emission: [10.0; 3], ..Default::default() });
//! builder.parallelogram(DVec3::new(-4.0, 0.0, -4.0), DVec3::Z * 8.0, DVec3::X * 8.0, floor);
//! builder.parallelogram(DVec3::new(-0.5, 2.0, -0.5), DVec3::X, DVec3::Z, light);
//! builder.cameras.push(Camera::look_at(DVec3::new(0.0, 3.0, 6.0), DVec3::ZERO, DVec3::Y, 45.0)?);
//! let scene = builder.finish()?;
//!
//! let gpu = Gpu::open(&Instance::new(false)?, None)?;
//! let mut settings = Settings::new(&scene, Technique::parse("path")?, Backend::Bvh);
//! (settings.width, settings.height) = (32, 32);
//! let film = render(&gpu, &scene, &settings, 16)?;
//!
//! let image = film.mean();
//! assert_eq!(image.pixels.len(), 32 * 32);
//! assert!(image.average()[0] > 0.0 && film.nonfinite == 0);
//! # Ok(())
//! # }
//! ```

pub mod bench;
pub mod bvh;
pub mod checkpoint;
pub mod denoise;
pub mod error;
pub mod files;
pub mod gpu;
pub mod image;
pub mod layout;
pub mod lecture;
pub mod merge;
#[cfg(feature = "hot-reload")]
pub mod modules;
pub mod rays;
pub mod reference;
pub mod render;
pub mod report;
pub mod scene;
pub mod spirv;
pub mod statistics;
pub mod techniques;
pub mod trace;
pub mod verify;
#[cfg(feature = "view")]
pub mod view;

pub use error::{Error, Result};
#[cfg(feature = "hot-reload")]
use techniques::table; // by the name that the build script has for it
