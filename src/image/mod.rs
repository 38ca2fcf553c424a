//! Images: linear pixels, sRGB, their files, and [figures](metrics) of how far two of them are apart.

mod decode;
mod exr;
mod file;
mod limits;
pub mod metrics;
mod picture;
mod png;
mod srgb;
mod texels;

pub use decode::{Encoding, decode_texture, read_texture};
pub use exr::{read_attribute, read_layer, read_picture};
pub use file::{read_image, write_picture};
pub use picture::{Format, NamedLayer, Picture, check_format, format_of};
pub(crate) use png::png_of;
pub use srgb::{srgb_byte, srgb_table, srgb_to_linear};
pub use texels::{Texels, TextureImage};

/// An image of linear RGB, row by row from the upper left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// One colour per pixel.
    pub pixels: Vec<[f32; 3]>,
}

impl Image {
    /// Feeds its size and the bits of its pixels to a hash.
    pub fn hash_pixels(&self, hasher: &mut impl std::hash::Hasher) {
        hasher.write_u32(self.width);
        hasher.write_u32(self.height);
        hasher.write(bytemuck::cast_slice(&self.pixels));
    }

    /// The average over all pixels, per channel.
    pub fn average(&self) -> [f64; 3] {
        let count = self.pixels.len().max(1) as f64;
        std::array::from_fn(|channel| self.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / count)
    }
}
