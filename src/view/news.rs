//! What the worker has to tell.

use std::sync::Arc;

use super::layer::Layer;
use crate::image::Image;
use crate::render::film::ErrorEstimate;
use crate::scene::Camera;
use crate::techniques::Settings;
use crate::trace::Trace;

/// What the worker is at.
#[derive(Clone, Debug, PartialEq)]
pub enum Doing {
    /// Reading a scene.
    Loading,
    /// Something that comes before rendering, and the share of it that is done, where that is known.
    Building(&'static str, Option<f64>),
    /// Rendering.
    Rendering,
    /// Nothing: the user has it rest, or there are enough samples.
    Resting,
    /// Nothing: what is wanted cannot be had. The message says why.
    Failed(String),
}

/// What is known of the scene and of how it is rendered.
#[derive(Clone, Debug)]
pub struct Facts {
    /// Which [`super::Wanted::scene_number`] it is about.
    pub scene_number: u64,
    /// The scene's file.
    pub scene: std::path::PathBuf,
    /// The names of its cameras.
    pub cameras: Vec<String>,
    /// The camera that the scene has for what is wanted.
    pub camera: Camera,
    /// Centre and radius of what is not a light, relative to the scene's origin.
    pub core: (glam::DVec3, f64),
    /// What the user should know of the scene and of the technique in it.
    pub warnings: Vec<String>,
    /// What it is rendered with.
    pub settings: Settings,
    /// The device that renders, by its place in the list of devices.
    pub device: usize,
    /// The names of all devices, in their order.
    pub devices: Vec<String>,
}

/// A picture: what is shown of a rendering as it stands.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Its values.
    pub image: Image,
    /// What it shows.
    pub layer: Layer,
    /// The scene that it is of.
    pub scene_number: u64,
    /// The technique and the backend that made it.
    pub made_by: String,
    /// How often shaders had been taken from their files when its kernels were made.
    pub shaders: u64,
    /// The camera that it is seen from.
    pub camera_number: u64,
    /// Samples of the average pixel.
    pub spp: f64,
    /// Seconds of rendering that they took.
    pub seconds: f64,
    /// Samples of pixels per second, of late.
    pub rate: f64,
    /// The relMSE that the variance of the samples lets expect.
    pub estimate: Option<ErrorEstimate>,
    /// The relMSE against the reference, where there is one that is seen from there.
    pub error: Option<f64>,
    /// Samples that were not finite and were dropped.
    pub nonfinite: u64,
}

/// What happened in the brightest sample of a pixel.
#[derive(Clone, Debug)]
pub struct Traced {
    /// Which [`super::Asked::number`] it answers.
    pub number: u64,
    /// The camera that it is seen from.
    pub camera_number: u64,
    /// The paths, or why there are none.
    pub trace: Result<Trace, String>,
    /// Of each subpath, where its vertices are seen in the image, in pixels; nothing where that is behind the camera.
    pub places: Vec<Vec<Option<[f32; 2]>>>,
}

/// All that the worker has told so far.
#[derive(Clone, Debug)]
pub struct News {
    /// What it is at.
    pub doing: Doing,
    /// What went wrong last, if what was wanted then is wanted still.
    pub trouble: Option<String>,
    /// What is known of the scene.
    pub facts: Option<Arc<Facts>>,
    /// The last picture.
    pub picture: Option<Arc<Picture>>,
    /// What was asked of a pixel last.
    pub traced: Option<Arc<Traced>>,
    /// What the compiler says of the shaders as their files are now.
    pub shader_error: Option<String>,
    /// How often the device was lost and opened again.
    pub losses: u32,
    /// The scene with which something failed last.
    pub failed_scene: Option<u64>,
}
