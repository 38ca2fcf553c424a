//! `lumbre merge`.

use std::path::{Path, PathBuf};

use clap::Args;

use lumbre::bench;
use lumbre::error::{Error, Result};
use lumbre::files::{check_folder_name, check_writable, promise_of};
use lumbre::image::{Format, format_of, write_picture};
use lumbre::merge::{Kind, images, kind, merge};

use super::bench::table::print_results;
use super::bench::write_results;
use super::output::{check_apart, destination, print, say, takes_standard_output};
use super::render::about::About;
use super::render::report::{Figures, Report, picture, print_summary};

#[derive(Args)]
pub(super) struct MergeArgs {
    /// Shards of one rendering, all of them in any order: checkpoints (the bits of one run) or EXR images (right to rounding), of `lumbre render
    /// --shard`. Or folders of `lumbre bench` with seeds of the same variants
    #[arg(required = true)]
    inputs: Vec<PathBuf>,

    /// Output: .exr or .png, '-' is an EXR to standard output; or, of checkpoints, .ckpt or a name without extension for the checkpoint of one
    /// run, which `lumbre render --resume` goes on from; may repeat. A folder where folders are merged
    #[arg(short = 'o', long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,

    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(args: &MergeArgs) -> Result<()> {
    let kind = kind(&args.inputs)?;
    let same = |one: &Path, other: &Path| {
        // Inputs may be folders.
        one == other || one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
    };
    if let Some(path) = args.output.iter().find(|path| args.inputs.iter().any(|input| same(input, path))) {
        return Err(Error::Usage(format!("{} cannot be merged into itself: choose another output", path.display())));
    }
    check_apart(args.output.iter().map(PathBuf::as_path))?;
    match kind {
        Kind::Checkpoints => checkpoints(args, &outputs(args)),
        Kind::Images => exr_images(args, &outputs(args)),
        Kind::Benches => benches(args),
    }
}

/// The files to write to.
fn outputs(args: &MergeArgs) -> Vec<PathBuf> {
    args.output.iter().map(|path| destination(path)).collect()
}

/// Whether nothing is to be said on standard output.
fn is_silent(args: &MergeArgs) -> bool {
    args.quiet || args.output.iter().any(|path| takes_standard_output(path))
}

/// Whether an output is an image by its name; all others are checkpoints.
fn is_image(path: &Path) -> bool {
    format_of(path).is_ok()
}

fn note(args: &MergeArgs, text: &str) {
    if !args.quiet {
        say!("note: {text}");
    }
}

fn checkpoints(args: &MergeArgs, outputs: &[PathBuf]) -> Result<()> {
    for path in outputs {
        if let Some((extension, promised)) = promise_of(path).filter(|_| !is_image(path)) {
            return Err(Error::Usage(format!(
                "{}: .{extension} is the extension of {promised}; valid outputs of checkpoints are .exr and .png for the image, and .ckpt or a \
                 name without extension for the checkpoint of all",
                path.display()
            )));
        }
        check_writable(path)?;
    }
    let mut merged = merge(&args.inputs)?;
    merged.notes.iter().for_each(|text| note(args, text));
    let abouts: serde_json::Result<Vec<About>> =
        std::mem::take(&mut merged.abouts).into_iter().map(serde_json::from_value).collect();
    let unreadable = |cause: String| {
        Error::read(&args.inputs[0], format!("what it or another shard says of the settings cannot be read: {cause}"))
    };
    let abouts = abouts.map_err(|error| unreadable(error.to_string()))?;
    let about = About::whole(&abouts).ok_or_else(|| unreadable(String::from("there is none")))?;
    merged.header.about = serde_json::to_value(&about).unwrap_or_default();
    let figures = Figures { rays: merged.counted.rays, frames: merged.counted.seconds, rare: about.rare.clone() };
    let report = Report::of_film(about.settings, &merged.film, &figures);
    for path in outputs {
        if is_image(path) {
            write_picture(path, &picture(&merged.film, &report, Vec::new()))?;
        } else {
            merged.save(path)?;
        }
    }
    if !is_silent(args) {
        print(&format!("merged     {} shards", args.inputs.len()));
        print_summary(&report, &args.output.iter().map(PathBuf::as_path).collect::<Vec<_>>(), false);
    }
    Ok(())
}

fn benches(args: &MergeArgs) -> Result<()> {
    let [output] = args.output.as_slice() else {
        return Err(Error::Usage(String::from("folders are merged into one: give one output")));
    };
    check_folder_name(output)?;
    let results = bench::merge::merge(&args.inputs, output)?;
    write_results(output, &results)?;
    if !args.quiet {
        print_results(&results);
        print(&format!("wrote {}", output.join("index.html").display()));
    }
    Ok(())
}

fn exr_images(args: &MergeArgs, outputs: &[PathBuf]) -> Result<()> {
    for path in outputs {
        if !is_image(path) {
            return Err(Error::Usage(format!(
                "{}: images hold means, of which no checkpoint can be made; valid outputs are .exr and .png",
                path.display()
            )));
        }
        check_writable(path)?;
    }
    let (picture, devices_differ) = images::merge(&args.inputs)?;
    note(args, "images hold rounded means: their mean is right to rounding; checkpoints have the bits of one run");
    if devices_differ {
        note(args, "shards are of different devices");
    }
    for path in outputs {
        write_picture(path, &picture)?;
    }
    if !is_silent(args) {
        let layers = picture.layers.len();
        let kept = if args.output.iter().any(|path| matches!(format_of(path), Ok(Format::Exr))) {
            format!(", {layers} further layers")
        } else {
            String::new()
        };
        print(&format!("merged     {} images{kept}", args.inputs.len()));
    }
    Ok(())
}
