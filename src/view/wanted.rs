//! What the user wants to see: the window writes it, the worker brings it about.

use std::path::PathBuf;

use super::layer::Layer;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::layout::backend::Backend;
use crate::scene::{Camera, LoadOptions};
use crate::techniques::Sampler;

/// Layers that the film keeps besides the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layers {
    /// None.
    #[default]
    Nothing,
    /// One for each path length up to so many segments; the last one has all longer paths as well.
    Lengths(u32),
    /// Two for each strategy of paths of up to so many segments.
    Strategies(u32),
}

/// What kernels depend on. Nothing is what the scene asks for, or the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// The technique with its parameters, as `-i` takes it.
    pub technique: Option<String>,
    /// The ray backend, as `--backend` takes it.
    pub backend: String,
    /// Width and height of the image in pixels.
    pub size: Option<(u32, u32)>,
    /// The scene's camera, by name or number.
    pub camera: Option<String>,
    /// Longest path in segments; `Some(None)` is no limit.
    pub max_depth: Option<Option<u32>>,
    /// Segments after which Russian roulette may end a path.
    pub rr_depth: Option<u32>,
    /// Where uniform numbers come from.
    pub sampler: Option<Sampler>,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Layers that the film keeps.
    pub layers: Layers,
    /// Whether AOVs can be shown.
    pub has_aovs: bool,
}

/// A pixel whose brightest sample is to be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Counts what was asked.
    pub number: u64,
    /// Its column and row.
    pub pixel: [u32; 2],
}

/// What the worker is to do.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// The scene's file.
    pub scene: PathBuf,
    /// How it is to be read.
    pub options: LoadOptions,
    /// Counts scenes: the same file with another number is read again.
    pub scene_number: u64,
    /// The device, as `--device` takes it.
    pub device: Option<String>,
    /// What kernels depend on.
    pub choice: Choice,
    /// The camera, where it is not the scene's any more.
    pub camera: Option<Camera>,
    /// Counts what is seen from elsewhere.
    pub camera_number: u64,
    /// What is shown.
    pub layer: Layer,
    /// An image that stands for the truth.
    pub reference: Option<PathBuf>,
    /// Whether rendering rests.
    pub is_paused: bool,
    /// The pixel that was clicked on last.
    pub asked: Option<Asked>,
    /// The folder that shaders are taken from whenever its files change.
    pub shaders: Option<PathBuf>,
    /// Samples per pixel that are enough; nothing is never.
    pub spp: Option<u32>,
}

/// The backend that a name stands for on a device, `auto` included.
pub type ChooseBackend = fn(&str, &Gpu) -> Result<Backend>;
