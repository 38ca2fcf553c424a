//! Rendering: upload, specialise, iterate, film.
//!
//! A [`Renderer`] is one scene, technique and backend on one device. Each [`Renderer::advance`] is one frame: a
//! submission of about a tenth of a second, so that drivers' watchdogs never fire, progress is smooth, and an interrupt
//! is answered at once.

mod chains;
pub mod film;
mod frames;
mod kernel;
mod memory;
mod merge_radius;
mod patch_frames;
mod patch_report;
mod probe;
mod radiosity;
mod scratch;
mod spent;
mod state;
mod target;
mod upload;
mod watch;

use std::collections::HashSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

pub use crate::techniques::{Settings, Technique};
pub use memory::{Part, Prediction};
pub use patch_report::PatchReport;
pub use probe::Probe;
pub use spent::{Spent, spent};

use crate::error::{Error, Result};
use crate::gpu::{Buffer, Gpu};
use crate::layout::{BAD_SAMPLES, Chain, FilmPixel, FrameConstants, RAY_COUNTERS, WORKGROUP, address};
use crate::render::film::{BadSample, Film, StrategyLayers};
use crate::scene::Scene;
use crate::scene::patches::Quartered;
use crate::techniques::{self, Kept, Over, Pass};
use chains::Chains;
use frames::{Frame, FramePlan};
use kernel::Kernel;
pub use kernel::{Constants, KernelSize, kernel_sizes, modules_of};
use memory::{LAYER_PIXEL_BYTES, TALLY_BYTES};
use merge_radius::MergeRadius;
pub use merge_radius::MergeSchedule;
use radiosity::Radiosity;
use scratch::Scratch;
pub use state::State;
pub use target::ErrorTarget;
pub use upload::Uploaded;
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
    merge_radius: MergeRadius,
    scratch: Scratch,
    /// Where the technique has some.
    chains: Option<Chains>,
    radiosity: Option<Radiosity>,
    film: Buffer,
    layers: Buffer,
    tally: Buffer,
    plan: FramePlan,
    seconds: Seconds,
    rays: u64,
    nonfinite: u64,
    bad_samples: Vec<BadSample>,
}

impl Renderer {
    /// Uploads the scene and makes the kernels. Fails before that where the device has no room.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Self> {
        Self::watched(gpu, scene, settings, &|_| {})
    }

    /// The same; `watch` is told how far it is.
    pub fn watched(gpu: &Gpu, scene: &Scene, settings: &Settings, watch: Watch) -> Result<Self> {
        settings.check(gpu, scene)?;
        memory::check(gpu, scene, settings)?;
        Self::build(gpu, scene, settings, watch).map_err(|error| memory::advise(gpu, scene, settings, error))
    }

    fn build(gpu: &Gpu, scene: &Scene, settings: &Settings, watch: Watch) -> Result<Self> {
        let row = settings.technique.row;
        let taking_part: Vec<&Pass> = settings.technique.passes().collect();
        let started = Instant::now();
        let uploaded = Arc::new(Uploaded::new(gpu, scene, settings, watch)?);
        let build = started.elapsed().as_secs_f64();
        let started = Instant::now();
        let names = kernel::module_names(settings);
        let kernels = while_compiling(watch, || Kernel::several(gpu, scene, settings, &names, &uploaded))?;
        let passes: Vec<_> = taking_part.iter().map(|pass| **pass).zip(kernels).collect();
        let scratch = Scratch::new(gpu, settings)?;
        let stages = techniques::stages(taking_part.into_iter());
        let radiosity = match row.kept {
            Kept::Patches => {
                let quartered = Quartered::These(HashSet::new());
                Some(Radiosity::new(gpu, scene, &passes[0].1.scene, settings, &quartered)?)
            }
            _ => None,
        };
        let pixels = u64::from(settings.width) * u64::from(settings.height);
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
                scratch.size.room(gpu.limits().max_workgroups),
            ),
            stages,
            merge_radius: MergeRadius::of(&settings.technique, scene, scratch.size.light_paths),
            seconds: Seconds { build, ..Seconds::default() },
            passes,
            scratch,
            chains: Chains::new(gpu, settings)?,
            radiosity,
            rays: 0,
            nonfinite: 0,
            bad_samples: Vec::new(),
        };
        while_compiling(watch, || renderer.dispatch(Frame::NOTHING, true))?;
        renderer.seconds.compile = started.elapsed().as_secs_f64();
        spent::compiled(renderer.seconds.compile);
        renderer.quarter_patches(scene, watch)?;
        Ok(renderer)
    }

    /// Runs one frame towards `target` samples per pixel; returns false once they are all taken.
    pub fn advance(&mut self, target: u32) -> Result<bool> {
        let Some(frame) = self.plan.next(target) else { return Ok(false) };
        if let Some((first, count)) = self.chains.as_ref().and_then(Chains::missing) {
            self.make_candidates(first, count)?;
            return Ok(true);
        }
        if self.pass_light_on(frame.first_sample)? {
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
    pub fn expect(&mut self, seconds: f64) {
        if let Some(chains) = &mut self.chains {
            chains.limit(Duration::try_from_secs_f64(seconds * START_SHARE).unwrap_or(Duration::MAX));
        }
    }

    /// Forgets all samples and begins again with another seed; kernels and scene stay.
    pub fn restart(&mut self, seed: u32) -> Result<()> {
        self.settings.seed = seed;
        self.film.clear()?;
        self.layers.clear()?;
        self.scratch.splats.clear()?;
        self.chains.as_mut().map_or(Ok(()), |chains| chains.restart(seed))?;
        if let Some(radiosity) = &mut self.radiosity {
            radiosity.restart()?;
        }
        self.plan = self.plan.restarted();
        (self.seconds.render, self.seconds.device) = (0.0, 0.0);
        (self.rays, self.nonfinite) = (0, 0);
        self.bad_samples.clear();
        Ok(())
    }

    /// Says where the samples stand among those of several renderings, for techniques whose blur shrinks with them.
    pub fn set_merge_schedule(&mut self, schedule: MergeSchedule) {
        self.merge_radius.schedule = schedule;
    }

    /// Bounds the pixel samples of each stage of a frame, whatever the device's speed would allow: frames are cut where it says, and
    /// that changes no bit of the film.
    pub fn bound_frames(&mut self, most: u64) {
        self.plan.bound(most);
    }

    /// Writes down, or takes up again, all that samples to come and the film depend on: what goes on from there has the bits of what
    /// was never interrupted. It may be under way in any frame. A renderer that failed to take up a state is of no further use.
    pub fn transfer(&mut self, state: &mut State) -> Result<()> {
        self.plan.transfer(state)?;
        state.buffer(&self.film)?;
        state.buffer(&self.layers)?;
        // Between passes it holds nothing: splats are zero, and light paths are made anew.
        if !self.plan.is_between_passes() {
            self.scratch.transfer(state)?;
        } else if state.restores() {
            self.scratch.splats.clear()?;
        }
        if let Some(chains) = &mut self.chains {
            chains.transfer(state)?;
        }
        if let Some(radiosity) = &mut self.radiosity {
            radiosity.transfer(state)?;
        }
        state.long(&mut self.rays)?;
        state.long(&mut self.nonfinite)?;
        let mut count = self.bad_samples.len() as u32;
        state.numbers([&mut count])?;
        state.check(count <= BAD_SAMPLES, "a number of bad samples")?;
        self.bad_samples.resize(count as usize, BadSample { x: 0, y: 0, sample: 0 });
        for bad in &mut self.bad_samples {
            state.numbers([&mut bad.x, &mut bad.y, &mut bad.sample])?;
        }
        state.reals([&mut self.seconds.render, &mut self.seconds.device])
    }

    /// What the patches came to, where there are any.
    pub fn patches(&self) -> Result<Option<PatchReport>> {
        self.radiosity.as_ref().map(Radiosity::report).transpose()
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

    /// How much there is of what goes before the first sample, 0 to 1, where that is something to wait for: candidates of chains.
    pub fn start(&self) -> f64 {
        self.chains.as_ref().map_or(1.0, Chains::progress)
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

    /// What was uploaded.
    pub fn scene(&self) -> &Uploaded {
        &self.passes[0].1.scene
    }

    /// Where the Markov chains are, where the technique has some.
    pub fn chains(&self) -> Result<Vec<Chain>> {
        self.chains.as_ref().map_or(Ok(Vec::new()), Chains::states)
    }

    /// The bound of their target, in the unit of [`Chain::brings`]; infinite before there are any, 0 where the technique has none.
    pub fn chain_bound(&self) -> f64 {
        self.chains.as_ref().map_or(0.0, Chains::bound)
    }

    /// The probability that a large step of these is of each kind.
    pub fn kind_shares(&self) -> Vec<f64> {
        self.chains.as_ref().map_or(Vec::new(), Chains::shares)
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
        let mut film = Film::from_device(width, height, self.plan.counts(), &sums, &layers, layer_count);
        if let Some(strategies) = self.settings.strategies {
            let mut layers = std::mem::take(&mut film.lengths).into_iter();
            for strategy in strategies.all() {
                let mut next = || layers.next().unwrap_or_default();
                film.strategies.push(StrategyLayers { strategy, unweighted: next(), weighted: next() });
            }
        }
        if let Some(chains) = &self.chains {
            film.brightness = chains.brightness()?;
            film.scale(chains.correction(film.brightness));
        }
        film.nonfinite = self.nonfinite;
        film.bad_samples.clone_from(&self.bad_samples);
        Ok(film)
    }

    /// What all passes of a frame are given.
    fn constants(&self, frame: Frame) -> FrameConstants {
        FrameConstants {
            film: address(self.film.address()),
            lengths: address(self.layers.address()),
            tally: address(self.tally.address()),
            splats: address(self.scratch.splats.address()),
            light_paths: address(self.scratch.light_paths.address()),
            light_vertices: self.scratch.size.vertices,
            light_path_count: self.scratch.size.light_paths,
            grid_cells: address(self.scratch.grid_cells.address()),
            grid_places: address(self.scratch.grid_places.address()),
            grid_cell_count: self.scratch.size.cells,
            merge_radius: self.merge_radius.at(frame.first_sample),
            chains: address(self.chains.as_ref().map_or(0, Chains::address)),
            first_slot: frame.first_slot,
            slot_count: frame.slots,
            first_sample: frame.first_sample,
            sample_count: frame.samples,
            width: self.settings.width,
            height: self.settings.height,
            seed: self.settings.seed,
            patches: self.radiosity.as_ref().map_or([0; 2], |radiosity| address(radiosity.address())),
            round: self.radiosity.as_ref().map_or(0, Radiosity::shown_round),
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
        let (all, size) = (frames::slots(self.settings.width, self.settings.height) as u32, self.scratch.size);
        let mut runs = Vec::new();
        for (index, ((Pass { over, .. }, _), stage)) in self.passes.iter().zip(&self.stages).enumerate() {
            if !frame.has_stage(*stage) || !(ends_stages || *over == Over::Pixels) {
                continue;
            }
            let (first, count) = match over {
                Over::Pixels => (first_slot, slots),
                Over::Image => whole(all),
                Over::LightVertices => whole(size.places()),
                Over::Cells => whole(size.cells),
                Over::Patches | Over::PatchVertices if samples > 0 => continue, // they have frames of their own
                Over::Patches | Over::PatchVertices => (0, 0),
            };
            runs.push(Run { pass: index, first, count });
        }
        self.submit(&work, self.constants(frame), &runs)
    }

    /// Makes candidates for chains to begin with.
    fn make_candidates(&mut self, first: u32, count: u32) -> Result<()> {
        let started = Instant::now();
        let runs = [Run { pass: 0, first, count }];
        let work = format!("{count} candidates from {first}");
        let device = self.submit(&work, self.constants(Frame::NOTHING), &runs)?;
        let took = started.elapsed();
        self.chains.as_mut().map_or(Ok(()), |chains| chains.made(count, took))?;
        spent::rendered(started.elapsed().as_secs_f64(), 0);
        self.seconds.render += started.elapsed().as_secs_f64();
        self.seconds.device += device.as_secs_f64();
        Ok(())
    }

    /// Dispatches passes one after the other in one submission, which `work` describes, and takes in what was counted.
    fn submit(&mut self, work: &str, constants: FrameConstants, runs: &[Run]) -> Result<Duration> {
        let name = format!("{} on {}", self.settings.technique.row.name, self.settings.backend.name());
        let (passes, tally, room) = (&self.passes, &self.tally, self.plan.room().slots);
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
