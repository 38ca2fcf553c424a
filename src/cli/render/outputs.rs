//! What a rendering is to write, checked before any work.

use std::path::PathBuf;

use lumbre::checkpoint::check_name;
use lumbre::error::{Error, Result};
use lumbre::files::{STANDARD_INPUT, check_writable};
use lumbre::image::{Format, format_of};

use super::super::output::{check_apart, check_json, destination};
use super::args::RenderArgs;
use super::record;

/// The outputs, each of which can be written.
pub(super) fn outputs(args: &RenderArgs) -> Result<Vec<PathBuf>> {
    let mut outputs: Vec<PathBuf> = args.output.iter().map(|path| destination(path)).collect();
    let has_shard = args.checkpoint.is_some() || has_exr(&outputs);
    if args.shard.is_some() {
        if !has_shard {
            return Err(Error::Usage(String::from(
                "--shard writes what lumbre merge puts together: give --checkpoint FILE, or -o FILE.exr, whose merging rounds",
            )));
        }
    } else if outputs.is_empty() {
        let stem = args.scene.scene.file_stem().filter(|stem| *stem != STANDARD_INPUT);
        let stem = PathBuf::from(stem.unwrap_or_else(|| "image".as_ref()));
        outputs = vec![stem.with_extension("exr"), stem.with_extension("png")];
    }
    for path in &outputs {
        format_of(path)?;
        check_writable(path)?;
    }
    args.checkpoint.as_deref().map_or(Ok(()), check_name)?;
    let recording = args.record.as_deref().map(record::files);
    let all = outputs.iter().chain(&args.json).chain(&args.checkpoint).chain(recording.iter().flatten());
    check_apart(all.map(PathBuf::as_path))?;
    // The checkpoint of a shard keeps its layers.
    let is_lost = args.lengths.is_some() && args.shard.is_none();
    if !has_exr(&outputs) && (is_lost || !args.aov.is_empty()) {
        return Err(Error::Usage(String::from(
            "--lengths and --aov write layers of an EXR file: give an output that ends in .exr",
        )));
    }
    check_json(args.json.as_deref())?;
    if let Some(folder) = &args.record {
        record::check_folder(folder)?;
    }
    Ok(outputs)
}

/// Whether one of the outputs is an EXR, which has layers and a header.
pub(super) fn has_exr(outputs: &[PathBuf]) -> bool {
    outputs.iter().any(|path| matches!(format_of(path), Ok(Format::Exr)))
}
