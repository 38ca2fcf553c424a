//! PNG: 8 bits per channel, sRGB.

use std::path::Path;

use super::{Image, srgb_byte, srgb_to_linear};
use crate::error::{Error, Result};
use crate::files::WriteSeek;

/// The PNG file of an image.
pub(crate) fn png_of(image: &Image) -> Result<Vec<u8>, String> {
    let mut file = std::io::Cursor::new(Vec::new());
    write(&mut file, image)?;
    Ok(file.into_inner())
}

/// Writes an image, clamped to 0..1.
pub(super) fn write(file: &mut dyn WriteSeek, image: &Image) -> Result<(), String> {
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.map(srgb_byte)).collect();
    let encoder = ::image::codecs::png::PngEncoder::new(file);
    ::image::ImageEncoder::write_image(encoder, &bytes, image.width, image.height, ::image::ExtendedColorType::Rgb8)
        .map_err(|error| error.to_string())
}

/// The red, green and blue of a file as linear values.
pub(super) fn read(path: &Path) -> Result<Image> {
    let image = ::image::ImageReader::open(path)
        .map_err(|error| Error::read(path, error))?
        .decode()
        .map_err(|error| Error::read(path, error))?
        .into_rgb32f();
    let pixels = image.pixels().map(|pixel| pixel.0.map(srgb_to_linear)).collect();
    Ok(Image { width: image.width(), height: image.height(), pixels })
}
