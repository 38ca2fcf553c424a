//! What is the most that an image file may claim.

use crate::files::DEFLATE_RATIO;

/// Texels of an image.
pub(super) const TEXELS: u64 = 1 << 28;
/// The longest side of an image.
pub(super) const SIDE: u32 = 1 << 16;

/// Texels that one byte of an EXR file stands for at most: samples have 16 bits or more, and the other compressions stay below
/// that of ZIP.
pub(crate) const EXR_RATIO: u64 = DEFLATE_RATIO / 2;

/// Room is made by what the header of an image says, before any of its data is decoded: says what is wrong where that is too much,
/// or cannot be true of a file of so many bytes, each of which stands for so many texels at most.
pub(crate) fn check_size([width, height]: [u64; 2], bytes: u64, per_byte: u64) -> Result<(), String> {
    let (texels, side) = (width.saturating_mul(height), u64::from(SIDE));
    if width == 0 || height == 0 || width > side || height > side || texels > TEXELS {
        return Err(format!(
            "the image claims {width} x {height} texels: sides of 1 to {SIDE} and {TEXELS} in all are read"
        ));
    }
    if texels > bytes.saturating_mul(per_byte) {
        return Err(format!("the image claims {width} x {height} texels, more than its {bytes} bytes can hold"));
    }
    Ok(())
}
