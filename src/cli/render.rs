//! `lumbre render`.

pub(super) mod about;
mod denoise;
mod fireflies;
mod job;
mod keep;
mod layers;
mod progress;
mod pyramid;
mod record;
pub(super) mod report;
mod tev;
mod write;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Args;

use lumbre::checkpoint::check_name;
use lumbre::denoise::Denoiser;
use lumbre::error::{Error, Result};
use lumbre::files::{STANDARD_INPUT, check_writable};
use lumbre::gpu::{Gpu, compile_quickly};
use lumbre::image::{Format, format_of};
use lumbre::render::{ErrorTarget, Renderer, Settings, Technique};
use lumbre::scene::{Camera, Scene};
use lumbre::spirv::Arithmetic;
use lumbre::techniques::{AovSettings, Correlated, LONGEST, Shard, Strategies};

use super::args::{DeviceArgs, SceneArgs, parse_positive};
use super::interrupt::listen_for_interrupts;
use super::output::{check_apart, check_json, destination, print_warnings, say, takes_standard_output, write_json};
use super::settings::SettingsArgs;
use about::About;
use fireflies::Fireflies;
use job::Job;
use keep::CheckpointWriter;
pub(super) use layers::names as layer_names;
use progress::{BuildProgress, Progress};
use tev::Viewer;

/// Samples per pixel where neither the command line nor the scene says.
const DEFAULT_SPP: u32 = 64;
/// Layers by path length where the paths have no limit.
const DEFAULT_LENGTHS: u32 = 16;

#[derive(Args)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    settings: SettingsArgs,

    /// Output: .exr (linear, 32-bit float) or .png (sRGB); may repeat. '-' is an EXR to standard output. By default both, named after the scene
    #[arg(short = 'o', long, value_name = "FILE")]
    output: Vec<PathBuf>,

    /// Samples per pixel
    #[arg(short = 'n', long, value_name = "SPP", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    spp: Option<u32>,

    /// Render for this long instead, and until each pixel has a sample
    #[arg(short = 't', long, value_name = "SECONDS", conflicts_with = "spp", value_parser = parse_positive, allow_negative_numbers = true)]
    time: Option<f64>,

    /// Stop once the estimate of the relMSE, from the variance of the samples, is no more than this; with -n or -t at the latest there
    #[arg(short = 'e', long, value_name = "RELMSE", value_parser = parse_positive, allow_negative_numbers = true)]
    error: Option<f64>,

    /// Write one EXR layer per path length, whose sum is the image; N layers, the last of which takes all longer paths
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "0", require_equals = true,
          value_parser = clap::value_parser!(u32).range(0..=64))]
    lengths: Option<u32>,

    /// Write the contribution of each strategy (s, t) of bidirectional path tracing, unweighted and weighted, for paths of up to N segments (6 at
    /// most), which is where paths end then: EXR layers, and as PNG a pyramid of them
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "6", require_equals = true, conflicts_with = "lengths",
          value_parser = clap::value_parser!(u32).range(1..=i64::from(LONGEST)))]
    strategies: Option<u32>,

    /// Further EXR layers, separated by commas: variance (of each pixel's mean), samples, or AOVs (docs/aovs.md): albedo, normal,
    /// geometric_normal, position, depth, uv, material_id, object_id, emission, or all of these. By default those that the scene asks for
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    aov: Vec<String>,

    /// Let AOVs tell what mirrors and smooth glass show, rather than these themselves
    #[arg(long)]
    aov_through_specular: bool,

    /// Name the N brightest samples: pixel, sample, value, and the command that tells what happened to their paths. It costs some speed
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000), hide_default_value = true,
          conflicts_with_all = ["strategies", "shard", "resume"])]
    fireflies: u32,

    /// Write what one frame does to this folder: passes, barriers, buffers, timestamps, as JSON and as a picture. Rendering begins after that, and
    /// has of -t what is left then
    #[arg(long, value_name = "DIR", conflicts_with = "resume")]
    record: Option<PathBuf>,

    /// Denoise the image by Open Image Denoise, where its library is installed, with its albedo and normals; the layer `noisy` of an EXR is
    /// the image as it was. For techniques whose noise is independent from pixel to pixel
    #[arg(long, conflicts_with_all = ["lengths", "strategies", "shard"])]
    denoise: bool,

    /// Render a share of the samples, to be put together by `lumbre merge`: shard K of N (1/8 to 8/8), of the -n samples per pixel of all of them,
    /// in blocks of 64. Writes images only where -o asks for them
    #[arg(long, value_name = "K/N", value_parser = parse_shard, conflicts_with_all = ["time", "error"])]
    shard: Option<(u32, u32)>,

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Show the picture in progress in the viewer tev that listens there; localhost:14158 by its default
    #[arg(long, value_name = "HOST:PORT", value_parser = tev::parse)]
    tev: Option<String>,

    /// Keep the rendering in this file, so that --resume can go on if it ends before its time; the one before it is FILE.previous
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,

    /// Seconds between two checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = keep::INTERVAL, requires = "checkpoint", value_parser = parse_positive, allow_negative_numbers = true)]
    checkpoint_interval: f64,

    /// Go on from the checkpoint, to the same bits as if nothing had happened; begin anew where there is none yet
    #[arg(long, requires = "checkpoint")]
    resume: bool,

    /// Compile everything there is into the kernel instead of what the scene needs: the same bits, to see what that buys
    #[arg(long)]
    no_specialise: bool,

    /// Leave it to the driver to cut kernels down to what the scene needs: the same bits, to see what doing so beforehand buys
    #[arg(long)]
    driver_specialises: bool,

    /// Have the driver compute as the shaders are written, without regrouping sums and products: the last bits then follow their text alone, which
    /// is how benches/same_bits.py compares two versions
    #[arg(long, conflicts_with = "driver_specialises")]
    exact_arithmetic: bool,

    #[command(flatten)]
    device: DeviceArgs,

    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

fn parse_shard(text: &str) -> Result<(u32, u32), String> {
    let numbers = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
    numbers
        .filter(|(number, of)| (1..=*of).contains(number))
        .ok_or_else(|| String::from("it must be K/N with K from 1 to N"))
}

/// Pixel samples up to which a CPU driver is not to optimise kernels: that takes longer than what it saves.
const QUICK_SAMPLES: u64 = 1 << 17;

/// Pixel samples that the rendering will come to: none where it is over at once, no end of them where that is not known.
fn expected_samples(args: &RenderArgs, scene: &Scene, camera: &Camera) -> u64 {
    match (args.time, args.error) {
        (Some(seconds), _) if seconds < 2.0 => 0,
        (Some(_), _) | (None, Some(_)) => u64::MAX,
        (None, None) => {
            let film = scene.film_of(camera);
            let (width, height) = args.settings.size.unwrap_or((film.width, film.height));
            u64::from(width) * u64::from(height) * u64::from(asked_spp(args, scene, camera))
        }
    }
}

/// Samples per pixel that end the rendering, where time and error do not.
fn asked_spp(args: &RenderArgs, scene: &Scene, camera: &Camera) -> u32 {
    args.spp.or(scene.spp_of(camera)).unwrap_or(DEFAULT_SPP)
}

pub(super) fn run(args: &RenderArgs) -> Result<()> {
    let started = Instant::now();
    let interrupted = listen_for_interrupts();
    // What is wrong with the command itself is said before any work.
    let asked = args.settings.technique()?;
    let mut layers = layers::parse(&args.aov)?;
    let outputs = outputs(args)?;

    let scene = args.scene.load()?;
    let load = started.elapsed().as_secs_f64();
    if !args.quiet {
        print_warnings(&scene);
    }
    let camera = scene.camera(args.settings.camera.as_deref())?;
    if expected_samples(args, &scene, camera) <= QUICK_SAMPLES {
        compile_quickly();
    }
    let gpu = args.device.open()?;
    let (mut settings, mut job) = settle(args, &scene, &gpu, asked, outputs)?;
    if layers.is_empty() && has_exr(&job.outputs) {
        layers = layers::of_scene(&scene)?;
    }
    let denoiser = args.denoise.then(Denoiser::open).transpose()?;
    if denoiser.is_some() {
        layers = layers::with_noisy(layers)?;
    }
    let through_specular = args.aov_through_specular;
    settings.aovs = (denoiser.is_some() || layers::have_aovs(&layers)).then_some(AovSettings { through_specular });
    if through_specular && settings.aovs.is_none() {
        let message = "--aov-through-specular is about AOVs, and none is asked for: valid is with --aov or --denoise";
        return Err(Error::Usage(String::from(message)));
    }
    if let Some(missed) = settings.technique.misses(&scene).filter(|_| !args.quiet) {
        say!("warning: {} does not find {missed}: the image lacks it", settings.technique.row.name);
    }

    if let (Some(light), Some(_), false) = (settings.technique.finds_rarely(&scene), args.error, args.quiet) {
        say!(
            "warning: {} finds {light} only with rare, bright samples: --error does not see those that have not come yet",
            settings.technique.row.name
        );
    }

    let stands_at = camera.to_world.translation - scene.origin;
    let shows = settings.technique.row.is_light_tracing();
    if shows && !args.quiet && scene.is_within_smooth_glass(stands_at) {
        say!(
            "warning: the camera stands within smooth glass: {} shows it nothing that lies outside; valid is any other technique",
            settings.technique.row.name
        );
    }
    if let Some(taken) = settings.technique.simplifies(&scene).filter(|_| !args.quiet) {
        say!("warning: {} takes for diffuse, with the albedo that they have: {taken}", settings.technique.row.name);
    }

    if settings.shard.is_some() && settings.technique.row.correlated == Correlated::Samples && !args.quiet {
        say!("note: {}: {}", settings.technique.row.name, lumbre::merge::CHAINS_ARE_OWN);
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
    let trace = |x, y, sample| trace_command(args, renderer.settings(), x, y, sample);
    let found = fireflies.found(&renderer, trace)?;
    if fireflies.lost() > 0 && !args.quiet {
        say!(
            "warning: {} samples had no room among those that --fireflies looks at: one of them may be brighter",
            fireflies.lost()
        );
    }
    let told = (about.settings, report::Figures { rays: renderer.rays(), frames: frames(&renderer), rare: about.rare });
    let mut result = report::Report::new(told, &gpu, &renderer, &film, load, started)?.with_fireflies(found);
    // Should they fail, the image is still to be written.
    let (aovs, mut lost) = match renderer.aovs() {
        Ok(aovs) => (aovs, None),
        Err(error) => (None, Some(error)),
    };
    let mut denoised = None;
    if let (Some(denoiser), Some(aovs)) = (&denoiser, &aovs) {
        match denoise::denoise(denoiser, &film.mean(), aovs) {
            Ok(image) => (denoised, result.denoiser) = (Some(image), Some(denoiser.name())),
            Err(error) => lost = Some(error),
        }
    }
    let mut picture = report::picture(&film, &result, layers::images(&layers, &film, aovs.as_ref()));
    picture.image = denoised.unwrap_or(picture.image);
    if let Some(aovs) = &aovs {
        picture.header.extend(layers::header(&layers, &scene, aovs));
    }
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

/// The command that tells what happened to the paths of a sample of this rendering.
fn trace_command(args: &RenderArgs, settings: &Settings, x: u32, y: u32, sample: u32) -> String {
    let mut words = vec![String::from("lumbre"), String::from("trace")];
    words.extend(args.scene.words());
    words.extend(args.settings.words(settings));
    words.extend([String::from("--pixel"), format!("{x},{y}"), String::from("--sample"), sample.to_string()]);
    shlex::try_join(words.iter().map(String::as_str)).unwrap_or_else(|_| words.join(" "))
}

/// The outputs, each of which can be written.
fn outputs(args: &RenderArgs) -> Result<Vec<PathBuf>> {
    let mut outputs: Vec<PathBuf> = args.output.iter().map(|path| destination(path)).collect();
    let has_shard = args.checkpoint.is_some() || has_exr(&outputs);
    if args.shard.is_some() {
        if !has_shard {
            return Err(Error::Usage(String::from(
                "--shard writes what lumbre merge puts together: give --checkpoint FILE, or -o FILE.exr, whose merging rounds",
            )));
        }
    } else if outputs.is_empty() {
        let stem = args.scene.scene.file_stem().filter(|stem| *stem != STANDARD_INPUT);
        let stem = PathBuf::from(stem.unwrap_or_else(|| "image".as_ref()));
        outputs = vec![stem.with_extension("exr"), stem.with_extension("png")];
    }
    for path in &outputs {
        format_of(path)?;
        check_writable(path)?;
    }
    args.checkpoint.as_deref().map_or(Ok(()), check_name)?;
    check_apart(outputs.iter().chain(&args.json).chain(&args.checkpoint).map(PathBuf::as_path))?;
    // The checkpoint of a shard keeps its layers.
    let is_lost = args.lengths.is_some() && args.shard.is_none();
    if !has_exr(&outputs) && (is_lost || !args.aov.is_empty()) {
        return Err(Error::Usage(String::from(
            "--lengths and --aov write layers of an EXR file: give an output that ends in .exr",
        )));
    }
    check_json(args.json.as_deref())?;
    if let Some(folder) = &args.record {
        record::check_folder(folder)?;
    }
    Ok(outputs)
}

fn has_exr(outputs: &[PathBuf]) -> bool {
    outputs.iter().any(|path| matches!(format_of(path), Ok(Format::Exr)))
}

/// What the command line, then the scene, then the defaults ask for.
fn settle(
    args: &RenderArgs,
    scene: &Scene,
    gpu: &Gpu,
    asked: Option<Technique>,
    outputs: Vec<PathBuf>,
) -> Result<(Settings, Job)> {
    let camera = scene.camera(args.settings.camera.as_deref())?;
    let mut settings = args.settings.settle(scene, gpu, asked)?;
    let technique = &settings.technique;
    if args.error.is_some() && technique.row.correlated == Correlated::Samples {
        return Err(Error::Usage(format!(
            "--error with {}: its samples are correlated, so their variance does not tell the error; valid are -n and -t",
            technique.row.name
        )));
    }
    if args.denoise {
        denoise::check(technique.row)?;
    }
    settings.specialise = !args.no_specialise;
    settings.driver_specialises = args.driver_specialises;
    if args.exact_arithmetic {
        settings.arithmetic = Arithmetic::Exact;
    }
    settings.lengths = match args.lengths {
        None => 0,
        Some(0) => settings.max_depth.unwrap_or(DEFAULT_LENGTHS).clamp(1, DEFAULT_LENGTHS),
        Some(count) => count,
    };
    if let Some(most) = args.strategies {
        let longest = settings.max_depth.map_or(most, |depth| depth.min(most));
        let shortened = settings.max_depth != Some(longest) && settings.technique.row.tells_strategies;
        if shortened && !args.quiet {
            say!("note: paths end after {longest} segments, for --strategies to show all of them");
        }
        settings.strategies = Some(Strategies::of(longest, camera));
        settings.max_depth = Some(longest);
    }
    let spp = match (args.time, args.error) {
        (Some(_), _) => u32::MAX,
        (None, Some(_)) => args.spp.unwrap_or(u32::MAX),
        (None, None) => asked_spp(args, scene, camera),
    };
    settings.records = if args.fireflies > 0 { fireflies::room(&settings) } else { 0 };
    settings.expected_samples = expected_samples(args, scene, camera);
    settings.shard = args.shard.map(|(number, of)| Shard::new(number, of, spp)).transpose()?;
    let spp = settings.shard.map_or(spp, Shard::count);
    Ok((settings, Job { outputs, spp, time: args.time }))
}
