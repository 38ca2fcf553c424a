//! OpenEXR: linear values in 32-bit float, layers by the names of their channels, texts in the header.

use std::collections::BTreeMap;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image as ExrImage, Layer, LayerAttributes,
    ReadChannels, ReadLayers, Text, WritableImage,
};

use super::Image;
use super::limits::{EXR_RATIO, check_size};
use super::picture::{COLOURS, Format, NamedLayer, Picture, format_of};
use crate::error::{Error, Result};
use crate::files::{WriteSeek, open};

/// Writes a picture with its layers and its header, compressed without loss.
pub(super) fn write(file: &mut dyn WriteSeek, picture: &Picture) -> Result<(), String> {
    let mut channels = Vec::new();
    let layers = picture.layers.iter().map(|layer| (format!("{}.", layer.name), layer.channels, &layer.image));
    for (prefix, names, image) in std::iter::once((String::new(), COLOURS, &picture.image)).chain(layers) {
        for (index, channel) in names.iter().enumerate() {
            let samples = image.pixels.iter().map(|pixel| pixel[index]).collect();
            channels.push(AnyChannel::new(text(&format!("{prefix}{channel}")), FlatSamples::F32(samples)));
        }
    }
    let size = (picture.image.width as usize, picture.image.height as usize);
    let mut attributes = LayerAttributes::default();
    for (name, value) in &picture.header {
        attributes.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into()));
    ExrImage::from_layer(layer).write().to_buffered(file).map_err(|error| error.to_string())
}

/// A text of a header: UTF-8, as OpenEXR has it, whose one forbidden character, of code 0, is escaped.
fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.replace('\0', "\\0").as_bytes())
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

/// The R, G and B channels of the first layer that has them.
pub(super) fn read(path: &Path) -> Result<Image> {
    struct Pixels {
        width: usize,
        pixels: Vec<[f32; 3]>,
    }
    check_exr(path)?;
    let image = exr::prelude::read()
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

/// Channels that a layer of a [`Picture`] may have.
const CHANNELS: [&[&str]; 5] = [COLOURS, &["X", "Y", "Z"], &["Z"], &["U", "V"], &["X"]];

/// The first layer of an EXR file that can be read, with all of its channels.
fn first_layer(path: &Path) -> Result<ExrImage<Layer<AnyChannels<FlatSamples>>>> {
    check_exr(path)?;
    exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| Error::read(path, error))
}

/// All of an EXR file that [`Picture`] holds: layers with other channels than its own are left out.
pub fn read_picture(path: &Path) -> Result<Picture> {
    let image = first_layer(path)?;
    let size = image.layer_data.size;
    let mut grouped: BTreeMap<String, Vec<(String, Vec<f32>)>> = BTreeMap::new();
    for channel in &image.layer_data.channel_data.list {
        let name = channel.name.to_string();
        let (layer, letter) = name.rsplit_once('.').unwrap_or(("", &name));
        let values = channel.sample_data.values_as_f32().collect();
        grouped.entry(layer.to_owned()).or_default().push((letter.to_owned(), values));
    }
    let mut layers = Vec::new();
    for (name, own) in grouped {
        let find = |letter: &str| own.iter().find(|(name, _)| name == letter).map(|(_, values)| values);
        let has =
            |letters: &&&[&str]| letters.len() == own.len() && letters.iter().all(|letter| find(letter).is_some());
        let Some(&channels) = CHANNELS.iter().find(has) else { continue };
        let value = |pixel: usize, channel: usize| {
            channels.get(channel).and_then(|letter| find(letter)).map_or(0.0, |values| values[pixel])
        };
        let pixels = (0..size.area()).map(|pixel| [0, 1, 2].map(|channel| value(pixel, channel))).collect();
        let image = Image { width: size.width() as u32, height: size.height() as u32, pixels };
        layers.push(NamedLayer { name, channels, image });
    }
    let at = layers.iter().position(|layer| layer.name.is_empty());
    let Some(at) = at else { return Err(Error::read(path, "it has no channels R, G and B")) };
    let own = &image.layer_data.attributes.other;
    let header = own.iter().filter_map(|(name, value)| Some((name.to_string(), plain(value)?))).collect();
    Ok(Picture { image: layers.remove(at).image, layers, header })
}

/// An attribute of the header that is a text. Other programs may have written one byte for each character.
fn plain(value: &AttributeValue) -> Option<String> {
    let AttributeValue::Text(text) = value else { return None };
    Some(std::str::from_utf8(text.as_slice()).map_or_else(|_| text.to_string(), std::borrow::ToOwned::to_owned))
}

/// The layer `name` of an EXR file: its channels `name.R`, `name.G` and `name.B`. Nothing where it has none, or in another format.
pub fn read_layer(path: &Path, name: &str) -> Result<Option<Image>> {
    if format_of(path)? != Format::Exr {
        return Ok(None);
    }
    let image = first_layer(path)?;
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
    Ok(found.and_then(|(_, value)| plain(value)))
}
