//! `lumbre render`.

mod job;
mod keep;
mod layers;
mod progress;
mod pyramid;
mod report;
mod write;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Args;

use lumbre::error::{Error, Result};
use lumbre::files::{STANDARD_INPUT, check_writable, is_standard_output};
use lumbre::gpu::{Gpu, compile_quickly};
use lumbre::image::{Format, format_of};
use lumbre::render::{ErrorTarget, Renderer, Settings, Technique};
use lumbre::scene::{Camera, Scene};
use lumbre::spirv::Arithmetic;
use lumbre::techniques::{AovSettings, Correlated, LONGEST, Sampler, Strategies};

use super::args::{
    Depth, DeviceArgs, SceneArgs, choose_backend, parse_depth, parse_positive, parse_sampler, parse_size,
};
use super::interrupt::listen_for_interrupts;
use super::output::{check_json, print_warnings, say, write_json};
use job::Job;
use keep::CheckpointWriter;
use progress::{BuildProgress, Progress};

/// Samples per pixel where neither the command line nor the scene says.
const DEFAULT_SPP: u32 = 64;
/// Layers by path length where the paths have no limit.
const DEFAULT_LENGTHS: u32 = 16;

#[derive(Args)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// Technique, with parameters as NAME:PARAMETER=VALUE; `lumbre list` shows them all. By default the
    /// one that the scene's file names, else path, or bdpt where points, spots, projectors or
    /// parallel light make caustics
    #[arg(short = 'i', long, value_name = "NAME")]
    integrator: Option<String>,

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

    /// Size of the image in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// Longest path in segments (1: emission only, 2: adds direct light); -1 is no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse_depth)]
    max_depth: Option<Depth>,

    /// Segments after which Russian roulette may end a path, once its throughput is low
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    rr_depth: Option<u32>,

    /// Probability that Russian roulette ends a path, for techniques with a constant one
    #[arg(long, value_name = "Q", allow_negative_numbers = true)]
    rr_q: Option<String>,

    /// Where uniform numbers come from: sobol (the default but for mlt) or independent
    #[arg(long, value_name = "NAME", value_parser = parse_sampler)]
    sampler: Option<Sampler>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,

    /// Ray backend: auto, ray-query or bvh
    #[arg(long, value_name = "NAME", default_value = "auto")]
    backend: String,

    /// Camera by name or number; the scene's first one by default
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,

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

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

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

/// Pixel samples up to which a CPU driver is not to optimise kernels: that takes longer than what it saves.
const QUICK_SAMPLES: u64 = 1 << 17;

/// Pixel samples that the rendering will come to: none where it is over at once, no end of them where that is not known.
fn expected_samples(args: &RenderArgs, scene: &Scene, camera: &Camera) -> u64 {
    match (args.time, args.error) {
        (Some(seconds), _) if seconds < 2.0 => 0,
        (Some(_), _) | (None, Some(_)) => u64::MAX,
        (None, None) => {
            let film = scene.film_of(camera);
            let (width, height) = args.size.unwrap_or((film.width, film.height));
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
    let asked = args.integrator.as_deref().map(Technique::parse).transpose()?;
    let mut layers = layers::parse(&args.aov)?;
    let outputs = outputs(args)?;

    let scene = args.scene.load()?;
    let load = started.elapsed().as_secs_f64();
    if !args.quiet {
        print_warnings(&scene);
    }
    let camera = scene.camera(args.camera.as_deref())?;
    if expected_samples(args, &scene, camera) <= QUICK_SAMPLES {
        compile_quickly();
    }
    let gpu = args.device.open()?;
    let (mut settings, job) = settle(args, &scene, &gpu, asked, outputs)?;
    if layers.is_empty() && has_exr(&job.outputs) {
        layers = layers::of_scene(&scene)?;
    }
    let through_specular = args.aov_through_specular;
    settings.aovs = layers::have_aovs(&layers).then_some(AovSettings { through_specular });
    if through_specular && settings.aovs.is_none() {
        let message = "--aov-through-specular is about AOVs, and none is asked for: valid is with --aov";
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

    let checkpoint = args.checkpoint.as_deref();
    let parts = (&scene, &mut settings, &gpu);
    let mut keeper = CheckpointWriter::new(checkpoint, args.checkpoint_interval, args.resume, args.quiet, parts)?;

    gpu.reset_peak();
    let building = BuildProgress::new(args.quiet);
    let built = Renderer::watched(&gpu, &scene, &settings, &|share| building.update(share));
    building.finish();
    let mut renderer = built?;
    let mut progress = Progress::new(args.quiet, &job);
    let target = args.error.map(ErrorTarget::new);
    let done = iterate(&mut renderer, &job, target, &interrupted, &mut keeper, &mut progress);
    progress.finish();
    let (seconds, next_look) = done.map_err(|error| keeper.explain(error))?;
    // Should it fail, the image is still to be written.
    let kept = keeper.save(&mut renderer, seconds, next_look);

    let film = renderer.film().map_err(|error| keeper.explain(error))?;
    let result = report::Report::new(&scene, &gpu, &renderer, &film, load, started)?;
    // Should they fail, the image is still to be written.
    let (aovs, lost) = match renderer.aovs() {
        Ok(aovs) => (aovs, None),
        Err(error) => (None, Some(error)),
    };
    let mut picture = report::picture(&film, &result, layers::images(&layers, &film, aovs.as_ref()));
    if let Some(aovs) = &aovs {
        picture.header.extend(layers::header(&layers, &scene, aovs));
    }
    write::write_outputs(&job.outputs, &film, &picture, &keeper)?;
    if let Some(path) = &args.json {
        write_json(path, &result)?;
    }
    let is_taken = |path: &Path| path == Path::new("-") || is_standard_output(path);
    if !args.quiet && !args.json.iter().chain(&job.outputs).any(|path| is_taken(path)) {
        report::print_summary(&result, &job.outputs, interrupted.load(Ordering::Relaxed));
    }
    kept.map_err(|error| keeper.explain(error))?;
    lost.map_or(Ok(()), |error| Err(keeper.explain(error)))?;
    DeviceArgs::report_validation(&gpu)
}

/// Renders until the job is done or the user ends it. Returns the seconds that were spent, those before a checkpoint included, and
/// where an error is to be looked at next.
fn iterate(
    renderer: &mut Renderer,
    job: &Job,
    mut target: Option<ErrorTarget>,
    interrupted: &AtomicBool,
    keeper: &mut CheckpointWriter,
    progress: &mut Progress,
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

/// The outputs, each of which can be written.
fn outputs(args: &RenderArgs) -> Result<Vec<PathBuf>> {
    let stdout = Path::new("/dev/stdout");
    let named = |path: &PathBuf| if path == Path::new(STANDARD_INPUT) { stdout.to_owned() } else { path.clone() };
    let mut outputs: Vec<PathBuf> = args.output.iter().map(named).collect();
    if outputs.is_empty() {
        let stem = args.scene.scene.file_stem().filter(|stem| *stem != STANDARD_INPUT);
        let stem = PathBuf::from(stem.unwrap_or_else(|| "image".as_ref()));
        outputs = vec![stem.with_extension("exr"), stem.with_extension("png")];
    }
    for path in &outputs {
        format_of(path)?;
        check_writable(path)?;
    }
    if let Some(path) = args.checkpoint.as_deref().filter(|path| outputs.iter().any(|output| output == path)) {
        return Err(Error::Usage(format!("{} cannot be an output and the checkpoint as well", path.display())));
    }
    if !has_exr(&outputs) && (args.lengths.is_some() || !args.aov.is_empty()) {
        return Err(Error::Usage(String::from(
            "--lengths and --aov write layers of an EXR file: give an output that ends in .exr",
        )));
    }
    check_json(args.json.as_deref())?;
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
    let mut technique = Technique::of_scene(scene, asked)?;
    if let Some(q) = &args.rr_q {
        technique.set("q", q)?;
    }
    if args.error.is_some() && technique.row.correlated == Correlated::Samples {
        return Err(Error::Usage(format!(
            "--error with {}: its samples are correlated, so their variance does not tell the error; valid are -n and -t",
            technique.row.name
        )));
    }
    let mut settings = Settings::new(scene, technique, choose_backend(&args.backend, gpu)?);
    let camera = scene.camera(args.camera.as_deref())?;
    settings.set_camera(scene, args.camera.as_deref())?;
    if let Some((width, height)) = args.size {
        (settings.width, settings.height) = (width, height);
    }
    settings.sampler = args.sampler.unwrap_or(settings.sampler);
    settings.seed = args.seed;
    settings.specialise = !args.no_specialise;
    settings.driver_specialises = args.driver_specialises;
    if args.exact_arithmetic {
        settings.arithmetic = Arithmetic::Exact;
    }
    if let Some(Depth(depth)) = args.max_depth {
        settings.max_depth = depth;
    }
    settings.rr_depth = args.rr_depth.unwrap_or(settings.rr_depth);
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
    settings.expected_samples = expected_samples(args, scene, camera);
    Ok((settings, Job { outputs, spp, time: args.time }))
}
