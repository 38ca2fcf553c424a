//! What the user wants to see: the window writes it, the worker brings it about.

use std::path::PathBuf;

use super::layer::Layer;
use crate::scene::{Camera, LoadOptions};
use crate::techniques::Overrides;

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

/// What kernels depend on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Choice {
    /// What is asked beyond the scene's file.
    pub overrides: Overrides,
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
