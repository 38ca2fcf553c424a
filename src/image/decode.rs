//! Decoding the images that textures show: PNG, JPEG, WebP, BMP, TGA, Radiance HDR and EXR, from files or from memory.

use std::io::Cursor;
use std::path::Path;

use ::image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, read};

use super::limits::{EXR_RATIO, SIDE, TEXELS, check_size};
use super::{Texels, TextureImage, srgb_to_linear};
use crate::error::{Error, Result};
use crate::files::{DEFLATE_RATIO, FILE_BYTES, read_bytes};

/// How the 8-bit values of an image are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Encoding {
    /// As colours, by the sRGB transfer function.
    Srgb,
    /// As numbers.
    Linear,
}

/// Formats beside EXR.
const FORMATS: [ImageFormat; 6] =
    [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP, ImageFormat::Bmp, ImageFormat::Tga, ImageFormat::Hdr];

/// Reads an image file.
pub fn read_texture(path: &Path, encoding: Encoding) -> Result<TextureImage> {
    decode_texture(&read_bytes(path, FILE_BYTES)?, path, encoding)
}

/// Decodes an image; `source` names it in messages.
pub fn decode_texture(bytes: &[u8], source: &Path, encoding: Encoding) -> Result<TextureImage> {
    let wrong = |message: String| Error::scene(source, message);
    let check = |width: u64, height: u64, per_byte: u64| {
        check_size([width, height], bytes.len() as u64, per_byte).map_err(wrong)
    };
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return decode_exr(bytes, source, |width, height| check(width, height, EXR_RATIO));
    }
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| Error::read(source, error))?;
    // A TGA file has no mark of its own.
    if reader.format().is_none() && source.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("tga")) {
        reader.set_format(ImageFormat::Tga);
    }
    let Some(format) = reader.format().filter(|format| FORMATS.contains(format)) else {
        return Err(wrong(String::from(
            "not an image that is read: valid are PNG, JPEG, WebP, BMP, TGA, Radiance HDR and EXR",
        )));
    };
    let mut limits = Limits::default();
    limits.max_image_width = Some(SIDE);
    limits.max_image_height = Some(SIDE);
    limits.max_alloc = Some(16 * TEXELS);
    reader.limits(limits);
    let invalid = |error: ImageError| match error {
        ImageError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            wrong(String::from("not a valid image: the data end too early"))
        }
        error => wrong(format!("not a valid image: {error}")),
    };
    let decoder = reader.into_decoder().map_err(invalid)?;
    let (width, height) = decoder.dimensions();
    let per_byte = match format {
        ImageFormat::Png => 8 * DEFLATE_RATIO / u64::from(decoder.original_color_type().bits_per_pixel()).max(1),
        // A block of 8 x 8 takes one bit at the least.
        ImageFormat::Jpeg => 8 * 64,
        // Codes of no bits: one colour takes a few bytes, whatever its size.
        ImageFormat::WebP => 1 << 20,
        // Runs of 255 and of 128 texels.
        ImageFormat::Bmp | ImageFormat::Tga => 128,
        // Runs of the old form: 12 bytes repeat a texel for longer than a row is.
        _ => u64::from(SIDE) / 12,
    };
    check(u64::from(width), u64::from(height), per_byte)?;
    let image = DynamicImage::from_decoder(decoder).map_err(invalid)?;
    let is_deep = matches!(
        image,
        DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_)
    );
    let is_float = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let texels = if is_float {
        Texels::Float(image.into_rgba32f().pixels().map(|pixel| pixel.0).collect())
    } else if is_deep {
        let decode = |value: f32| if encoding == Encoding::Srgb { srgb_to_linear(value) } else { value };
        let texel = |[r, g, b, a]: [f32; 4]| [decode(r), decode(g), decode(b), a];
        Texels::Float(image.into_rgba32f().pixels().map(|pixel| texel(pixel.0)).collect())
    } else {
        let texels = image.into_rgba8().pixels().map(|pixel| pixel.0).collect();
        if encoding == Encoding::Srgb { Texels::Srgb8(texels) } else { Texels::Linear8(texels) }
    };
    finite(TextureImage { source: source.to_owned(), width, height, texels })
}

fn decode_exr(bytes: &[u8], source: &Path, check: impl Fn(u64, u64) -> Result<()>) -> Result<TextureImage> {
    struct Pixels {
        width: usize,
        pixels: Vec<[f32; 4]>,
    }
    let wrong = |error: exr::error::Error| Error::scene(source, format!("not a valid EXR image: {error}"));
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(wrong)?;
    for header in &meta.headers {
        check(header.layer_size.width() as u64, header.layer_size.height() as u64)?;
    }
    // Threads are started for each image: they cost more than a small one does.
    let is_small = meta.headers.iter().all(|header| header.layer_size.area() < 1 << 18);
    let has = |name: &str| {
        meta.headers
            .iter()
            .any(|header| header.channels.list.iter().any(|channel| channel.name.eq_case_insensitive(name)))
    };
    let new = |size: exr::math::Vec2<usize>| Pixels { width: size.width(), pixels: vec![[0.0; 4]; size.area()] };
    let largest = || read().no_deep_data().largest_resolution_level();
    macro_rules! texels {
        ($channels:expr) => {{
            let reader = $channels.first_valid_layer().all_attributes();
            let reader = if is_small { reader.non_parallel() } else { reader };
            let layer = reader.from_buffered(Cursor::new(bytes)).map_err(wrong)?.layer_data;
            (layer.size, layer.channel_data.pixels.pixels)
        }};
    }
    let (size, texels) = if !has("R") && has("Y") {
        let set = |target: &mut Pixels, at: exr::math::Vec2<usize>, (y, a): (f32, f32)| {
            target.pixels[at.y() * target.width + at.x()] = [y, y, y, a];
        };
        texels!(
            largest()
                .specific_channels()
                .required("Y")
                .optional("A", 1.0f32)
                .collect_pixels(move |size, _| new(size), set)
        )
    } else {
        let set = |target: &mut Pixels, at: exr::math::Vec2<usize>, (r, g, b, a): (f32, f32, f32, f32)| {
            target.pixels[at.y() * target.width + at.x()] = [r, g, b, a];
        };
        texels!(largest().rgba_channels(move |size, _| new(size), set))
    };
    finite(TextureImage {
        source: source.to_owned(),
        width: size.width() as u32,
        height: size.height() as u32,
        texels: Texels::Float(texels),
    })
}

/// Refuses texels that are not finite: one of them would spoil every pixel that sees it.
fn finite(image: TextureImage) -> Result<TextureImage> {
    if let Texels::Float(texels) = &image.texels
        && let Some(bad) = texels.iter().position(|texel| texel.iter().any(|value| !value.is_finite()))
    {
        let (x, y) = (bad as u32 % image.width, bad as u32 / image.width);
        return Err(Error::scene(
            &image.source,
            format!("the texel ({x}, {y}) is {:?}: texels must be finite", texels[bad]),
        ));
    }
    Ok(image)
}
