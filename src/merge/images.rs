//! Merging EXR images: means by their samples, right to rounding.

use std::path::{Path, PathBuf};

use super::header;
use super::order::{Part, put_in_order};
use crate::checkpoint::Identity;
use crate::error::{Error, Result};
use crate::image::{Image, Picture, read_picture};
use crate::techniques::Shard;

/// The attribute that holds what was rendered, as JSON.
const IDENTITY: &str = "lumbre.identity";
/// The attribute that holds which share of the samples it is, as JSON.
const SHARE: &str = "lumbre.share";
/// What the header of a shard's image says beside its settings.
pub fn header(shard: Shard, identity: &Identity) -> [(String, String); 2] {
    let json = |value: serde_json::Result<String>| value.unwrap_or_default();
    [
        (IDENTITY.to_owned(), json(serde_json::to_string(identity))),
        (SHARE.to_owned(), json(serde_json::to_string(&shard))),
    ]
}

/// Merges images. Returns whether shards are of different devices as well.
pub fn merge(paths: &[PathBuf]) -> Result<(Picture, bool)> {
    let mut parts = Vec::new();
    let mut pictures = Vec::new();
    for path in paths {
        let picture = read_picture(path)?;
        parts.push(part(path, &picture)?);
        pictures.push((path, picture));
    }
    let devices_differ = put_in_order(&mut parts)?;
    let picture_of = |part: &Part| pictures.iter().find(|(path, _)| **path == part.path).map(|(_, picture)| picture);
    let pictures: Vec<(f64, &Picture)> =
        parts.iter().filter_map(|part| Some((f64::from(part.spp), picture_of(part)?))).collect();
    let Some((_, first)) = pictures.first() else {
        return Err(Error::Usage(String::from("there is nothing to merge")));
    };
    for (part, (_, picture)) in parts.iter().zip(&pictures) {
        let names = |picture: &Picture| picture.layers.iter().map(|layer| layer.name.clone()).collect::<Vec<_>>();
        let size = |picture: &Picture| (picture.image.width, picture.image.height);
        if (names(picture), size(picture)) != (names(first), size(first)) {
            return Err(Error::Usage(format!(
                "{} has not the size and layers of {}: all must have the same",
                part.path.display(),
                parts[0].path.display()
            )));
        }
    }
    let image = mean(&pictures, 1, |picture| &picture.image);
    let headers: Vec<&[(String, String)]> = pictures.iter().map(|(_, picture)| picture.header.as_slice()).collect();
    let mut merged = Picture { header: header::merged(&headers, &image), image, layers: first.layers.clone() };
    for (index, layer) in merged.layers.iter_mut().enumerate() {
        let of = |picture: &'_ Picture| picture.layers[index].image.clone();
        let images: Vec<(f64, Image)> = pictures.iter().map(|(weight, picture)| (*weight, of(picture))).collect();
        let images: Vec<(f64, &Image)> = images.iter().map(|(weight, image)| (*weight, image)).collect();
        layer.image = match layer.name.as_str() {
            "variance" => mean(&images, 2, |image| image),
            "samples" => mean(&images, 0, |image| image),
            name if name.ends_with("_id") => continue,
            _ => mean(&images, 1, |image| image),
        };
    }
    Ok((merged, devices_differ))
}

fn part(path: &Path, picture: &Picture) -> Result<Part> {
    let find = |wanted: &str| picture.header.iter().find(|(name, _)| name == wanted).map(|(_, value)| value.as_str());
    let (Some(identity), Some(shard)) = (find(IDENTITY), find(SHARE)) else {
        return Err(Error::Usage(format!(
            "{} is no shard: its header lacks {IDENTITY}; valid are images of lumbre render --shard",
            path.display()
        )));
    };
    let wrong = |name: &str, error: serde_json::Error| Error::read(path, format!("{name} in its header: {error}"));
    let spp = find("lumbre.spp").and_then(|text| text.parse().ok()).unwrap_or_default();
    let identity = serde_json::from_str(identity).map_err(|error| wrong(IDENTITY, error))?;
    let shard: Shard = serde_json::from_str(shard).map_err(|error| wrong(SHARE, error))?;
    let shard = Shard::new(shard.number, shard.of, shard.samples).map_err(|error| Error::read(path, error))?;
    Ok(Part { path: path.to_owned(), identity, shard, spp })
}

/// The sum of images, each times its share of the samples to this power; to the power of 0 it is their sum.
fn mean<T>(all: &[(f64, &T)], power: i32, image: impl Fn(&T) -> &Image) -> Image {
    let total: f64 = all.iter().map(|(weight, _)| weight).sum();
    let Image { width, height, ref pixels } = *image(all[0].1);
    let value = |pixel: usize, channel: usize| {
        let weighted =
            |(weight, own): &(f64, &T)| (weight / total).powi(power) * f64::from(image(own).pixels[pixel][channel]);
        all.iter().map(weighted).sum::<f64>() as f32
    };
    let pixels = (0..pixels.len()).map(|pixel| [0, 1, 2].map(|channel| value(pixel, channel))).collect();
    Image { width, height, pixels }
}
