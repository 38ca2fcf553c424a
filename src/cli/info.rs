//! `lumbre info`: what a scene holds, what it needs, and what rendering it takes on the device.

mod census;
mod missing;
mod sampling;

use std::path::PathBuf;

use clap::Args;

use lumbre::error::{Bytes, Result};
use lumbre::gpu::{DeviceKind, Gpu};
use lumbre::layout::backend::{BACKENDS, Backend};
use lumbre::render::{KernelSize, Prediction, Settings, Technique, kernel_sizes};
use lumbre::scene::Scene;
use lumbre::techniques::TECHNIQUES;

use super::args::{DeviceArgs, SceneArgs, parse_size};
use super::output::{check_json, print, print_warnings, say, takes_standard_output, write_json};
use census::{Census, Memory};
use sampling::Sampling;

#[derive(Args)]
pub(super) struct InfoArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// List everything in these scenes, and in those of folders, that would be refused or left out, rather than the first of it
    #[arg(long)]
    missing: bool,

    /// More scenes or folders
    #[arg(value_name = "MORE", requires = "missing")]
    more: Vec<PathBuf>,

    /// Technique to warn about where the scene has light that it cannot sample; by default the one that render takes
    #[arg(short = 'i', long, value_name = "NAME")]
    integrator: Option<String>,

    /// Size of the image in pixels, for the bytes on the device; by default the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,
}

pub(super) fn run(args: &InfoArgs) -> Result<()> {
    check_json(args.json.as_deref())?;
    if args.missing {
        let named = std::iter::once(&args.scene.scene).chain(&args.more);
        return missing::run(named.map(PathBuf::as_path), &args.scene.options(), args.json.as_deref());
    }
    let asked = args.integrator.as_deref().map(Technique::parse).transpose()?;
    let scene = args.scene.load()?;
    print_warnings(&scene);
    // What the file asks for may be refused, which is no reason not to tell what it holds.
    let technique = Technique::of_scene(&scene, asked).or_else(|_| Technique::parse("path"))?;
    let sampling = Sampling::of(&scene, &technique)?;
    for warning in sampling.warnings() {
        say!("warning: {}: {warning}", scene.source.display());
    }
    // Everything but the size of the driver's acceleration structures is known without a device.
    let gpu = match args.device.open() {
        Err(error) if args.device.device.is_some() || args.device.validate => return Err(error),
        opened => opened,
    };
    let memory = BACKENDS.iter().map(|row| -> Result<Memory> {
        let mut settings = Settings::new(&scene, Technique::parse("path")?, row.backend);
        if let Some((width, height)) = args.size {
            (settings.width, settings.height) = (width, height);
        }
        Ok(match predict(&scene, &settings, gpu.as_ref().ok()) {
            Ok(predicted) => Memory::Known(predicted),
            Err(error) => Memory::Unknown { backend: row.name, unknown: error.to_string() },
        })
    });
    let memory = memory.collect::<Result<_>>()?;
    let kind = gpu.as_ref().map_or(DeviceKind::Cpu, |gpu| gpu.survey().kind);
    let census = Census::of(&scene, sampling, memory, kernels(&scene, kind)?);
    for repeat in &census.repeated_images {
        say!(
            "warning: {}: image {} ({}) holds the same texels as image {} ({}): {} are wasted",
            scene.source.display(),
            repeat.image,
            census.images[repeat.image].source,
            repeat.same_as,
            census.images[repeat.same_as].source,
            Bytes(repeat.bytes)
        );
    }
    if let Some(path) = &args.json {
        write_json(path, &census)?;
    }
    if !args.json.as_deref().is_some_and(takes_standard_output) {
        print_census(&census);
    }
    gpu.map_or(Ok(()), |gpu| DeviceArgs::report_validation(&gpu))
}

fn predict(scene: &Scene, settings: &Settings, gpu: Option<&Gpu>) -> Result<Prediction> {
    gpu.map_or(Ok(()), |gpu| gpu.require(settings.backend))?;
    Prediction::of(scene, settings, gpu)
}

/// What the kernels of each technique, with the default values of its parameters, keep for the scene.
fn kernels(scene: &Scene, device: DeviceKind) -> Result<Vec<KernelSize>> {
    let mut all = Vec::new();
    for row in TECHNIQUES {
        let settings = Settings::new(scene, Technique::parse(row.name)?, Backend::Bvh);
        all.extend(kernel_sizes(scene, &settings, device)?);
    }
    Ok(all)
}

fn print_census(census: &Census) {
    print(&format!("scene      {}", census.scene));
    print(&format!("image      {}x{}, {}", census.width, census.height, census.filter));
    print(&format!("cameras    {}", census.cameras.join(", ")));
    print(&format!(
        "geometry   {} triangles, {} spheres, {} groups, {} instances",
        census.triangles.unique, census.spheres.unique, census.groups, census.instances
    ));
    print(&format!("as placed  {} triangles, {} spheres", census.triangles.placed, census.spheres.placed));
    let [min, max] = census.bounds.map(|[x, y, z]| format!("[{x}, {y}, {z}]"));
    print(&format!("bounds     {min} to {max}"));
    print(&format!("surfaces   {}, of {} materials", census.surfaces, census.materials));
    let lights: Vec<_> = census.lights.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    print(&format!(
        "lights     {} entries{}, background {}",
        census.lights.values().sum::<usize>(),
        if lights.is_empty() { String::new() } else { format!(" ({})", lights.join(", ")) },
        if census.background { "yes" } else { "no" }
    ));
    for (index, (kind, power)) in census.power.iter().enumerate() {
        let [r, g, b] = power.watts.map(|watts| format!("{watts:.5}"));
        let head = if index == 0 { "power" } else { "" };
        print(&format!("{head:<10} {kind:<11} {r} {g} {b} W, from {}", power.count));
    }
    print(&format!("textures   {}, of {} images", census.textures, census.images.len()));
    for image in &census.images {
        print(&format!(
            "           {}x{} {}, {}, {}",
            image.width,
            image.height,
            image.format,
            Bytes(image.bytes),
            image.source
        ));
    }
    print(&format!("needs      {}", census.needs.join(", ")));
    print(&format!("left out   {}", census.left_out.join(", ")));
    census.memory.iter().for_each(print_memory);
    print("kernels    SPIR-V instructions that the scene needs, of those that there are");
    for kernel in &census.kernels {
        print(&format!("           {:<26} {:>6} of {:>6}", kernel.module, kernel.instructions, kernel.of));
    }
}

fn print_memory(memory: &Memory) {
    let predicted = match memory {
        Memory::Unknown { backend, unknown } => return print(&format!("memory     {backend}: unknown: {unknown}")),
        Memory::Known(predicted) => predicted,
    };
    let while_building = if predicted.peak > predicted.total {
        format!(", at most {} while it is built", Bytes(predicted.peak))
    } else {
        String::new()
    };
    print(&format!(
        "memory     {}, {}x{}: {} on the device{while_building}",
        predicted.backend,
        predicted.width,
        predicted.height,
        Bytes(predicted.total)
    ));
    for part in &predicted.parts {
        let estimate = if part.exact { "" } else { ", estimated" };
        print(&format!("           {:<22} {:>10}{estimate}", part.name, Bytes(part.bytes).to_string()));
    }
}
