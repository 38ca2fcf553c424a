//! `lumbre bench`: speed against error.

mod columns;
mod entry;
pub(super) mod table;

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

use clap::Args;

use lumbre::bench::peer::{Peer, SceneRequest};
use lumbre::bench::results::{Reference, Results, SCHEMA, SceneResults};
use lumbre::bench::{Bench, Limits, Truth, against, run::Event};
use lumbre::error::{Error, Result};
use lumbre::files::{STANDARD_INPUT, check_folder_name, check_writable, replace_file};
use lumbre::gpu::Gpu;
use lumbre::image::{Image, Picture, write_picture};
use lumbre::reference::{self, Budget, Request, Step};
use lumbre::render::{Settings, Technique, kernels_fingerprint};
use lumbre::scene::{LightSelection, LoadOptions, Scene, SceneFormat};
use lumbre::statistics::CONFIDENCE;

use super::args::{Depth, DeviceArgs, parse_define, parse_depth, parse_positive, parse_size};
use super::host;
use super::interrupt::listen_for_interrupts;
use super::output::{print, print_warnings, say, write_json};
use columns::{Column, wanted_light};
use entry::Entry;

#[derive(Args)]
pub(super) struct BenchArgs {
    /// Scene files; '-' is standard input, with --format. None compares the folder's earlier bench with --against
    #[arg(value_name = "SCENE", required_unless_present = "against")]
    scenes: Vec<PathBuf>,

    /// Format of the scenes, whatever their names: xml, gltf, glb, obj or ply
    #[arg(long, value_name = "NAME")]
    format: Option<SceneFormat>,

    /// Techniques, separated by commas, each with its parameters as NAME:PARAMETER=VALUE
    #[arg(short = 'i', long, value_name = "LIST", value_delimiter = ',', default_value = "path")]
    integrator: Vec<String>,

    /// Ray backends, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "auto")]
    backend: Vec<String>,

    /// Ablations, separated by commas: each technique and backend once more with it. no-specialise, lights=power, lights=tree,
    /// sampler=independent
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    ablate: Vec<String>,

    /// Another renderer as a further variant, NAME=COMMAND; may repeat. benches/peers/mitsuba.py is one; Mitsuba scenes only
    #[arg(long, value_name = "NAME=COMMAND")]
    peer: Vec<String>,

    /// Seconds of rendering per run
    #[arg(short = 't', long, value_name = "SECONDS", conflicts_with = "spp", value_parser = parse_positive, allow_negative_numbers = true)]
    time: Option<f64>,

    /// Samples per pixel of each run instead
    #[arg(short = 'n', long, value_name = "SPP", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    spp: Option<u32>,

    /// Independent runs of each variant
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(2..=1000), allow_negative_numbers = true)]
    seeds: u32,

    /// The seed of the first of them: benches with other seeds are put together by `lumbre merge`
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=1_000_000_000), allow_negative_numbers = true)]
    first_seed: u32,

    /// Image that stands for the truth, one per scene; without it one is made. One that `lumbre reference` made is taken as it says; any
    /// other is checked by the best technique there is. An EXR layer `variance` says how noisy it is
    #[arg(long, value_name = "FILE")]
    reference: Vec<PathBuf>,

    /// Seconds that making and checking a reference may take, kernels included; by default as long as one variant's runs take together
    #[arg(long, value_name = "SECONDS", value_parser = parse_positive, allow_negative_numbers = true)]
    reference_time: Option<f64>,

    /// Size of the images in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// Longest path in segments (1: emission only, 2: adds direct light); -1 is no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse_depth)]
    max_depth: Option<Depth>,

    /// Set a parameter of Mitsuba scenes
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parse_define)]
    defines: Vec<(String, String)>,

    /// Compare with the results.json of an earlier bench; exit with status 1 where something got worse
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,

    /// By how many per cent something must be worse to count, beyond noise
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, value_parser = parse_percent, requires = "against")]
    threshold: f64,

    /// Folder for index.html, results.json, results.csv and images
    #[arg(short = 'o', long, value_name = "DIR", default_value = "bench")]
    output: PathBuf,

    /// Replace what the folder holds of another bench
    #[arg(long)]
    fresh: bool,

    #[command(flatten)]
    device: DeviceArgs,

    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

fn parse_percent(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (0.0..=1000.0).contains(number));
    number.ok_or_else(|| String::from("it must be a number from 0 to 1000"))
}

pub(super) fn run(args: &BenchArgs) -> Result<()> {
    let old = args.against.as_deref().map(Results::read).transpose()?;
    if args.scenes.is_empty() {
        let new = Results::read(&args.output.join("results.json"))?;
        return conclude(old.as_ref(), &new, args);
    }
    check_folder_name(&args.output)?;
    let interrupted = listen_for_interrupts();
    let limits = Limits {
        seeds: args.seeds,
        seconds: if args.spp.is_none() { Some(args.time.unwrap_or(5.0)) } else { None },
        spp: args.spp,
        first_seed: args.first_seed,
    };
    // Whatever is wrong is said before anything is rendered.
    let techniques = args.integrator.iter().map(|name| Technique::parse(name)).collect::<Result<Vec<_>>>()?;
    let ablations = columns::parse_ablations(&args.ablate)?;
    if !args.reference.is_empty() && args.reference.len() != args.scenes.len() {
        return Err(Error::Usage(format!(
            "{} references for {} scenes: give one for each, in the same order, or none",
            args.reference.len(),
            args.scenes.len()
        )));
    }
    let entries = read_scenes(args, &techniques)?;
    let gpu = args.device.open()?;
    let columns = Column::all(&techniques, &args.backend, &ablations, &gpu)?;
    let fingerprints: Vec<u64> = entries.iter().map(|entry| fingerprint(entry, &columns, &gpu, limits)).collect();
    prepare_folder(args, &entries, &fingerprints)?;

    let started = humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string();
    let mut results = Results {
        schema: SCHEMA.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: host::command_line(),
        started,
        device: host::device(&gpu),
        seeds: args.seeds,
        seconds: limits.seconds,
        spp: limits.spp,
        confidence: CONFIDENCE,
        scenes: Vec::new(),
    };
    for (entry, fingerprint) in entries.iter().zip(fingerprints) {
        let stop = || {
            if interrupted.load(Ordering::Relaxed) {
                let folder = args.output.display();
                return Err(Error::Interrupted(format!(
                    "what was measured is kept in {folder}; the same command goes on"
                )));
            }
            Ok(())
        };
        results.scenes.push(bench_scene(args, entry, &columns, &gpu, (limits, fingerprint), &stop)?);
        write_results(&args.output, &results)?;
    }
    DeviceArgs::report_validation(&gpu)?;
    if !args.quiet {
        table::print_results(&results);
        print(&format!("wrote {}", args.output.join("index.html").display()));
    }
    conclude(old.as_ref(), &results, args)
}

/// Prints what changed against an older bench; an error where something got worse.
fn conclude(old: Option<&Results>, new: &Results, args: &BenchArgs) -> Result<()> {
    let Some(old) = old else { return Ok(()) };
    let found = against::compare(old, new, args.threshold / 100.0);
    if !args.quiet {
        table::print_comparison(old, new, &found);
    }
    if found.has_regression() {
        return Err(Error::Regression(format!(
            "{} figures are worse than before by more than {} % beyond noise",
            found.changes.iter().filter(|change| change.regression).count(),
            args.threshold
        )));
    }
    Ok(())
}

fn read_scenes(args: &BenchArgs, techniques: &[Technique]) -> Result<Vec<Entry>> {
    let mut names = HashSet::new();
    let mut entries = Vec::new();
    for (index, file) in args.scenes.iter().enumerate() {
        let (scene, load) = lumbre::bench::subject::timed_load(|| load(args, file, LightSelection::Auto))?;
        if !args.quiet {
            print_warnings(&scene);
        }
        let mut settings = Settings::new(&scene, Technique::parse("path")?, lumbre::layout::backend::Backend::Bvh);
        if let Some((width, height)) = args.size {
            (settings.width, settings.height) = (width, height);
        }
        if let Some(Depth(depth)) = args.max_depth {
            settings.max_depth = depth;
        }
        let given = match args.reference.get(index) {
            Some(path) => Some((path.clone(), reference::read(path, settings.width, settings.height)?)),
            None => None,
        };
        let stem = file.file_stem().map_or(String::from("scene"), |stem| stem.to_string_lossy().into_owned());
        let name = (1..).map(|n| if n == 1 { stem.clone() } else { format!("{stem}-{n}") });
        let name = name.into_iter().find(|name| names.insert(name.clone())).unwrap_or_default();
        let solves = wanted_light(techniques);
        entries.push(Entry { name, file: file.clone(), scene, load, settings, solves, given });
    }
    Ok(entries)
}

fn load(args: &BenchArgs, file: &Path, lights: LightSelection) -> Result<Scene> {
    let defines = if is_mitsuba(args, file) { args.defines.clone() } else { Vec::new() };
    lumbre::scene::load(file, &LoadOptions { format: args.format, defines, lights, ..LoadOptions::default() })
}

fn is_mitsuba(args: &BenchArgs, file: &Path) -> bool {
    let by_name = || file.extension().is_some_and(|extension| extension == "xml");
    args.format.map_or_else(by_name, |format| format == SceneFormat::Xml)
}

/// Makes the folder; refuses one that holds another bench.
fn prepare_folder(args: &BenchArgs, entries: &[Entry], fingerprints: &[u64]) -> Result<()> {
    let folder = &args.output;
    for part in [folder.clone(), folder.join("runs"), folder.join("images")] {
        std::fs::create_dir_all(&part)
            .map_err(|error| Error::Usage(format!("cannot make {}: {error}", part.display())))?;
    }
    check_writable(&folder.join("results.json"))?;
    let mut hasher = DefaultHasher::new();
    fingerprints.hash(&mut hasher);
    for entry in entries {
        let time = args.reference_time.map(f64::to_bits);
        (&entry.name, entry.given.is_some(), time, &args.peer).hash(&mut hasher);
    }
    let plan = format!("{:016x}", hasher.finish());
    let path = folder.join("bench.plan");
    match std::fs::read_to_string(&path) {
        Ok(other) if other.trim() != plan && !args.fresh => Err(Error::Usage(format!(
            "{} holds another bench, or one of other code: choose another folder, or add --fresh to replace it",
            folder.display()
        ))),
        _ => replace_file(&path, |file| writeln!(file, "{plan}").map_err(|error| error.to_string())),
    }
}

/// What the runs of a scene depend on.
fn fingerprint(entry: &Entry, columns: &[Column], gpu: &Gpu, limits: Limits) -> u64 {
    let mut hasher = DefaultHasher::new();
    entry.scene.hash_content(&mut hasher);
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let survey = gpu.survey();
    format!("{:?} {limits:?} {names:?} {} {}", entry.settings, survey.name, survey.driver).hash(&mut hasher);
    kernels_fingerprint().hash(&mut hasher);
    if let Some((_, truth)) = &entry.given {
        truth.image.hash_pixels(&mut hasher);
    }
    hasher.finish()
}

/// A fingerprint with what the errors are measured against: runs that were kept hold these, not images alone.
fn with_reference(fingerprint: u64, truth: &Truth) -> u64 {
    let mut hasher = DefaultHasher::new();
    fingerprint.hash(&mut hasher);
    truth.image.hash_pixels(&mut hasher);
    if let Some(variance) = &truth.variance {
        variance.hash_pixels(&mut hasher);
    }
    hasher.finish()
}

fn bench_scene(
    args: &BenchArgs,
    entry: &Entry,
    columns: &[Column],
    gpu: &Gpu,
    (limits, fingerprint): (Limits, u64),
    stop: &dyn Fn() -> Result<()>,
) -> Result<SceneResults> {
    let say = |text: String| {
        if !args.quiet {
            say!("{}: {text}", entry.name);
        }
    };
    let (truth, described) = obtain_reference(args, entry, gpu, limits, stop, &say)?;
    let mut variants = columns
        .iter()
        .map(|column| column.variant(gpu, entry, &|lights| load(args, &entry.file, lights)))
        .collect::<Result<Vec<_>>>()?;
    for peer in &args.peer {
        if !is_mitsuba(args, &entry.file) || entry.file == Path::new(STANDARD_INPUT) {
            say(format!("without the peer {peer}: it reads files of Mitsuba scenes (.xml)"));
            continue;
        }
        let request = SceneRequest {
            file: entry.file.clone(),
            defines: args.defines.clone(),
            width: entry.settings.width,
            height: entry.settings.height,
            max_depth: entry.settings.max_depth.map_or(-1, i64::from),
            rr_depth: entry.scene.technique.rr_depth,
        };
        variants.push(Peer::variant(peer, &request, &args.output)?);
    }
    let fingerprint = with_reference(fingerprint, &truth);
    let bench = Bench { folder: &args.output, scene: &entry.name, limits, fingerprint, truth: &truth };
    let summary = bench.results(&mut variants, |event| {
        stop()?;
        match event {
            Event::Run(name, seed, index, of) => say(format!("run {} of {of}, {name}, seed {seed}", index + 1)),
            Event::Kept(name, seed) => say(format!("{name}, seed {seed}: measured before")),
            Event::Rows => say(String::from("images of equal time and equal samples")),
        }
        Ok(())
    })?;
    Ok(SceneResults {
        name: entry.name.clone(),
        file: entry.file.display().to_string(),
        width: entry.settings.width,
        height: entry.settings.height,
        max_depth: entry.settings.max_depth.map_or(-1, i64::from),
        triangles: entry.scene.groups.iter().map(|group| group.triangles.len() as u64).sum(),
        lights: entry.scene.lights.len() as u64 + u64::from(entry.scene.background.is_some()),
        reference: described,
        variants: summary.variants,
        pairs: summary.pairs,
        equal_time: summary.equal_time,
        equal_spp: summary.equal_spp,
    })
}

/// The reference with its description; its pictures go to the folder.
fn obtain_reference(
    args: &BenchArgs,
    entry: &Entry,
    gpu: &Gpu,
    limits: Limits,
    stop: &dyn Fn() -> Result<()>,
    say: &dyn Fn(String),
) -> Result<(Truth, Reference)> {
    let image = format!("images/{}-reference.exr", entry.name);
    let picture = format!("images/{}-reference.png", entry.name);
    let settings = Settings { backend: gpu.backend(None)?, ..entry.settings.clone() };
    let runs = f64::from(limits.seeds);
    let budget = match (args.reference_time, limits.seconds) {
        (Some(seconds), _) => Budget::Seconds(seconds),
        (None, Some(seconds)) => Budget::Seconds(runs * seconds),
        (None, None) => Budget::Samples(runs * f64::from(limits.spp.unwrap_or(1))),
    };
    let (gpu, scene, solves) = (gpu, &entry.scene, entry.solves);
    let request = Request { gpu, scene, settings: &settings, solves, budget, seed: 0, parts: None };
    let mut hear = |step: Step| {
        stop()?;
        if let Some(text) = super::reference::told(&step) {
            say(text);
        }
        Ok(())
    };
    let started = Instant::now();
    let (truth, origin) = match &entry.given {
        Some((path, truth)) if truth.certificate.is_some() => (truth.clone(), format!("given: {}", path.display())),
        Some((path, truth)) => {
            let checked = reference::check(&request, truth, &mut hear)?;
            (checked, format!("given: {}", path.display()))
        }
        None => {
            let (truth, cached) = reference::obtain(&request, &host::cache_folder(&args.output)?, &mut hear)?;
            (truth, String::from(if cached { "cached" } else { "made" }))
        }
    };
    let doubt = truth.doubt();
    if let Some(doubt) = &doubt {
        say(format!("the reference is not confirmed: {doubt}"));
    }
    reference::write(&args.output.join(&image), &truth)?;
    let png = |name: &str, image: &Image| {
        let picture = Picture { image: image.clone(), layers: Vec::new(), header: Vec::new() };
        write_picture(&args.output.join(name), &picture)
    };
    png(&picture, &truth.image)?;
    let difference_map = truth.difference_map.as_ref().map(|map| {
        let name = format!("images/{}-difference.png", entry.name);
        png(&name, map).map(|()| name)
    });
    let makers = truth.certificate.as_ref().filter(|certificate| !certificate.makers.is_empty());
    let described = Reference {
        image,
        picture,
        technique: makers.map(reference::Certificate::makers),
        spp: makers.map(|certificate| certificate.makers.iter().map(|maker| maker.spp).sum::<f64>().round() as u64),
        relmse: truth.relmse(),
        seconds: if origin == "cached" { 0.0 } else { started.elapsed().as_secs_f64() },
        origin,
        certificate: truth.certificate.clone(),
        difference_map: difference_map.transpose()?,
        doubt,
    };
    Ok((truth, described))
}

/// Writes results.json, and the page and the table that are made of it.
pub(super) fn write_results(folder: &Path, results: &Results) -> Result<()> {
    write_json(&folder.join("results.json"), results)?;
    lumbre::report::write(folder, results)
}
