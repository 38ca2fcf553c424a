//! `lumbre view`.

use std::path::PathBuf;

use clap::Args;

use lumbre::error::Result;
use lumbre::techniques::Sampler;

use super::args::{Depth, DeviceArgs, SceneArgs, parse_depth, parse_sampler, parse_size};

#[derive(Args)]
#[cfg_attr(not(feature = "view"), allow(dead_code))]
pub(super) struct ViewArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// Technique, with parameters as NAME:PARAMETER=VALUE; `lumbre list` shows them all. By default the
    /// one that `lumbre render` takes
    #[arg(short = 'i', long, value_name = "NAME")]
    integrator: Option<String>,

    /// Samples per pixel that are enough; by default it goes on until the window is closed
    #[arg(short = 'n', long, value_name = "SPP", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    spp: Option<u32>,

    /// Size of the image in pixels, whatever that of the window; by default the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// Longest path in segments (1: emission only, 2: adds direct light); -1 is no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse_depth)]
    max_depth: Option<Depth>,

    /// Segments after which Russian roulette may end a path, once its throughput is low
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    rr_depth: Option<u32>,

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

    /// An image that stands for the truth: the panel tells the relMSE against it, and the difference can be shown
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,

    /// Say on standard output what happens: pictures, pixels that were clicked on, screenshots
    #[arg(short, long)]
    verbose: bool,
}

#[cfg(feature = "view")]
pub(super) fn run(args: &ViewArgs) -> Result<()> {
    use lumbre::error::Error;
    use lumbre::image::format_of;
    use lumbre::layout::backend::BACKENDS;
    use lumbre::render::Technique;
    use lumbre::view::{Choice, Layer, Start, Wanted, open};

    use super::args::choose_backend;
    use super::interrupt::listen_for_interrupts;
    use super::output::{print, say};

    // What is wrong with the command itself is said before there is a window.
    args.integrator.as_deref().map(Technique::parse).transpose()?;
    if args.backend != "auto" && !BACKENDS.iter().any(|row| row.name == args.backend) {
        let valid = std::iter::once("auto").chain(BACKENDS.iter().map(|row| row.name));
        return Err(Error::Usage(format!("no backend '{}': valid are {}", args.backend, lumbre::error::one_of(valid))));
    }
    let files = [Some(&args.scene.scene), args.reference.as_ref()];
    for path in files.into_iter().flatten().filter(|path| path.as_os_str() != "-") {
        std::fs::File::open(path).map_err(|error| Error::read(path, error))?;
    }
    args.reference.as_deref().map(format_of).transpose()?;
    let wanted = Wanted {
        scene: args.scene.scene.clone(),
        options: args.scene.options(),
        scene_number: 0,
        device: args.device.device.clone(),
        choice: Choice {
            technique: args.integrator.clone(),
            backend: args.backend.clone(),
            size: args.size,
            camera: args.camera.clone(),
            max_depth: args.max_depth.map(|Depth(depth)| depth),
            rr_depth: args.rr_depth,
            sampler: args.sampler,
            seed: args.seed,
            ..Choice::default()
        },
        camera: None,
        camera_number: 0,
        layer: Layer::Image,
        reference: args.reference.clone(),
        is_paused: false,
        spp: args.spp,
    };
    let verbose = args.verbose;
    let messages = open(Start {
        wanted,
        choose_backend,
        validate: args.device.validate,
        interrupted: listen_for_interrupts(),
        tell: Box::new(move |line| {
            if verbose {
                print(line);
            }
        }),
    })?;
    let Some((first, rest)) = messages.split_first() else { return Ok(()) };
    rest.iter().for_each(|message| say!("validation: {message}"));
    Err(Error::Validation(first.clone()))
}

#[cfg(not(feature = "view"))]
pub(super) fn run(_: &ViewArgs) -> Result<()> {
    let message = "this lumbre was built without its window; with it: cargo build --release --features view";
    Err(lumbre::error::Error::Usage(String::from(message)))
}
