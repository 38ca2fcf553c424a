//! Numbers in attributes.

use glam::DVec3;

use super::document::Element;
use crate::error::Result;

/// A finite number.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// Finite numbers separated by commas or spaces.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split([',', ' ', '\t', '\n', '\r']).filter(|part| !part.is_empty()).map(number).collect()
}

/// Three numbers as `x`, `y`, `z` or as `value`; what is left out is `default`.
pub(super) fn vector(element: &Element, default: f64) -> Result<DVec3> {
    let wrong =
        |text: &str| element.error(format!("<{}>: '{text}' is not a number (or, as 'value', three)", element.tag));
    if let Some(text) = element.attributes.get("value") {
        return match numbers(text).as_deref() {
            Some([x, y, z]) => Ok(DVec3::new(*x, *y, *z)),
            Some([all]) => Ok(DVec3::splat(*all)),
            _ => Err(wrong(text)),
        };
    }
    let component = |name: &str| match element.attributes.get(name) {
        None => Ok(default),
        Some(text) => number(text).ok_or_else(|| wrong(text)),
    };
    Ok(DVec3::new(component("x")?, component("y")?, component("z")?))
}
