//! One file per sub-command; this one parses, dispatches and reports errors.

mod bench;
mod compare;
mod devices;
mod info;
mod lecture;
mod list;
mod markdown;
mod rays;
mod reference;
mod render;
mod verify;

use std::io::Write;
use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};

use lumbre::error::{Error, Result, one_of};
use lumbre::gpu::{DeviceKind, Gpu, Instance};
use lumbre::layout::backend::{BACKENDS, Backend};
use lumbre::scene::{LightSelection, LoadOptions, Scene};

/// A light-transport laboratory on raw Vulkan.
#[derive(Parser)]
#[command(name = "lumbre", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene
    Render(render::RenderArgs),
    /// Measure speed against error: techniques, backends and options, with intervals
    Bench(bench::BenchArgs),
    /// Make the page of the lecture: every comparison, measured here
    Lecture(lecture::LectureArgs),
    /// Compare an image with a reference
    Compare(compare::CompareArgs),
    /// Make an image that stands for the truth, with a certificate; or check one
    Reference(reference::ReferenceArgs),
    /// Measure raw ray throughput: primary, shadow and diffuse-bounce rays
    Rays(rays::RaysArgs),
    /// Hold this device against the accuracy suite
    Verify(verify::VerifyArgs),
    /// Show what a scene holds and needs
    Info(info::InfoArgs),
    /// List the Vulkan devices, what they can do, and why a backend is refused
    Devices(devices::DevicesArgs),
    /// List the techniques and their parameters
    List(list::ListArgs),
}

/// Which device to run on.
#[derive(Args)]
struct DeviceArgs {
    /// Device by index, UUID, or a part of its name; by default the first of the fastest kind
    #[arg(short = 'd', long, value_name = "SEL")]
    device: Option<String>,

    /// Check every Vulkan call with the Khronos validation layer; a message fails the command
    #[arg(long)]
    validate: bool,
}

/// Which scene to read.
#[derive(Args)]
struct SceneArgs {
    /// Scene file: Mitsuba 3 (.xml), glTF 2.0 (.gltf, .glb), .obj or .ply
    scene: PathBuf,

    /// Set a parameter of a Mitsuba scene
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = parse_define)]
    defines: Vec<(String, String)>,

    /// How lights are selected: by power, from a tree by place and direction, or auto, which takes the tree from 33 lights on
    #[arg(long, value_name = "HOW", default_value = "auto")]
    lights: LightSelection,

    /// Give rough metals and rough glass of a Mitsuba scene back what they lose to multiple scattering, which Mitsuba does not
    #[arg(long)]
    energy_compensation: bool,

    /// Filter the images of materials over what a path sees of them: less noise, and a blur; Mitsuba looks up points
    #[arg(long)]
    mip_maps: bool,
}

impl DeviceArgs {
    fn open(&self) -> Result<Gpu> {
        Gpu::open(&Instance::new(self.validate)?, self.device.as_deref())
    }

    /// Fails if validation had anything to say.
    fn report_validation(gpu: &Gpu) -> Result<()> {
        let messages = gpu.take_validation_messages();
        match messages.split_first() {
            None => Ok(()),
            Some((first, rest)) => {
                rest.iter().for_each(|message| eprintln!("validation: {message}"));
                Err(Error::Validation(first.clone()))
            }
        }
    }
}

impl SceneArgs {
    fn options(&self) -> LoadOptions {
        LoadOptions {
            defines: self.defines.clone(),
            lights: self.lights,
            energy_compensation: self.energy_compensation,
            mip_maps: self.mip_maps,
        }
    }

    fn load(&self) -> Result<Scene> {
        lumbre::scene::load(&self.scene, &self.options())
    }
}

fn parse_define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err(String::from("it must be NAME=VALUE")),
    }
}

/// The backend of that name; `auto` picks ray queries on GPUs that have them, and on processors the one that was measured
/// to be faster there (docs/lavapipe.md).
fn choose_backend(name: &str, gpu: &Gpu) -> Result<Backend> {
    if name == "auto" {
        let survey = gpu.survey();
        let ray_query = survey.kind != DeviceKind::Cpu && survey.refusal(Backend::RayQuery).is_none();
        return Ok(if ray_query { Backend::RayQuery } else { Backend::Bvh });
    }
    let found = BACKENDS.iter().find(|row| row.name == name).map(|row| row.backend);
    let backend = found.ok_or_else(|| {
        let valid = std::iter::once("auto").chain(BACKENDS.iter().map(|row| row.name));
        Error::Usage(format!("no backend '{name}': valid are {}", one_of(valid)))
    })?;
    gpu.require(backend)?;
    Ok(backend)
}

/// Writes to standard output; a reader that has gone away is no error.
fn print(text: &str) {
    let _ = writeln!(std::io::stdout().lock(), "{text}");
}

fn print_warnings(scene: &Scene) {
    for warning in &scene.warnings {
        eprintln!("warning: {}: {warning}", scene.source.display());
    }
}

/// Runs the command line; returns the exit status.
pub fn main() -> u8 {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage_error(&error),
    };
    let done = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Lecture(args) => lecture::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Reference(args) => reference::run(&args),
        Command::Rays(args) => rays::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Devices(args) => devices::run(&args),
        Command::List(args) => list::run(&args),
    };
    match done {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: {error}");
            error.exit_status()
        }
    }
}

/// Reports a command that clap could not make sense of: one line, then what is valid.
fn usage_error(error: &clap::Error) -> u8 {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let _ = error.print();
        return if error.use_stderr() { 2 } else { 0 };
    }
    let text = error.to_string();
    let first = text.split("\n\n").next().unwrap_or(&text).trim_end();
    // A list of missing arguments or of valid values belongs to the first line.
    eprintln!("{}", first.lines().map(str::trim).collect::<Vec<_>>().join(" "));
    let command = Cli::command();
    let asked = std::env::args().nth(1).unwrap_or_default();
    match command.find_subcommand(&asked) {
        Some(subcommand) if error.kind() == ErrorKind::UnknownArgument => {
            let flags =
                subcommand.get_arguments().filter_map(|argument| match (argument.get_long(), argument.get_short()) {
                    (Some(long), _) => Some(format!("--{long}")),
                    (None, Some(short)) => Some(format!("-{short}")),
                    _ => None,
                });
            eprintln!("valid flags of '{asked}' are {}", one_of(flags));
        }
        Some(_) => eprintln!("`lumbre {asked} --help` says more"),
        None => eprintln!("valid commands are {}", one_of(command.get_subcommands().map(clap::Command::get_name))),
    }
    2
}
