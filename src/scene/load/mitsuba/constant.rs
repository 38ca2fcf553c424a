//! Textures that are the same everywhere, which are values like any other.

use super::numbers::numbers;
use super::object::Object;
use super::spectrum::Spectrum;
use super::value::{Colour, Value};
use crate::error::Result;

/// The plugins of these textures.
pub(super) const CONSTANTS: [&str; 7] = ["uniform", "srgb", "d65", "regular", "irregular", "blackbody", "rawconstant"];

/// The value that a texture has everywhere; nothing for those that vary. In RGB, light of the colour of daylight is white.
pub(super) fn value_of(object: &Object) -> Result<Option<Value>> {
    if object.tag != "texture" || !CONSTANTS.contains(&object.plugin.as_str()) {
        return Ok(None);
    }
    let range = || -> Result<[f64; 2]> {
        Ok([object.positive_float("wavelength_min", 360.0)?, object.positive_float("wavelength_max", 830.0)?])
    };
    let list = |name: &'static str| -> Result<Vec<f64>> {
        let text =
            object.optional_text(name)?.ok_or_else(|| object.error(format!("{} needs '{name}'", object.title())))?;
        numbers(text).ok_or_else(|| object.property_error(name, format!("'{text}' is not a list of numbers")))
    };
    let spectrum = |made: Result<Spectrum, String>| {
        made.map(|spectrum| Value::Spectrum(spectrum.into()))
            .map_err(|message| object.error(format!("{}: {message}", object.title())))
    };
    let value = match object.plugin.as_str() {
        "uniform" => {
            range()?; // a value at all wavelengths that are seen
            Value::Float(object.float("value", 1.0)?)
        }
        "srgb" => Value::Rgb(object.colour("color", Colour::Unbounded, 1.0)?),
        "d65" => {
            let scale = object.float("scale", 1.0)?;
            Value::Rgb(object.colour("color", Colour::Unbounded, 1.0)?.map(|channel| channel * scale))
        }
        "rawconstant" => object.raw("value")?,
        "blackbody" => {
            let temperature = object.positive_float("temperature", 5000.0)?;
            spectrum(Spectrum::black_body(temperature, range()?))?
        }
        "regular" if object.has("value") => object.spectrum("value")?,
        "irregular" if object.has("value") => object.spectrum("value")?,
        "regular" => {
            let ([first, last], values) = (range()?, list("values")?);
            let step = (last - first) / (values.len().max(2) - 1) as f64;
            let wavelengths: Vec<f64> = (0..values.len()).map(|index| first + step * index as f64).collect();
            spectrum(Spectrum::from_lists(&wavelengths, &values))?
        }
        _ => spectrum(Spectrum::from_lists(&list("wavelengths")?, &list("values")?))?,
    };
    object.finish()?;
    Ok(Some(value))
}
