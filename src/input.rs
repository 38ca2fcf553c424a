//! Reading files: images to compare, EXR (linear) and PNG (sRGB), and text of bounded size.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use exr::prelude::{ReadChannels, ReadLayers, read};

use crate::error::{Error, Result};
use crate::film::Image;
use crate::output::{Format, format_of, srgb_to_linear};
use crate::scene::image_file::{EXR_RATIO, check_size};

/// Opens a file; folders, devices and pipes, which may have no end, are refused.
pub(crate) fn open(path: &Path) -> Result<File> {
    let meta = std::fs::metadata(path).map_err(|error| Error::read(path, error))?;
    if !meta.is_file() {
        return Err(Error::read(path, "it is not a file"));
    }
    File::open(path).map_err(|error| Error::read(path, error))
}

/// The bytes of a file, unless it has more than `most`.
pub(crate) fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let file = open(path)?;
    let size = file.metadata().map_err(|error| Error::read(path, error))?.len();
    let mut bytes = Vec::new();
    // What is read counts, for a file may grow.
    if size <= most {
        bytes.reserve(size as usize);
        file.take(most + 1).read_to_end(&mut bytes).map_err(|error| Error::read(path, error))?;
    }
    let size = size.max(bytes.len() as u64);
    if size > most {
        return Err(Error::scene(path, format!("the file has {size} bytes, and {most} is the most that is read")));
    }
    Ok(bytes)
}

/// The text of a file, unless it has more than `most` bytes.
pub(crate) fn read_text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read_bytes(path, most)?).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|byte| **byte == b'\n').count() as u32 + 1;
        Error::scene_line(path, line, format!("the file is not text: byte {} is not UTF-8", good.len()))
    })
}

/// The R, G and B channels of an image as linear values.
pub fn read_image(path: &Path) -> Result<Image> {
    std::fs::metadata(path).map_err(|error| Error::read(path, error))?;
    match format_of(path)? {
        Format::Exr => read_exr(path),
        Format::Png => read_png(path),
    }
}

/// Refuses an EXR file that claims to be larger than it can be, before room is made for it.
fn check_exr(path: &Path) -> Result<()> {
    let bytes = open(path)?.metadata().map_err(|error| Error::read(path, error))?.len();
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|error| Error::read(path, error))?;
    meta.headers.iter().try_for_each(|header| {
        let size = [header.layer_size.width() as u64, header.layer_size.height() as u64];
        check_size(size, bytes, EXR_RATIO).map_err(|message| Error::read(path, message))
    })
}

fn read_exr(path: &Path) -> Result<Image> {
    struct Pixels {
        width: usize,
        pixels: Vec<[f32; 3]>,
    }
    check_exr(path)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Pixels { width: size.width(), pixels: vec![[0.0; 3]; size.area()] },
            |target: &mut Pixels, at, (r, g, b): (f32, f32, f32)| {
                target.pixels[at.y() * target.width + at.x()] = [r, g, b]
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| Error::read(path, error))?;
    let size = image.layer_data.size;
    let pixels = image.layer_data.channel_data.pixels.pixels;
    Ok(Image { width: size.width() as u32, height: size.height() as u32, pixels })
}

/// The layer `name` of an EXR file: its channels `name.R`, `name.G` and `name.B`. Nothing where it has none, or in another format.
pub fn read_layer(path: &Path, name: &str) -> Result<Option<Image>> {
    if format_of(path)? != Format::Exr {
        return Ok(None);
    }
    check_exr(path)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| Error::read(path, error))?;
    let (size, channels) = (image.layer_data.size, &image.layer_data.channel_data.list);
    let channel = |letter: &str| {
        let wanted = format!("{name}.{letter}");
        channels.iter().find(|channel| channel.name.to_string() == wanted)
    };
    let (Some(r), Some(g), Some(b)) = (channel("R"), channel("G"), channel("B")) else { return Ok(None) };
    let values = [r, g, b].map(|channel| channel.sample_data.values_as_f32().collect::<Vec<f32>>());
    let pixels = (0..size.area()).map(|pixel| [values[0][pixel], values[1][pixel], values[2][pixel]]).collect();
    Ok(Some(Image { width: size.width() as u32, height: size.height() as u32, pixels }))
}

/// A text in the header of an EXR file. Nothing where it has none of that name, or in another format.
pub fn read_attribute(path: &Path, name: &str) -> Result<Option<String>> {
    if format_of(path)? != Format::Exr {
        return Ok(None);
    }
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|error| Error::read(path, error))?;
    let found = meta.headers.iter().flat_map(|header| &header.own_attributes.other).find(|(own, _)| **own == *name);
    Ok(found.and_then(|(_, value)| match value {
        exr::meta::attribute::AttributeValue::Text(text) => Some(text.to_string()),
        _ => None,
    }))
}

fn read_png(path: &Path) -> Result<Image> {
    let image = image::ImageReader::open(path)
        .map_err(|error| Error::read(path, error))?
        .decode()
        .map_err(|error| Error::read(path, error))?
        .into_rgb32f();
    let pixels = image.pixels().map(|pixel| pixel.0.map(srgb_to_linear)).collect();
    Ok(Image { width: image.width(), height: image.height(), pixels })
}
