//! References in EXR files: the image, its variance as a layer, and the certificate in the header.

use std::path::Path;

use super::certificate::{Certificate, SCHEMA};
use super::truth::Truth;
use crate::error::{Error, Result};
use crate::image::{Image, NamedLayer, Picture, read_attribute, read_image, read_layer, write_picture};

/// The name of the EXR layer that holds the variance of each pixel's mean, as `lumbre render --aov variance` writes it.
const VARIANCE: &str = "variance";
/// That of an error of the kind that it has.
const NOISE: &str = "noise";
/// That of the picture of where its witness differs.
const DIFFERENCE: &str = "difference";
/// The attribute of the header that holds the certificate as JSON.
const ATTRIBUTE: &str = "lumbre.certificate";

/// Reads a reference. Its variance is taken from the layer `variance`, and what is known of it from the header, where it has them.
///
/// # Errors
///
/// A file that is no image, is of another size, is black, or has a pixel that is not finite; a certificate that cannot be read.
pub fn read(path: &Path, width: u32, height: u32) -> Result<Truth> {
    let image = read_image(path)?;
    if (image.width, image.height) != (width, height) {
        return Err(Error::Usage(format!(
            "the reference {} has {}x{} pixels and the scene's image {width}x{height}: they must be of one size",
            path.display(),
            image.width,
            image.height
        )));
    }
    if let Some(bad) = image.pixels.iter().position(|pixel| pixel.iter().any(|value| !value.is_finite())) {
        return Err(Error::read(
            path,
            format!("pixel ({}, {}) is not finite: a reference must be", bad as u32 % width, bad as u32 / width),
        ));
    }
    if image.pixels.iter().flatten().all(|value| *value == 0.0) {
        return Err(Error::read(path, "the image is black: nothing can be compared with it"));
    }
    let variance = read_layer(path, VARIANCE)?.filter(|layer| is_variance(layer, width, height));
    let noise = read_layer(path, NOISE)?.filter(|layer| (layer.width, layer.height) == (width, height));
    let truth = Truth::new(image, variance).with_noise(noise);
    let Some(certificate) = read_certificate(path)? else { return Ok(truth) };
    Ok(truth.certified(certificate).with_difference_map(read_layer(path, DIFFERENCE)?))
}

/// The certificate of an image file; nothing where it has none.
///
/// # Errors
///
/// A certificate of another version, or one that is damaged.
pub fn read_certificate(path: &Path) -> Result<Option<Certificate>> {
    let Some(text) = read_attribute(path, ATTRIBUTE)? else { return Ok(None) };
    let bad = |why: String| Error::read(path, format!("its certificate ({ATTRIBUTE}) {why}"));
    let certificate: Certificate =
        serde_json::from_str(&text).map_err(|error| bad(format!("cannot be read: {error}")))?;
    if certificate.schema != SCHEMA {
        return Err(bad(format!("is of the schema '{}': valid is {SCHEMA}", certificate.schema)));
    }
    Ok(Some(certificate))
}

/// Writes a reference with what is known of it.
pub fn write(path: &Path, truth: &Truth) -> Result<()> {
    let layers = [(VARIANCE, &truth.variance), (NOISE, &truth.noise), (DIFFERENCE, &truth.difference_map)];
    let layers = layers
        .into_iter()
        .filter_map(|(name, image)| image.as_ref().map(|image| NamedLayer::colours(name, image.clone())));
    let mut header = Vec::new();
    if let Some(certificate) = &truth.certificate {
        let text = serde_json::to_string(certificate).map_err(|error| Error::write(path, error))?;
        header.push((ATTRIBUTE.to_owned(), ascii(&text)));
    }
    write_picture(path, &Picture { image: truth.image.clone(), layers: layers.collect(), header })
}

/// JSON in characters that the header of an EXR file can hold.
fn ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for character in json.chars() {
        if character.is_ascii() {
            text.push(character);
        } else {
            let mut units = [0; 2];
            character.encode_utf16(&mut units).iter().for_each(|unit| text.push_str(&format!("\\u{unit:04x}")));
        }
    }
    text
}

fn is_variance(layer: &Image, width: u32, height: u32) -> bool {
    (layer.width, layer.height) == (width, height)
        && layer.pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0)
}

#[cfg(test)]
mod tests {
    #[test]
    fn json_stays_the_same_in_ascii() {
        let text = serde_json::to_string("scène 😀.xml").unwrap();
        let plain = super::ascii(&text);
        assert!(plain.is_ascii());
        assert_eq!(serde_json::from_str::<String>(&plain).unwrap(), "scène 😀.xml");
    }
}
