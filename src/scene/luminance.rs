//! The luminance of colours.

use crate::layout::LUMINANCE;

/// Relative luminance of a linear sRGB colour (ITU-R BT.709).
pub(in crate::scene) fn luminance(rgb: [f64; 3]) -> f64 {
    LUMINANCE[0] * rgb[0] + LUMINANCE[1] * rgb[1] + LUMINANCE[2] * rgb[2]
}
