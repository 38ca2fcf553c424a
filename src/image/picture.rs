//! What an image file holds, and the format that its name asks for.

use std::path::Path;

use super::Image;
use crate::error::{Error, Result};
use crate::files::is_stream;

/// A format that images are written in, by the extension of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: linear, 32-bit float, with layers and the settings in its header.
    Exr,
    /// PNG: sRGB, 8 bits, clamped to 0..1.
    Png,
}

/// An image with a name: a further layer of an EXR file.
#[derive(Clone, Debug)]
pub struct NamedLayer {
    /// Its channels are `name.R`, `name.G` and `name.B`, or what [`NamedLayer::channels`] says.
    pub name: String,
    /// Their names, of which there are as many as of the pixels' values are written: 1 to 3.
    pub channels: &'static [&'static str],
    /// Its values.
    pub image: Image,
}

impl NamedLayer {
    /// A layer of colours.
    pub fn colours(name: impl Into<String>, image: Image) -> Self {
        Self { name: name.into(), channels: COLOURS, image }
    }
}

/// The channels of a colour.
pub(super) const COLOURS: &[&str] = &["R", "G", "B"];

/// What an image file holds.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The image itself.
    pub image: Image,
    /// Further layers; EXR only.
    pub layers: Vec<NamedLayer>,
    /// Names and values for the header; EXR only.
    pub header: Vec<(String, String)>,
}

/// Fails where a file name does not ask for the only format that `what` is written in.
pub fn check_format(path: &Path, what: &str, format: Format) -> Result<()> {
    if format_of(path).is_ok_and(|own| own == format) {
        return Ok(());
    }
    let extension = match format {
        Format::Exr => "an .exr",
        Format::Png => "a .png",
    };
    Err(Error::Usage(format!("{}: {what} is {extension}", path.display())))
}

/// The format that a file name asks for. Devices and pipes, whose names nobody chooses, get EXR.
pub fn format_of(path: &Path) -> Result<Format> {
    match path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).as_deref() {
        Some("exr") => Ok(Format::Exr),
        Some("png") => Ok(Format::Png),
        None if is_stream(path) => Ok(Format::Exr),
        _ => Err(Error::Usage(format!("{}: the extension of an output must be .exr or .png", path.display()))),
    }
}
