//! Writing images: EXR in 32-bit float, PNG in sRGB. A file is replaced only when the new one is complete.

use std::fs::{File, Permissions};
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image as ExrImage, Layer, LayerAttributes, Text,
    WritableImage,
};

use crate::error::{Error, Result};
use crate::file_lock::{Claim, claim};
use crate::film::Image;

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
    /// Its channels are `name.R`, `name.G` and `name.B`.
    pub name: String,
    /// Its values.
    pub image: Image,
}

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

/// The format that a file name asks for.
pub fn format_of(path: &Path) -> Result<Format> {
    match path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).as_deref() {
        Some("exr") => Ok(Format::Exr),
        Some("png") => Ok(Format::Png),
        _ => Err(Error::Usage(format!("{}: the extension of an output must be .exr or .png", path.display()))),
    }
}

/// Fails if a file could not be written there, without touching what is there now.
pub fn check_writable(path: &Path) -> Result<()> {
    let refused = |cause: &str| Error::Usage(format!("cannot write {}: {cause}", path.display()));
    if path.is_dir() {
        return Err(refused("it is a folder"));
    }
    match path.parent() {
        Some(folder) if folder != Path::new("") && !folder.is_dir() => {
            Err(refused(&format!("there is no folder {}", folder.display())))
        }
        _ => temporary_beside(path).map(|_| ()).map_err(|error| Error::Usage(error.to_string())),
    }
}

/// Writes a picture in the format that the file name asks for.
pub fn write_picture(path: &Path, picture: &Picture) -> Result<()> {
    let format = format_of(path)?;
    replace_file(path, |file| match format {
        Format::Exr => write_exr(file, picture),
        Format::Png => write_png(file, &picture.image),
    })
}

/// Writes a file beside its final place and moves it there once it is complete.
pub fn replace_file(path: &Path, write: impl FnOnce(&mut dyn WriteSeek) -> Result<(), String>) -> Result<()> {
    let mut file = temporary_beside(path)?;
    {
        let mut buffered = std::io::BufWriter::new(file.as_file_mut());
        write(&mut buffered).map_err(|cause| Error::write(path, cause))?;
        buffered.flush().map_err(|error| Error::write(path, error))?;
    }
    file.as_file().sync_all().map_err(|error| Error::write(path, error))?;
    file.persist(path).map_err(|error| Error::write(path, error.error))?;
    Ok(())
}

/// What image encoders write to.
pub trait WriteSeek: Write + Seek {}
impl<T: Write + Seek> WriteSeek for T {}

/// The folder that a file lies in.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// What the names of files begin with that are not complete yet, and how many characters follow.
const PARTIAL: &str = ".lumbre-";
const PARTIAL_CHARACTERS: usize = 6;

/// A file that is locked for as long as this process writes it: the system undoes that when the process ends, however it ends, which tells
/// whose files nobody will complete.
fn temporary_beside(path: &Path) -> Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder_of(path);
    remove_remains(&folder);
    loop {
        let file = tempfile::Builder::new()
            .prefix(PARTIAL)
            .rand_bytes(PARTIAL_CHARACTERS)
            .permissions(Permissions::from_mode(0o666)) // less what the umask takes away
            .tempfile_in(&folder)
            .map_err(|error| Error::write(path, error.kind()))?;
        // Between these two another process may have taken it for remains. Where nothing can be locked, nothing is removed either.
        if claim(file.as_file(), file.path()).map_or(true, |claim| claim == Claim::Held) {
            return Ok(file);
        }
    }
}

/// Removes what processes left that were killed while they wrote. That it cannot be removed is no reason not to write.
fn remove_remains(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let rest = name.to_str().and_then(|name| name.strip_prefix(PARTIAL));
        if rest.is_none_or(|rest| rest.len() != PARTIAL_CHARACTERS)
            || !entry.file_type().is_ok_and(|kind| kind.is_file())
        {
            continue;
        }
        let Ok(file) = File::options().append(true).open(entry.path()) else { continue };
        if claim(&file, &entry.path()).is_ok_and(|claim| claim == Claim::Held) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// An sRGB value of 0..255 for a linear one (IEC 61966-2-1).
pub fn srgb_byte(linear: f32) -> u8 {
    let c = if linear.is_finite() { linear.clamp(0.0, 1.0) } else { 0.0 };
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

/// The linear value of an sRGB one in 0..1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The PNG file of an image.
pub(crate) fn png_of(image: &Image) -> Result<Vec<u8>, String> {
    let mut file = std::io::Cursor::new(Vec::new());
    write_png(&mut file, image)?;
    Ok(file.into_inner())
}

fn write_png(file: &mut dyn WriteSeek, image: &Image) -> Result<(), String> {
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.map(srgb_byte)).collect();
    let encoder = image::codecs::png::PngEncoder::new(file);
    image::ImageEncoder::write_image(encoder, &bytes, image.width, image.height, image::ExtendedColorType::Rgb8)
        .map_err(|error| error.to_string())
}

fn write_exr(file: &mut dyn WriteSeek, picture: &Picture) -> Result<(), String> {
    let text = |text: &str| Text::new_or_none(text).ok_or_else(|| format!("'{text}' cannot be in an EXR header"));
    let mut channels = Vec::new();
    let images = std::iter::once((String::new(), &picture.image))
        .chain(picture.layers.iter().map(|layer| (format!("{}.", layer.name), &layer.image)));
    for (prefix, image) in images {
        for (index, channel) in ["R", "G", "B"].into_iter().enumerate() {
            let samples = image.pixels.iter().map(|pixel| pixel[index]).collect();
            channels.push(AnyChannel::new(text(&format!("{prefix}{channel}"))?, FlatSamples::F32(samples)));
        }
    }
    let size = (picture.image.width as usize, picture.image.height as usize);
    let mut attributes = LayerAttributes::default();
    for (name, value) in &picture.header {
        attributes.other.insert(text(name)?, AttributeValue::Text(text(value)?));
    }
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into()));
    ExrImage::from_layer(layer).write().to_buffered(file).map_err(|error| error.to_string())
}
