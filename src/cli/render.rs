//! `lumbre render`.

pub(super) mod about;
mod args;
mod denoise;
mod extras;
mod fireflies;
mod job;
mod keep;
mod layers;
mod outputs;
mod progress;
mod pyramid;
mod record;
pub(super) mod report;
mod settle;
mod tev;
mod warnings;
mod write;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use lumbre::error::Result;
use lumbre::gpu::compile_quickly;
use lumbre::render::{ErrorTarget, Renderer};

use super::args::DeviceArgs;
use super::interrupt::listen_for_interrupts;
use super::output::{print_warnings, say, takes_standard_output, write_json};
use about::About;
pub(super) use args::RenderArgs;
use extras::Extras;
use fireflies::Fireflies;
use job::Job;
use keep::CheckpointWriter;
pub(super) use layers::names as layer_names;
use progress::{BuildProgress, Progress};
use tev::Viewer;

/// Pixel samples up to which a CPU driver is not to optimise kernels: that takes longer than what it saves.
const QUICK_SAMPLES: u64 = 1 << 17;

pub(super) fn run(args: &RenderArgs) -> Result<()> {
    let started = Instant::now();
    let interrupted = listen_for_interrupts();
    // What is wrong with the command itself is said before any work.
    args.settings.overrides().check()?;
    let layers = layers::parse(&args.aov)?;
    let outputs = outputs::outputs(args)?;

    let scene = args.scene.load()?;
    let load = started.elapsed().as_secs_f64();
    if !args.quiet {
        print_warnings(&scene);
    }
    let camera = scene.camera(args.settings.camera.as_deref())?;
    if args.expected_samples(&scene, camera) <= QUICK_SAMPLES {
        compile_quickly();
    }
    let gpu = args.device.open()?;
    let (mut settings, mut job) = settle::settle(args, &scene, &gpu, outputs)?;
    let extras = Extras::settle(args, layers, &scene, &job.outputs, &mut settings)?;
    if !args.quiet {
        warnings::say_all(&scene, camera, &settings, args.error.is_some());
    }
    let checkpoint = args.checkpoint.as_deref();
    let parts = (&scene, &mut settings, &gpu);
    let mut keeper = CheckpointWriter::new(checkpoint, args.checkpoint_interval, args.resume, args.quiet, parts)?;

    gpu.reset_peak();
    let building = BuildProgress::new(args.quiet);
    let built = Renderer::watched(&gpu, &scene, &settings, &|share| building.update(share));
    building.finish();
    let mut renderer = built?;
    renderer.prepare(job.spp).map_err(|error| keeper.explain(error))?;
    let about = About::new(&scene, &gpu, &renderer);
    keeper.about(&about);
    if let Some(folder) = &args.record {
        let recorded = record::record(&gpu, &mut renderer, folder, &mut job, (&interrupted, args.quiet));
        recorded.map_err(|error| keeper.explain(error))?;
    }
    let mut progress = Progress::new(args.quiet, &job);
    let mut fireflies = Fireflies::new(args.fireflies, &mut renderer)?;
    let mut viewer = Viewer::new(args.tev.as_deref(), &scene, &settings, args.quiet);
    let target = args.error.map(ErrorTarget::new);
    let watchers = (&mut progress, &mut viewer, &mut fireflies);
    let done = iterate(&mut renderer, &job, target, &interrupted, &mut keeper, watchers);
    progress.finish();
    let (seconds, next_look) = done.map_err(|error| keeper.explain(error))?;
    // Should it fail, the image is still to be written.
    let kept = keeper.save(&mut renderer, seconds, next_look);

    let film = renderer.film().map_err(|error| keeper.explain(error))?;
    let (options, overrides) = (args.scene.options(), args.settings.overrides());
    let trace = |x: u32, y: u32, sample: u32| {
        let asks = ["--pixel", &format!("{x},{y}"), "--sample", &sample.to_string()];
        lumbre::trace::command(&args.scene.scene, &options, &overrides, renderer.settings(), &asks)
    };
    let found = fireflies.found(&renderer, trace)?;
    if fireflies.lost() > 0 && !args.quiet {
        say!(
            "warning: {} samples had no room among those that --fireflies looks at: one of them may be brighter",
            fireflies.lost()
        );
    }
    let told = (about.settings, report::Figures { rays: renderer.rays(), frames: frames(&renderer), rare: about.rare });
    let mut result = report::Report::new(told, &gpu, &renderer, &film, load, started)?.with_fireflies(found);
    let (mut picture, lost) = extras.picture(&scene, &renderer, &film, &mut result);
    if let Some(shard) = settings.shard {
        picture.header.extend(lumbre::merge::images::header(shard, keeper.identity()));
    }
    let written = write::write_outputs(&job.outputs, &film, &picture, &keeper);
    viewer.finish(&picture.image);
    written?;
    if let Some(path) = &args.json {
        write_json(path, &result)?;
    }
    if !args.quiet && !args.json.iter().chain(&job.outputs).any(|path| takes_standard_output(path)) {
        let written: Vec<&Path> = job.outputs.iter().map(PathBuf::as_path).chain(checkpoint).collect();
        report::print_summary(&result, &written, interrupted.load(Ordering::Relaxed));
    }
    kept.map_err(|error| keeper.explain(error))?;
    lost.map_or(Ok(()), |error| Err(keeper.explain(error)))?;
    DeviceArgs::report_validation(&gpu)
}

/// Seconds of all frames by the host's clock, and by the device's.
fn frames(renderer: &Renderer) -> [f64; 2] {
    let seconds = renderer.seconds();
    [seconds.render, seconds.device]
}

/// Renders until the job is done or the user ends it. Returns the seconds that were spent, those before a checkpoint included, and
/// where an error is to be looked at next.
fn iterate(
    renderer: &mut Renderer,
    job: &Job,
    mut target: Option<ErrorTarget>,
    interrupted: &AtomicBool,
    keeper: &mut CheckpointWriter,
    (progress, viewer, fireflies): (&mut Progress, &mut Viewer, &mut Fireflies),
) -> Result<(f64, Option<u32>)> {
    let rendering = Instant::now();
    let (before, next_look) = keeper.restore(renderer)?;
    let mut seconds = before;
    if let (Some(target), Some(next)) = (&mut target, next_look) {
        *target = target.at(next);
    }
    if let Some(seconds) = job.time {
        renderer.set_time_budget(seconds);
    }
    while job.time.is_none_or(|limit| seconds < limit || !renderer.has_image()) {
        renderer.advance(target.map_or(job.spp, |target| target.next().min(job.spp)))?;
        seconds = before + rendering.elapsed().as_secs_f64();
        progress.update(renderer, seconds);
        fireflies.update(renderer)?;
        viewer.offer(renderer)?;
        if renderer.spp() >= job.spp || interrupted.load(Ordering::Relaxed) {
            break;
        }
        if let Some(target) = &mut target
            && target.is_reached(renderer)?
        {
            break;
        }
        keeper.offer(renderer, seconds, target.map(|target| target.next()))?;
    }
    Ok((seconds, target.map(|target| target.next())))
}
