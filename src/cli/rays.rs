//! `lumbre rays`: raw throughput by kind of ray.

use std::path::{Path, PathBuf};

use clap::Args;

use lumbre::backend::{BACKENDS, Backend};
use lumbre::error::{Bytes, Error, Result};
use lumbre::output::check_writable;
use lumbre::rays::{Measurement, measure};

use super::render::{parse_size, write_json};
use super::{DeviceArgs, SceneArgs, choose_backend, print, print_warnings};

#[derive(Args)]
pub(super) struct RaysArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// Backends to measure, separated by commas; by default every one that the device has
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    backend: Vec<String>,

    /// Size of the image whose rays are traced
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = parse_size)]
    size: (u32, u32),

    /// Runs of each backend, taken in turn; the median counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repeats: u32,

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,
}

pub(super) fn run(args: &RaysArgs) -> Result<()> {
    if let Some(path) = args.json.as_deref().filter(|path| *path != Path::new("-")) {
        check_writable(path)?;
    }
    let scene = args.scene.load()?;
    print_warnings(&scene);
    let gpu = args.device.open()?;
    let backends: Vec<Backend> = if args.backend.is_empty() {
        BACKENDS.iter().map(|row| row.backend).filter(|backend| gpu.survey().refusal(*backend).is_none()).collect()
    } else {
        args.backend.iter().map(|name| choose_backend(name, &gpu)).collect::<Result<_>>()?
    };
    if scene.primitives.is_empty() {
        return Err(Error::Usage(format!("{} has no geometry to trace rays against", scene.source.display())));
    }
    let found = measure(&gpu, &scene, &backends, args.size, args.repeats as usize)?;
    if let Some(path) = &args.json {
        write_json(path, &found)?;
    }
    if args.json.as_deref() != Some(Path::new("-")) {
        print_table(&found);
    }
    DeviceArgs::report_validation(&gpu)
}

fn print_table(found: &Measurement) {
    print(&format!("device     {} ({})", found.device, found.driver));
    print(&format!("scene      {} primitives", found.primitives));
    for structure in &found.structures {
        print(&format!(
            "{:<10} built and uploaded in {:.3} s, structure {}",
            structure.backend,
            structure.build_seconds,
            Bytes(structure.bytes)
        ));
    }
    print("kind            backend       Mrays/s  (slowest to fastest)  against the first");
    for row in &found.throughput {
        let first = found
            .throughput
            .iter()
            .find(|other| other.kind == row.kind)
            .map_or(row.mrays_per_s, |first| first.mrays_per_s);
        let extreme = |pick: fn(f64, f64) -> f64| row.runs.iter().copied().reduce(pick).unwrap_or(0.0);
        print(&format!(
            "{:<15} {:<10} {:>10.3}  ({:.3} to {:.3})  x {:.2}   {} rays, {:.1} % hit",
            format!("{:?}", row.kind),
            row.backend,
            row.mrays_per_s,
            extreme(f64::min),
            extreme(f64::max),
            row.mrays_per_s / first,
            row.rays,
            100.0 * row.hit
        ));
    }
}
