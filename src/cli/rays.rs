//! `lumbre rays`: raw throughput by kind of ray.

use std::path::PathBuf;

use clap::Args;

use lumbre::error::{Bytes, Error, Result};
use lumbre::layout::backend::{BACKENDS, Backend};
use lumbre::rays::{Measurement, PerRay, export, make, measure, settings};

use super::args::{DeviceArgs, SceneArgs, parse_size};
use super::output::{
    check_apart, check_file, check_json, destination, print, print_warnings, takes_standard_output, write_json,
};

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

    /// Write the triangles and the rays as well, for other ray tracers to be measured with
    /// (benches/against_embree.py); '-' is standard output, without the table then
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,
}

pub(super) fn run(args: &RaysArgs) -> Result<()> {
    check_json(args.json.as_deref())?;
    check_file(args.export.as_deref(), "triangles and rays", "rays")?;
    check_apart(args.export.iter().chain(&args.json).map(PathBuf::as_path))?;
    let scene = args.scene.load()?;
    print_warnings(&scene);
    let gpu = args.device.open()?;
    let backends: Vec<Backend> = if args.backend.is_empty() {
        BACKENDS.iter().map(|row| row.backend).filter(|backend| gpu.survey().refusal(*backend).is_none()).collect()
    } else {
        args.backend.iter().map(|name| gpu.backend(Some(name))).collect::<Result<_>>()?
    };
    if scene.primitives.is_empty() {
        return Err(Error::Usage(format!("{} has no geometry to trace rays against", scene.source.display())));
    }
    let first = backends.first().copied().unwrap_or(Backend::Bvh);
    let kinds = make(&gpu, &scene, &settings(&scene, first, args.size)?)?;
    if let Some(path) = &args.export {
        export(&scene, &kinds, &destination(path))?;
    }
    let found = measure(&gpu, &scene, &backends, args.size, &kinds, args.repeats as usize)?;
    if let Some(path) = &args.json {
        write_json(path, &found)?;
    }
    if !args.export.iter().chain(&args.json).any(|path| takes_standard_output(path)) {
        print_table(&found);
    }
    DeviceArgs::report_validation(&gpu)
}

fn print_table(found: &Measurement) {
    print(&format!("device     {} ({})", found.device, found.driver));
    print(&format!(
        "scene      {} primitives, {} B each beside the structures",
        found.primitives,
        size_of::<lumbre::layout::Primitive>()
    ));
    for structure in &found.structures {
        let compiled_in = match structure.compiled_in {
            0 => String::new(),
            count => format!(", not read: the kernel holds all {count} triangles"),
        };
        print(&format!(
            "{:<10} structure built in {:.3} s, {}, {:.1} B per primitive{compiled_in}",
            structure.backend,
            structure.build_seconds,
            Bytes(structure.bytes),
            structure.bytes_per_primitive
        ));
    }
    print("\nMrays/s, median (slowest to fastest), of rays in the order of the image and of the same rays shuffled");
    print(
        "kind            backend                          in order                          shuffled  against the first",
    );
    for row in &found.throughput {
        let first = found
            .throughput
            .iter()
            .find(|other| other.kind == row.kind)
            .map_or((row.mrays_per_s, row.shuffled_mrays_per_s), |first| {
                (first.mrays_per_s, first.shuffled_mrays_per_s)
            });
        print(&format!(
            "{:<15} {:<10} {:>32}  {:>32}  x {:.2} and {:.2}   {} rays, {:.1} % hit",
            format!("{:?}", row.kind),
            row.backend,
            rate(row.mrays_per_s, &row.runs),
            rate(row.shuffled_mrays_per_s, &row.shuffled_runs),
            row.mrays_per_s / first.0,
            row.shuffled_mrays_per_s / first.1,
            row.rays,
            100.0 * row.hit
        ));
    }
    print("\ntested per ray, mean (99th percentile)");
    print("kind            backend                nodes          primitives");
    for row in &found.throughput {
        let tested = row.tested.map_or(String::from("the driver's traversal cannot be counted"), |tested| {
            format!("{:>17}  {:>18}", count(tested.nodes), count(tested.primitives))
        });
        print(&format!("{:<15} {:<10} {tested}", format!("{:?}", row.kind), row.backend));
    }
}

fn rate(median: f64, runs: &[f64]) -> String {
    let extreme = |pick: fn(f64, f64) -> f64| runs.iter().copied().reduce(pick).unwrap_or(0.0);
    format!("{median:.3} ({:.3} to {:.3})", extreme(f64::min), extreme(f64::max))
}

fn count(per_ray: PerRay) -> String {
    format!("{:.2} ({})", per_ray.mean, per_ray.p99)
}
