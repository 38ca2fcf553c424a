//! Rendering: upload, specialise, iterate, film.
//!
//! A [`Renderer`] is one scene, technique and backend on one device. Each [`Renderer::advance`] is one frame: a
//! submission of about a tenth of a second, so that drivers' watchdogs never fire, progress is smooth, and an interrupt
//! is answered at once.

pub mod aovs;
mod camera_uniforms;
mod device_scene;
pub mod film;
mod frames;
mod kernel;
mod memory;
mod probe;
mod spent;
mod target;
mod watch;

use std::any::Any;
use std::io::{Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use aovs::{AovFilm, AovPass};
pub use memory::{Part, Prediction};
pub use probe::Probe;
pub use spent::{Spent, spent};

use crate::error::{Error, Result};
use crate::gpu::{Buffer, Gpu};
use crate::layout::{BAD_SAMPLES, FilmPixel, FrameConstants, RAY_COUNTERS, WORKGROUP, address};
use crate::render::film::{BadSample, Film, StrategyLayers};
use crate::scene::Scene;
use crate::techniques::{
    Context, Correlated, MergeSchedule, Over, Pass, Sampler, StateReport, StateStream, TechniqueState, Trial, nothing,
    stages,
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

/// A pass over a run of what it runs over.
struct Run {
    /// Its index.
    pass: usize,
    first: u32,
    count: u32,
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
    tally: Buffer,
    plan: FramePlan,
    seconds: Seconds,
    rays: u64,
    nonfinite: u64,
    bad_samples: Vec<BadSample>,
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
            tally: Buffer::zeroed(gpu, "tally", TALLY_BYTES)?,
            plan: FramePlan::new(
                settings.width,
                settings.height,
                stages.last().map_or(1, |last| last + 1),
                gpu.limits().max_workgroups.saturating_mul(WORKGROUP).max(WORKGROUP),
                state.limits(),
            ),
            stages,
            seconds: Seconds { build, ..Seconds::default() },
            passes,
            state,
            aovs,
            rays: 0,
            nonfinite: 0,
            bad_samples: Vec::new(),
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
        let started = Instant::now();
        let device = self.dispatch(frame, self.plan.ends_stages(frame))?;
        let wall = started.elapsed();
        self.plan.done(frame, wall);
        spent::rendered(wall.as_secs_f64(), u64::from(frame.slots) * u64::from(frame.samples));
        self.seconds.render += wall.as_secs_f64();
        self.seconds.device += device.as_secs_f64();
        Ok(self.plan.next(target).is_some())
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
        self.state.restart(seed)?;
        self.plan = self.plan.restarted();
        (self.seconds.render, self.seconds.device) = (0.0, 0.0);
        (self.rays, self.nonfinite) = (0, 0);
        self.bad_samples.clear();
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
        stream.buffer(&self.film)?;
        stream.buffer(&self.layers)?;
        self.state.exchange(stream, !self.plan.is_between_passes())?;
        stream.long(&mut self.rays)?;
        stream.long(&mut self.nonfinite)?;
        let mut count = self.bad_samples.len() as u32;
        stream.numbers([&mut count])?;
        stream.check(count <= BAD_SAMPLES, || format!("{count} bad samples: valid are 0 to {BAD_SAMPLES}"))?;
        self.bad_samples.resize(count as usize, BadSample { x: 0, y: 0, sample: 0 });
        for bad in &mut self.bad_samples {
            stream.numbers([&mut bad.x, &mut bad.y, &mut bad.sample])?;
        }
        stream.reals([&mut self.seconds.render, &mut self.seconds.device])
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
        self.seconds
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        self.rays
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

    /// The film as it stands.
    pub fn film(&self) -> Result<Film> {
        let (width, height) = (self.settings.width, self.settings.height);
        let pixels = width as usize * height as usize;
        let sums: Vec<FilmPixel> = self.film.read(pixels)?;
        let layer_count = self.settings.layers() as usize;
        let layers: Vec<[f32; 3]> = self.layers.read(2 * pixels * layer_count)?;
        let has_halves = self.settings.sampler == Sampler::Sobol;
        let mut film = Film::from_device(width, height, self.plan.counts(), &sums, &layers, layer_count, has_halves);
        if self.settings.technique.row.correlated != Correlated::Nothing {
            film.pixels_are_correlated();
        }
        if let Some(strategies) = self.settings.strategies {
            let mut layers = std::mem::take(&mut film.lengths).into_iter();
            for strategy in strategies.all() {
                let mut next = || layers.next().unwrap_or_default();
                film.strategies.push(StrategyLayers { strategy, unweighted: next(), weighted: next() });
            }
        }
        if let Some(scale) = self.state.film_scale()? {
            film.brightness = Some(scale.brightness);
            film.scale(scale.factor);
        }
        film.nonfinite = self.nonfinite;
        film.bad_samples.clone_from(&self.bad_samples);
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

    /// What all passes of a frame are given.
    fn constants(&self, frame: Frame) -> FrameConstants {
        FrameConstants {
            film: address(self.film.address()),
            layers: address(self.layers.address()),
            tally: address(self.tally.address()),
            technique: address(self.state.table()),
            first_slot: frame.first_slot,
            slot_count: frame.slots,
            first_sample: frame.first_sample,
            sample_count: frame.samples,
            seed: self.settings.seed,
            word: self.state.word(frame.first_sample),
        }
    }

    /// Runs stages for a part of the image, and where that ends them what runs over all there is; takes in what was counted. The
    /// time is the device's.
    fn dispatch(&mut self, frame: Frame, ends_stages: bool) -> Result<Duration> {
        let Frame { first_slot, slots, first_sample, samples, .. } = frame;
        let work =
            format!("{slots} pixels from slot {first_slot}, samples {first_sample} to {}", first_sample + samples);
        // A frame of nothing makes CPU devices compile.
        let whole = |count: u32| (0, if samples > 0 { count } else { 0 });
        let all = self.settings.slots() as u32;
        let mut runs = Vec::new();
        for (index, ((pass, _), stage)) in self.passes.iter().zip(&self.stages).enumerate() {
            if !frame.has_stage(*stage) || !(ends_stages || pass.over == Over::Pixels) {
                continue;
            }
            let (first, count) = match pass.over {
                Over::Pixels => (first_slot, slots),
                Over::Image => whole(all),
                Over::Elements => whole(self.state.elements(pass)),
                Over::Jobs if samples > 0 => continue, // they have submissions of their own
                Over::Jobs => (0, 0),
            };
            runs.push(Run { pass: index, first, count });
        }
        self.submit(&work, self.constants(frame), &runs)
    }

    /// Runs one job of the technique's state, if the sample of that index needs any before it.
    fn run_job(&mut self, sample: u32) -> Result<bool> {
        let Some(job) = self.state.next_job(sample, self.plan.bound_of_frames()) else { return Ok(false) };
        let Some(pass) = self.passes.iter().position(|(pass, _)| *pass == job.pass) else {
            return Err(Error::Device(format!(
                "{}: its state asks for the pass '{}', which is not among the kernels of this rendering",
                self.settings.technique.describe(),
                job.pass.name
            )));
        };
        let started = Instant::now();
        let constants = FrameConstants { sample_count: job.samples, word: job.word, ..self.constants(Frame::NOTHING) };
        let device = self.submit(&job.about, constants, &[Run { pass, first: job.first, count: job.count }])?;
        self.state.job_done(&job, started.elapsed())?;
        // What the state makes of a job on the host is part of the rendering as well.
        let wall = started.elapsed().as_secs_f64();
        spent::rendered(wall, 0);
        self.seconds.render += wall;
        self.seconds.device += device.as_secs_f64();
        Ok(true)
    }

    /// Runs trials for as long as the state is one: what they took counts as building.
    fn finish_trials(&mut self, context: &Context, watch: Watch) -> Result<()> {
        let Some(trial) = self.state.trial() else { return Ok(()) };
        let started = Instant::now();
        watch(Building { doing: trial.doing(), share: Some(0.0) });
        while self.state.trial().is_some() {
            while self.run_job(0)? {}
            let Some(make) = self.state.trial().map(Trial::next).transpose()? else { break };
            self.state = nothing(); // before there are two
            self.state = make(context)?;
        }
        (self.rays, self.nonfinite) = (0, 0);
        self.bad_samples.clear();
        self.seconds.build += started.elapsed().as_secs_f64();
        (self.seconds.render, self.seconds.device) = (0.0, 0.0);
        Ok(())
    }

    /// Dispatches passes one after the other in one submission, which `work` describes, and takes in what was counted.
    fn submit(&mut self, work: &str, constants: FrameConstants, runs: &[Run]) -> Result<Duration> {
        let name = format!("{} on {}", self.settings.technique.row.name, self.settings.backend.name());
        let (passes, tally, room) = (&self.passes, &self.tally, self.plan.most_slots());
        let took = self.gpu.run(&name, work, |commands| {
            commands.clear(tally);
            for Run { pass, first, count } in runs {
                let kernel = &passes[*pass].1;
                let mut start = *first;
                loop {
                    let part = (first + count - start).min(room);
                    let constants = FrameConstants { first_slot: start, slot_count: part, ..constants };
                    let workgroups = part.div_ceil(WORKGROUP).max(1);
                    commands.dispatch(&kernel.pipeline, &kernel.bindings, bytemuck::bytes_of(&constants), workgroups);
                    start += part;
                    if start >= first + count {
                        break;
                    }
                }
                commands.barrier();
            }
        })?;
        self.take_in_tally()?;
        Ok(took.device)
    }

    /// Takes in what a submission has counted.
    fn take_in_tally(&mut self) -> Result<()> {
        let counted: Vec<u32> = self.tally.read((1 + 2 * BAD_SAMPLES + RAY_COUNTERS) as usize)?;
        let (bad, rays) = counted.split_at((1 + 2 * BAD_SAMPLES) as usize);
        self.rays += rays.iter().map(|count| u64::from(*count)).sum::<u64>();
        self.nonfinite += u64::from(bad[0]);
        let room = (BAD_SAMPLES as usize).saturating_sub(self.bad_samples.len());
        let listed = bad[1..].chunks_exact(2).take((bad[0] as usize).min(BAD_SAMPLES as usize));
        let mut located: Vec<BadSample> = listed
            .map(|entry| BadSample {
                x: entry[0] % self.settings.width,
                y: entry[0] / self.settings.width,
                sample: entry[1],
            })
            .collect();
        located.sort_unstable();
        self.bad_samples.extend(located.into_iter().take(room));
        Ok(())
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
