//! One file per sub-command; this one parses, dispatches and reports errors.

mod args;
mod bench;
mod compare;
mod completions;
mod devices;
mod host;
mod info;
mod interrupt;
mod known;
mod lecture;
mod list;
mod man;
mod markdown;
mod merge;
mod output;
mod rays;
mod reference;
mod render;
mod settings;
mod trace;
mod verify;
mod view;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use lumbre::error::{Error, one_of};
use output::{finish, note, say};

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
    /// Look at a scene in a window while it is rendered
    View(view::ViewArgs),
    /// Tell what happens to the path of one sample of a pixel: vertices, densities, weights
    Trace(trace::TraceArgs),
    /// Measure speed against error: techniques, backends and options, with intervals
    Bench(bench::BenchArgs),
    /// Make the page of the lecture: every comparison, measured here
    Lecture(lecture::LectureArgs),
    /// Compare an image with a reference
    Compare(compare::CompareArgs),
    /// Make an image that stands for the truth, with a certificate; or check one
    Reference(reference::ReferenceArgs),
    /// Put together the shards of a rendering, or benches of the same variants
    Merge(merge::MergeArgs),
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
    /// Write a shell's completions to standard output
    Completions(completions::CompletionsArgs),
    /// Write the manual pages
    Man(man::ManArgs),
}

/// The whole command line, to be asked about.
fn whole_command() -> clap::Command {
    Cli::command()
}

/// Runs the command line; returns the exit status.
pub fn main() -> u8 {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage_error(&error),
    };
    let done = match cli.command {
        Command::Render(args) => render::run(&args),
        Command::View(args) => view::run(&args),
        Command::Trace(args) => trace::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Lecture(args) => lecture::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Reference(args) => reference::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Rays(args) => rays::run(&args),
        Command::Verify(args) => verify::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Devices(args) => devices::run(&args),
        Command::List(args) => list::run(&args),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args),
    };
    match done.and_then(|()| finish()) {
        Ok(()) => 0,
        Err(error) => report(&error),
    }
}

/// Says what went wrong; returns the exit status.
fn report(error: &Error) -> u8 {
    say!("error: {error}");
    error.exit_status()
}

/// Reports a command that clap could not make sense of: one line, then what is valid.
fn usage_error(error: &clap::Error) -> u8 {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let printed = error.print();
        if error.use_stderr() {
            return 2;
        }
        note(printed);
        return finish().map_or_else(|error| report(&error), |()| 0);
    }
    let text = error.to_string();
    let first = text.split("\n\n").next().unwrap_or(&text).trim_end();
    // A list of missing arguments or of valid values belongs to the first line.
    say!("{}", first.lines().map(str::trim).collect::<Vec<_>>().join(" "));
    let command = whole_command();
    let asked = std::env::args_os().nth(1).unwrap_or_default().to_string_lossy().into_owned();
    match command.find_subcommand(&asked) {
        Some(subcommand) if error.kind() == ErrorKind::UnknownArgument => {
            let flags =
                subcommand.get_arguments().filter_map(|argument| match (argument.get_long(), argument.get_short()) {
                    (Some(long), _) => Some(format!("--{long}")),
                    (None, Some(short)) => Some(format!("-{short}")),
                    _ => None,
                });
            say!("valid flags of '{asked}' are {}", one_of(flags));
        }
        Some(_) => say!("`lumbre {asked} --help` says more"),
        None => say!("valid commands are {}", one_of(command.get_subcommands().map(clap::Command::get_name))),
    }
    2
}
