//! Writing the outputs, so that a rendering of hours is not lost to a disk that is full or a folder that went away.

use std::path::{Path, PathBuf};

use lumbre::error::{Error, Result};
use lumbre::image::{Format, Picture, format_of, write_picture};
use lumbre::render::film::Film;

use super::keep::CheckpointWriter;
use super::pyramid;
use crate::cli::output::say;

/// Writes all outputs, also where one of them fails. Fails with the first error then, and says where the rendering is kept: in its
/// checkpoint, or, without one, as an image in the folder for temporary files.
pub(super) fn write_outputs(
    outputs: &[PathBuf],
    film: &Film,
    picture: &Picture,
    keeper: &CheckpointWriter,
) -> Result<()> {
    let mut first = None;
    for path in outputs {
        if let Err(error) = write_output(path, film, picture)
            && let Some(earlier) = first.replace(error)
        {
            say!("error: {earlier}");
        }
    }
    let Some(cause) = first else { return Ok(()) };
    let kept = keeper.kept().unwrap_or_else(|| rescue(picture));
    Err(Error::Stopped { cause: Box::new(cause), kept })
}

fn write_output(path: &Path, film: &Film, picture: &Picture) -> Result<()> {
    if let Some(folder) = path.parent().filter(|folder| *folder != Path::new("") && !folder.exists()) {
        // It was there when the rendering began.
        std::fs::create_dir_all(folder).map_err(|error| Error::write(path, error))?;
        say!("warning: the folder {} went away and was made again", folder.display());
    }
    let pyramid = if format_of(path)? == Format::Png { pyramid::pyramid(film) } else { None };
    match pyramid {
        Some(image) => write_picture(path, &Picture { image, layers: Vec::new(), header: Vec::new() }),
        None => write_picture(path, picture),
    }
}

/// Writes the picture where there may be room; says what came of it.
fn rescue(picture: &Picture) -> String {
    let path = std::env::temp_dir().join(format!("lumbre-{}.exr", std::process::id()));
    match write_picture(&path, picture) {
        Ok(()) => format!("the image is kept in {}", path.display()),
        Err(error) => format!("the image is lost: {error}"),
    }
}
