//! What a rendering is to write, checked before any work.

use std::path::{Path, PathBuf};

use lumbre::error::{Error, Result};
use lumbre::files::{STANDARD_INPUT, check_writable};
use lumbre::image::{Format, format_of};

use super::super::output::check_json;
use super::args::RenderArgs;

/// The outputs, each of which can be written.
pub(super) fn outputs(args: &RenderArgs) -> Result<Vec<PathBuf>> {
    let stdout = Path::new("/dev/stdout");
    let named = |path: &PathBuf| if path == Path::new(STANDARD_INPUT) { stdout.to_owned() } else { path.clone() };
    let mut outputs: Vec<PathBuf> = args.output.iter().map(named).collect();
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
    if let Some(path) = args.checkpoint.as_deref().filter(|path| outputs.iter().any(|output| output == path)) {
        return Err(Error::Usage(format!("{} cannot be an output and the checkpoint as well", path.display())));
    }
    // The checkpoint of a shard keeps its layers.
    let is_lost = args.lengths.is_some() && args.shard.is_none();
    if !has_exr(&outputs) && (is_lost || !args.aov.is_empty()) {
        return Err(Error::Usage(String::from(
            "--lengths and --aov write layers of an EXR file: give an output that ends in .exr",
        )));
    }
    check_json(args.json.as_deref())?;
    if let Some(folder) = &args.record {
        std::fs::create_dir_all(folder).map_err(|error| Error::write(folder, error))?;
    }
    Ok(outputs)
}

/// Whether one of the outputs is an EXR, which has layers and a header.
pub(super) fn has_exr(outputs: &[PathBuf]) -> bool {
    outputs.iter().any(|path| matches!(format_of(path), Ok(Format::Exr)))
}
