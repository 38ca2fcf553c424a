//! Rendering: upload, specialise, iterate, film.
//!
//! A [`Renderer`] is one scene, technique and backend on one device. Each [`Renderer::advance`] is one frame: a
//! submission of about a tenth of a second, so that drivers' watchdogs never fire, progress is smooth, and an interrupt
//! is answered at once.

pub mod aovs;
mod blocks;
mod camera_uniforms;
mod counted;
mod device_scene;
pub mod film;
mod frames;
mod kernel;
mod memory;
mod probe;
mod records;
mod saved;
mod spent;
mod submissions;
mod sums;
mod target;
mod watch;

use std::any::Any;
use std::io::{Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use aovs::{AovFilm, AovPass};
pub use counted::Counted;
pub use memory::{Part, Prediction};
pub use probe::Probe;
use records::Recorder;
pub use records::Wanted;
pub use saved::SavedFilm;
pub use spent::{Spent, spent};
pub use sums::FilmShape;

use crate::error::{Error, Result};
use crate::gpu::{Buffer, Gpu};
use crate::layout::{FilmPixel, PathRecord, WORKGROUP};
use crate::render::blocks::Blocks;
use crate::render::film::Film;
use crate::render::sums::FilmSums;
use crate::scene::Scene;
use crate::techniques::{BLOCK_SAMPLES, Shard};
use crate::techniques::{
    Context, FilmScale, MergeSchedule, Pass, StateReport, StateStream, Store, TechniqueState, stages,
};
pub use crate::techniques::{Settings, Technique};
pub use device_scene::DeviceScene;
use frames::{Frame, FramePlan};
use kernel::Kernel;
pub use kernel::{Constants, KernelSize, kernel_sizes, modules_of};
use memory::{LAYER_PIXEL_BYTES, TALLY_BYTES};
pub use target::ErrorTarget;
use watch::while_compiling;
pub use watch::{Building, Watch};

pub use crate::gpu::modules_fingerprint as kernels_fingerprint;

/// Of the time that a rendering is given, what may pass before its first sample.
const START_SHARE: f64 = 0.25;

/// Seconds that the parts of a rendering took.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
pub struct Seconds {
    /// Building the acceleration structure and uploading the scene.
    pub build: f64,
    /// Making pipelines and running each once without work, which is when CPU devices compile.
    pub compile: f64,
    /// All frames, by the host's clock.
    pub render: f64,
    /// All frames, by the device's clock.
    pub device: f64,
}

/// One scene, technique and backend on one device.
pub struct Renderer {
    gpu: Gpu,
    settings: Settings,
    /// The row's passes in order; the first one's scene is that of all.
    passes: Vec<(Pass, Kernel)>,
    /// The stage of each.
    stages: Vec<u32>,
    /// What the technique keeps on the device.
    state: Box<dyn TechniqueState>,
    aovs: Option<AovPass>,
    film: Buffer,
    layers: Buffer,
    blocks: Blocks,
    tally: Buffer,
    recorder: Option<Recorder>,
    plan: FramePlan,
    /// What came before the frames; those are counted.
    seconds: Seconds,
    counted: Counted,
    /// One of the `CAMERA_*` constants.
    camera_kind: u32,
}

impl Renderer {
    /// Uploads the scene and makes the kernels. Fails before that where the device has no room.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Self> {
        Self::watched(gpu, scene, settings, &|_| {})
    }

    /// Uploads the scene and makes the kernels; `watch` is told how far it is.
    pub fn watched(gpu: &Gpu, scene: &Scene, settings: &Settings, watch: Watch) -> Result<Self> {
        settings.check(gpu, scene)?;
        settings.technique.row.state().check(gpu, settings)?;
        memory::check(gpu, scene, settings)?;
        Self::build(gpu, scene, settings, watch).map_err(|error| memory::advise(gpu, scene, settings, error))
    }

    fn build(gpu: &Gpu, scene: &Scene, settings: &Settings, watch: Watch) -> Result<Self> {
        let taking_part: Vec<&Pass> = settings.technique.passes().collect();
        let started = Instant::now();
        let device_scene = Arc::new(DeviceScene::new(gpu, scene, settings, watch)?);
        let build = started.elapsed().as_secs_f64();
        let started = Instant::now();
        let names = kernel::module_names(settings);
        let kernels = while_compiling(watch, || Kernel::several(gpu, scene, settings, &names, &device_scene))?;
        let passes: Vec<_> = taking_part.iter().map(|pass| **pass).zip(kernels).collect();
        let stages = stages(taking_part.into_iter());
        let context = Context {
            gpu,
            scene,
            settings,
            order: device_scene.order(),
            instance_order: device_scene.instance_order(),
        };
        let state = settings.technique.row.state().make(&context)?;
        let aovs = settings.aovs.map(|own| AovPass::new(gpu, scene, settings, &device_scene, own)).transpose()?;
        let pixels = settings.pixels();
        let mut renderer = Self {
            gpu: gpu.clone(),
            settings: settings.clone(),
            film: Buffer::zeroed(gpu, "film", pixels * size_of::<FilmPixel>() as u64)?,
            layers: Buffer::zeroed(
                gpu,
                "film by path length",
                pixels * u64::from(settings.layers()) * LAYER_PIXEL_BYTES,
            )?,
            blocks: Blocks::new(gpu, settings)?,
            tally: Buffer::zeroed(gpu, "tally", TALLY_BYTES)?,
            recorder: (settings.records > 0).then(|| Recorder::new(gpu, settings.records)).transpose()?,
            plan: FramePlan::new(
                settings.width,
                settings.height,
                stages.last().map_or(1, |last| last + 1),
                gpu.limits().max_workgroups.saturating_mul(WORKGROUP).max(WORKGROUP),
                state.limits(),
            )
            .starting_at(settings.shard.map_or(0, Shard::first)),
            stages,
            seconds: Seconds { build, ..Seconds::default() },
            passes,
            state,
            aovs,
            counted: Counted::default(),
            camera_kind: settings.image_plane(scene)?.kind,
        };
        while_compiling(watch, || {
            if let Some(aovs) = &renderer.aovs {
                aovs.dispatch(gpu, Frame::NOTHING, renderer.constants(Frame::NOTHING))?;
            }
            renderer.dispatch(Frame::NOTHING, true)
        })?;
        renderer.seconds.compile = started.elapsed().as_secs_f64();
        spent::compiled(renderer.seconds.compile);
        renderer.finish_trials(&context, watch)?;
        Ok(renderer)
    }

    /// Runs one frame towards `target` samples per pixel; returns false once they are all taken.
    pub fn advance(&mut self, target: u32) -> Result<bool> {
        let Some(frame) = self.plan.next(target) else { return Ok(false) };
        if self.run_job(frame.first_sample)? {
            return Ok(true);
        }
        let ends_block = self.plan.ends_block(frame);
        if ends_block {
            self.prepare_blocks()?;
        }
        let started = Instant::now();
        let device = self.dispatch(frame, self.plan.ends_stages(frame))?;
        self.blocks.any |= ends_block;
        let wall = started.elapsed();
        self.plan.done(frame, wall);
        spent::rendered(wall.as_secs_f64(), u64::from(frame.slots) * u64::from(frame.samples));
        self.took(wall, device);
        Ok(self.plan.next(target).is_some())
    }

    /// Has kernels record the paths of a sample from now on; what they recorded before is gone. For settings with room for records.
    pub fn want_records(&mut self, wanted: &Wanted) -> Result<()> {
        self.recorder.as_ref().map_or(Ok(()), |recorder| recorder.want(wanted))
    }

    /// What kernels have recorded since they were told to, each path's records in their order, and how many there was no room for.
    pub fn records(&self) -> Result<(Vec<PathRecord>, u32)> {
        self.recorder.as_ref().map_or(Ok((Vec::new(), 0)), Recorder::read)
    }

    /// Takes some samples of one pixel, and of its neighbours in the same workgroup, where those before them need not have been taken:
    /// for techniques that begin all subpaths at the camera. What they add to the film is of no use.
    pub fn sample_pixel(&mut self, x: u32, y: u32, first_sample: u32, samples: u32) -> Result<()> {
        let across = self.settings.width.div_ceil(8);
        let slot = (y / 8 * across + x / 8) * 64 + y % 8 * 8 + x % 8;
        let first_slot = slot / WORKGROUP * WORKGROUP;
        let frame = Frame { first_slot, slots: WORKGROUP, first_sample, samples, ..Frame::NOTHING };
        self.dispatch(frame, true).map(drop)
    }

    /// The factor on the sums of the film that makes an image of them; 1 but for techniques that learn the image's brightness apart.
    pub fn film_factor(&self) -> Result<f64> {
        Ok(self.state.film_scale()?.map_or(1.0, |scale| scale.factor))
    }

    fn took(&mut self, wall: Duration, device: Duration) {
        self.counted.seconds[0] += wall.as_secs_f64();
        self.counted.seconds[1] += device.as_secs_f64();
    }

    /// Makes what so many samples per pixel will need beyond the first few, so that it is not made while they are taken.
    pub fn prepare(&mut self, spp: u32) -> Result<()> {
        if spp >= BLOCK_SAMPLES { self.prepare_blocks() } else { Ok(()) }
    }

    /// Makes the kernel that ends blocks, and has CPU devices compile it.
    fn prepare_blocks(&mut self) -> Result<()> {
        if self.blocks.kernel().is_some() {
            return Ok(());
        }
        let started = Instant::now();
        self.blocks.prepare(&self.gpu, &self.settings, &self.passes[0].1)?;
        self.submit("nothing", self.constants(Frame::NOTHING), &[], Some(0))?;
        let took = started.elapsed().as_secs_f64();
        self.seconds.compile += took;
        spent::compiled(took);
        Ok(())
    }

    /// Tells how many seconds of rendering there will be, where time is what ends it: what goes before the first sample takes the more
    /// time the more there is, and no more than a quarter of it.
    pub fn set_time_budget(&mut self, seconds: f64) {
        self.state.set_time_budget(Duration::try_from_secs_f64(seconds * START_SHARE).unwrap_or(Duration::MAX));
    }

    /// Forgets all samples and begins again with another seed; kernels and scene stay.
    pub fn restart(&mut self, seed: u32) -> Result<()> {
        self.settings.seed = seed;
        self.film.clear()?;
        self.layers.clear()?;
        self.blocks.clear()?;
        self.state.restart(self.settings.random_seed())?;
        self.plan = self.plan.restarted();
        self.counted = Counted::default();
        Ok(())
    }

    /// Looks through a camera that stands or looks elsewhere and begins again: that of `scene`, which is the scene that it was made for but
    /// for its cameras. Kernels know the camera's kind (pinhole, lens, parallel rays), so that must be the same.
    pub fn look(&mut self, scene: &Scene) -> Result<()> {
        let plane = self.settings.image_plane(scene)?;
        if plane.kind != self.camera_kind {
            return Err(Error::Usage(String::from(
                "a camera of another kind (pinhole, lens, parallel rays) than the one that the kernels were made for",
            )));
        }
        camera_uniforms::change(&self.scene().uniforms, scene, &plane)?;
        self.restart(self.settings.seed)
    }

    /// Says where the samples stand among those of several renderings, for techniques whose blur shrinks with them.
    pub fn set_merge_schedule(&mut self, schedule: MergeSchedule) {
        self.state.set_merge_schedule(schedule);
    }

    /// Bounds the pixel samples of each stage of a frame, whatever the device's speed would allow: frames are cut where it says, and
    /// that changes no bit of the film.
    pub fn bound_frames(&mut self, most: u64) {
        self.plan.bound(most);
    }

    /// Saves all that samples to come and the film depend on to `to`, which messages call `file`. It may be under way in any frame.
    pub fn save(&mut self, file: &Path, to: &mut dyn Write) -> Result<()> {
        self.exchange(&mut StateStream::saving(file, to))
    }

    /// Restores what [`Renderer::save`] wrote: what goes on from there has the bits of what was never interrupted. A renderer that failed
    /// to restore a state is of no further use.
    pub fn restore(&mut self, file: &Path, from: &mut dyn Read) -> Result<()> {
        self.exchange(&mut StateStream::restoring(file, from))
    }

    fn exchange(&mut self, stream: &mut StateStream) -> Result<()> {
        self.plan.exchange(stream)?;
        let (any, counted) = (&mut self.blocks.any, &mut self.counted);
        let planes: Vec<&dyn Store> = self.blocks.planes.iter().map(|plane| plane as &dyn Store).collect();
        sums::exchange(stream, [&self.film, &self.layers], &planes, any, counted)?;
        self.state.exchange(stream, !self.plan.is_between_passes())
    }

    /// What the technique has to say of the rendering besides the image.
    pub fn report(&self) -> Result<Option<StateReport>> {
        self.state.report()
    }

    /// The technique's state, which must be of this type.
    pub fn state<T: TechniqueState>(&self) -> Result<&T> {
        let state: &dyn Any = self.state.as_ref();
        let name = self.settings.technique.row.name;
        let asked = std::any::type_name::<T>().rsplit("::").next().unwrap_or_default();
        state.downcast_ref().ok_or_else(|| Error::Usage(format!("the state of {name} is not that of {asked}")))
    }

    /// Makes the kernel anew, so that its code comes to lie elsewhere in memory. On a CPU device that alone can decide its speed:
    /// of kernels with the same bytes, one in twenty ran up to 1.7 times slower than the others, for as long as it lived
    /// (docs/lavapipe.md). Whoever compares speeds does this before each run, which makes it noise of that run.
    pub fn remake_kernel(&mut self) -> Result<()> {
        for (_, kernel) in &mut self.passes {
            kernel.remake(&self.gpu)?;
        }
        self.dispatch(Frame::NOTHING, true).map(drop)
    }

    /// Samples that every pixel has.
    pub fn spp(&self) -> u32 {
        self.plan.spp()
    }

    /// Whether every pixel has a sample: what lacks some is of no use to anyone, however little time there was.
    pub fn has_image(&self) -> bool {
        self.spp() > 0
    }

    /// How much there is of what goes before the first sample, 0 to 1, where that is something to wait for: bootstrap samples of
    /// chains.
    pub fn start(&self) -> f64 {
        self.state.start()
    }

    /// Samples that the average pixel has, the unfinished pass included.
    pub fn progress(&self) -> f64 {
        self.plan.progress()
    }

    /// What the parts took so far.
    pub fn seconds(&self) -> Seconds {
        let [render, device] = self.counted.seconds;
        Seconds { render, device, ..self.seconds }
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        self.counted.rays
    }

    /// How much of the module of each pass is left for the scene, in their order.
    pub fn kernel_sizes(&self) -> Vec<KernelSize> {
        self.passes.iter().map(|(_, kernel)| kernel.size()).collect()
    }

    /// The scene on the device.
    pub fn scene(&self) -> &DeviceScene {
        &self.passes[0].1.scene
    }

    /// What it renders with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What must be known to read its film from a checkpoint.
    pub fn shape(&self) -> FilmShape {
        FilmShape::of(&self.settings, self.scene().splat_unit)
    }

    /// What the film is multiplied by; nothing where it is right as it is.
    pub fn film_scale(&self) -> Result<Option<FilmScale>> {
        self.state.film_scale()
    }

    /// The film as it stands.
    pub fn film(&self) -> Result<Film> {
        let pixels = self.settings.pixels() as usize;
        let sums = FilmSums {
            pixels: self.film.read(pixels)?,
            layers: self.layers.read(2 * pixels * self.settings.layers() as usize)?,
            blocks: self.blocks.read(pixels)?,
        };
        let mut film = sums.film(&self.shape(), self.plan.counts());
        if let Some(scale) = self.state.film_scale()? {
            film.brightness = Some(scale.brightness);
            film.scale(scale.factor);
        }
        film.nonfinite = self.counted.nonfinite;
        film.bad_samples.clone_from(&self.counted.bad_samples);
        Ok(film)
    }

    /// The AOVs, from as many samples as each pixel has by now, 1 at least and [`aovs::MOST_SAMPLES`] at most; nothing where the settings ask
    /// for none.
    pub fn aovs(&self) -> Result<Option<AovFilm>> {
        self.aovs_of(self.spp())
    }

    /// The same from so many samples, for whoever does not want to wait.
    pub fn aovs_of(&self, samples: u32) -> Result<Option<AovFilm>> {
        let Some(pass) = &self.aovs else { return Ok(None) };
        pass.render(&self.gpu, &self.settings, samples, |frame| self.constants(frame)).map(Some)
    }
}

/// Renders a scene to the number of samples per pixel, in one go.
pub fn render(gpu: &Gpu, scene: &Scene, settings: &Settings, spp: u32) -> Result<Film> {
    if spp == 0 {
        return Err(Error::Usage(String::from("0 samples per pixel: ask for 1 or more")));
    }
    let mut renderer = Renderer::new(gpu, scene, settings)?;
    while renderer.advance(spp)? {}
    renderer.film()
}
