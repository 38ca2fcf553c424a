//! Image files by the extension of their name: EXR (linear, with layers and a header) and PNG (sRGB).

use std::path::Path;

use super::picture::{Format, Picture, format_of};
use super::{Image, exr, png};
use crate::error::{Error, Result};
use crate::files::replace_file;

/// Writes a picture in the format that the file name asks for.
pub fn write_picture(path: &Path, picture: &Picture) -> Result<()> {
    let format = format_of(path)?;
    replace_file(path, |file| match format {
        Format::Exr => exr::write(file, picture),
        Format::Png => png::write(file, &picture.image),
    })
}

/// The R, G and B channels of an image as linear values.
pub fn read_image(path: &Path) -> Result<Image> {
    std::fs::metadata(path).map_err(|error| Error::read(path, error))?;
    match format_of(path)? {
        Format::Exr => exr::read(path),
        Format::Png => png::read(path),
    }
}
