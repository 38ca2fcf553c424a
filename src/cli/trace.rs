//! `lumbre trace`.

use std::path::PathBuf;

use clap::Args;

use lumbre::error::Result;
use lumbre::files::replace_by;
use lumbre::gpu::compile_quickly;
use lumbre::trace::{MOST_SAMPLES, Request, svg, text, trace, trace_brightest};

use super::args::{DeviceArgs, SceneArgs};
use super::output::{
    check_apart, check_file, check_json, destination, print, print_warnings, say, takes_standard_output, write_json,
};
use super::settings::SettingsArgs;

#[derive(Args)]
pub(super) struct TraceArgs {
    #[command(flatten)]
    scene: SceneArgs,

    #[command(flatten)]
    settings: SettingsArgs,

    /// The pixel: column from the left and row from the top, from 0
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    pixel: (u32, u32),

    /// Which of the pixel's samples, from 0
    #[arg(long, value_name = "K", default_value_t = 0)]
    sample: u32,

    /// The brightest of the first N of them instead, of 4096 at most
    #[arg(long, value_name = "N", conflicts_with = "sample", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SAMPLES)))]
    brightest_of: Option<u32>,

    /// Write all numbers as JSON ('-' is standard output, instead of the text)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Draw the scene in plan with the paths in it ('-' is standard output, instead of the text)
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,
}

fn parse_pixel(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    parts.ok_or_else(|| String::from("it must be X,Y: two whole numbers from 0"))
}

pub(super) fn run(args: &TraceArgs) -> Result<()> {
    let overrides = args.settings.overrides();
    overrides.check()?;
    check_json(args.json.as_deref())?;
    check_file(args.svg.as_deref(), "an SVG", "svg")?;
    check_apart(args.svg.iter().chain(&args.json).map(PathBuf::as_path))?;
    let scene = args.scene.load()?;
    print_warnings(&scene);
    // One sample: what compiling well takes would never come back.
    compile_quickly();
    let gpu = args.device.open()?;
    let settings = overrides.settle(&scene, &gpu)?;
    let (x, y) = args.pixel;
    let traced = match args.brightest_of {
        Some(samples) => trace_brightest(&gpu, &scene, &settings, x, y, samples)?,
        None => trace(&gpu, &scene, &settings, Request { x, y, sample: args.sample })?,
    };
    if let Some(path) = &args.svg {
        replace_by(&destination(path), svg(&scene, &traced, args.settings.camera.as_deref())?.as_bytes())?;
        say!("wrote {}", path.display());
    }
    if let Some(path) = &args.json {
        write_json(path, &traced)?;
    }
    if !args.svg.iter().chain(&args.json).any(|path| takes_standard_output(path)) {
        print(text(&traced).trim_end());
    }
    DeviceArgs::report_validation(&gpu)
}
