//! What a technique keeps on the device from one dispatch to the next, behind one trait: the renderer knows no technique.

use std::any::Any;
use std::time::Duration;

use super::merging::MergeSchedule;
use super::settings::Settings;
use super::stream::StateStream;
use super::table::Pass;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::statistics::Estimate;

/// Bytes that a technique's state takes on the device, by what they hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateBytes {
    /// The name of the buffers.
    pub name: &'static str,
    /// All of them together.
    pub bytes: u64,
    /// Whether that is what will be allocated, rather than the most that it can come to.
    pub exact: bool,
}

impl StateBytes {
    /// What will be allocated. A buffer of nothing takes four bytes.
    pub(super) fn exact(name: &'static str, bytes: u64) -> Self {
        Self { name, bytes: bytes.max(4), exact: true }
    }
}

/// What a state is made from.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The device that it lies on.
    pub gpu: &'a Gpu,
    /// The scene.
    pub scene: &'a Scene,
    /// The settings of the rendering, which have been checked.
    pub settings: &'a Settings,
    /// For each primitive on the device, its index in the scene.
    pub order: &'a [u32],
    /// For each instance on the device, its index in the scene.
    pub instance_order: &'a [u32],
}

/// A kind of state: what is known of it before it is there.
pub(crate) trait StateKind: Sync {
    /// Fails where the settings make no sense for the technique, or the device cannot do what they ask for.
    fn check(&self, _gpu: &Gpu, _settings: &Settings) -> Result<()> {
        Ok(())
    }

    /// What it will take on the device.
    fn bytes(&self, _scene: &Scene, _settings: &Settings) -> Result<Vec<StateBytes>> {
        Ok(Vec::new())
    }

    /// Makes it, as it is before the first sample.
    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>>;
}

/// What bounds the frames of an image besides time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameLimits {
    /// The most samples of a slot in one frame.
    pub samples: u32,
    /// The most pixel samples of a frame.
    pub pixel_samples: u64,
    /// Whether samples count only once all slots have them.
    pub whole_passes: bool,
}

impl FrameLimits {
    /// Nothing but time bounds them.
    pub const NONE: Self = Self { samples: u32::MAX, pixel_samples: u64::MAX, whole_passes: false };

    /// Bounded by both.
    pub fn and(self, other: Self) -> Self {
        Self {
            samples: self.samples.min(other.samples),
            pixel_samples: self.pixel_samples.min(other.pixel_samples),
            whole_passes: self.whole_passes || other.whole_passes,
        }
    }
}

/// Work that goes before a sample of the image, in a submission of its own.
#[derive(Clone, Debug)]
pub struct Job {
    /// The pass that does it.
    pub pass: Pass,
    /// The first element that it runs over.
    pub first: u32,
    /// How many of them.
    pub count: u32,
    /// What the shader finds as `frame.sample_count`.
    pub samples: u32,
    /// What the shader finds as the technique's own word.
    pub word: u32,
    /// What it is, for messages.
    pub about: String,
}

/// What the film is to be multiplied by.
#[derive(Clone, Copy, Debug)]
pub struct FilmScale {
    /// The factor.
    pub factor: f64,
    /// The estimate of the image's brightness that it follows from.
    pub brightness: Estimate,
}

/// What a technique has to say of a rendering besides the image.
#[derive(Clone, Debug)]
pub struct StateReport {
    /// The key of the figures in the JSON object of `lumbre render`.
    pub key: &'static str,
    /// The figures.
    pub figures: serde_json::Value,
    /// Lines for the summary.
    pub summary: Vec<String>,
}

/// Makes the state that follows one that was only a trial.
pub type NextState = Box<dyn FnOnce(&Context) -> Result<Box<dyn TechniqueState>>>;

/// A state that only finds out how to make the one that takes its place.
pub trait Trial {
    /// What it is for, in words.
    fn doing(&self) -> &'static str;

    /// How to make the state that takes its place, once its jobs have been run.
    fn next(&self) -> Result<NextState>;
}

/// What a technique keeps on the device, and what of its procedure the host decides. A technique that keeps nothing implements nothing.
///
/// [`crate::render::Renderer`] asks for jobs before each sample, dispatches the passes of the row over what [`Self::elements`] says, and
/// hands every shader the address of [`Self::table`].
pub trait TechniqueState: Any + Send {
    /// Device address of its table, by which shaders find what it keeps.
    fn table(&self) -> u64 {
        0
    }

    /// The technique's own word among the push constants, for a frame that begins with this sample.
    fn word(&self, _sample: u32) -> u32 {
        0
    }

    /// What bounds the frames of the image.
    fn limits(&self) -> FrameLimits {
        FrameLimits::NONE
    }

    /// How many elements a pass over [`super::Over::Elements`] runs over.
    fn elements(&self, _pass: &Pass) -> u32 {
        0
    }

    /// What is to be done before the sample of that index; nothing where the state is ready for it. `most` bounds the work of one job,
    /// whatever the speed, for states whose jobs can be cut.
    fn next_job(&self, _sample: u32, _most: u64) -> Option<Job> {
        None
    }

    /// Takes note of a job that has been run.
    fn job_done(&mut self, _job: &Job, _took: Duration) -> Result<()> {
        Ok(())
    }

    /// How much there is of what goes before the first sample, 0 to 1, where that is something to wait for.
    fn start(&self) -> f64 {
        1.0
    }

    /// Bounds the time that jobs before the first sample may take.
    fn set_time_budget(&mut self, _budget: Duration) {}

    /// Says where the samples stand among those of several renderings.
    fn set_merge_schedule(&mut self, _schedule: MergeSchedule) {}

    /// Forgets all samples and begins again with another seed.
    fn restart(&mut self, _seed: u32) -> Result<()> {
        Ok(())
    }

    /// Saves to a stream, or restores from it, all that samples to come depend on. `under_way` is whether some slots are ahead of others
    /// in the current pass: otherwise what lasts for one sample need not be kept.
    fn exchange(&mut self, _stream: &mut StateStream, _under_way: bool) -> Result<()> {
        Ok(())
    }

    /// What the film is to be multiplied by; nothing where it is right as it is.
    fn film_scale(&self) -> Result<Option<FilmScale>> {
        Ok(None)
    }

    /// What it has to say of the rendering.
    fn report(&self) -> Result<Option<StateReport>> {
        Ok(None)
    }

    /// The state as a trial, where it is one: then all jobs before the first sample are run, and another state takes its place.
    fn trial(&self) -> Option<&dyn Trial> {
        None
    }
}

/// The state of techniques that keep nothing.
pub(super) struct Nothing;

impl TechniqueState for Nothing {}

impl StateKind for Nothing {
    fn make(&self, _: &Context) -> Result<Box<dyn TechniqueState>> {
        Ok(Box::new(Self))
    }
}

/// A state that keeps nothing, which takes the place of one that is to be freed before there is another.
pub(crate) fn nothing() -> Box<dyn TechniqueState> {
    Box::new(Nothing)
}
