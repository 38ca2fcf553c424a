//! Reading files: images to compare, EXR (linear) and PNG (sRGB), and text of bounded size.

use std::path::Path;

use exr::prelude::{ReadChannels, ReadLayers, read};

use crate::error::{Error, Result};
use crate::film::Image;
use crate::output::{Format, format_of, srgb_to_linear};

/// The most pixels that an image may have: a file's header can claim anything.
const MAX_PIXELS: u64 = 1 << 28;

/// The text of a file, unless it has more than `most` bytes.
pub(crate) fn read_text(path: &Path, most: u64) -> Result<String> {
    let bytes = std::fs::metadata(path).map_err(|error| Error::read(path, error))?.len();
    if bytes > most {
        return Err(Error::scene(path, format!("the file has {bytes} bytes, and {most} is the most that is read")));
    }
    std::fs::read_to_string(path).map_err(|error| Error::read(path, error))
}

/// The R, G and B channels of an image as linear values.
pub fn read_image(path: &Path) -> Result<Image> {
    std::fs::metadata(path).map_err(|error| Error::read(path, error))?;
    match format_of(path)? {
        Format::Exr => read_exr(path),
        Format::Png => read_png(path),
    }
}

fn read_exr(path: &Path) -> Result<Image> {
    struct Pixels {
        width: usize,
        pixels: Vec<[f32; 3]>,
    }
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
    if size.area() as u64 > MAX_PIXELS {
        return Err(Error::read(
            path,
            format!("it has {} pixels, and {MAX_PIXELS} is the most that is read", size.area()),
        ));
    }
    Ok(Image { width: size.width() as u32, height: size.height() as u32, pixels })
}

/// The layer `name` of an EXR file: its channels `name.R`, `name.G` and `name.B`. Nothing where it has none, or in another format.
pub fn read_layer(path: &Path, name: &str) -> Result<Option<Image>> {
    if format_of(path)? != Format::Exr {
        return Ok(None);
    }
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

fn read_png(path: &Path) -> Result<Image> {
    let image = image::ImageReader::open(path)
        .map_err(|error| Error::read(path, error))?
        .decode()
        .map_err(|error| Error::read(path, error))?
        .into_rgb32f();
    let pixels = image.pixels().map(|pixel| pixel.0.map(srgb_to_linear)).collect();
    Ok(Image { width: image.width(), height: image.height(), pixels })
}
