//! The transfer function of sRGB (IEC 61966-2-1).

/// An sRGB value of 0..255 for a linear one (IEC 61966-2-1).
pub fn srgb_byte(linear: f32) -> u8 {
    let c = if linear.is_finite() { linear.clamp(0.0, 1.0) } else { 0.0 };
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

/// The linear value of an sRGB one in 0..1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The 256 values of an sRGB byte, which shaders look up.
pub fn srgb_table() -> Vec<f32> {
    (0..=255u8).map(|byte| srgb_to_linear(f32::from(byte) / 255.0)).collect()
}
