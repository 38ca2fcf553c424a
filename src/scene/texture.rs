//! Textures: values over texture coordinates, from images or patterns.

use crate::image::{Texels, TextureImage, srgb_to_linear};
use crate::layout::{
    self, FILTER_NEAREST_BIT, TEXELS_FLOAT, TEXELS_LINEAR8, TEXELS_SRGB8, TEXTURE_CHECKERBOARD, TEXTURE_IMAGE,
    WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT,
};

impl Texels {
    /// Their format for the device, one of the `TEXELS_*` constants.
    pub fn format(&self) -> u32 {
        match self {
            Self::Srgb8(_) => TEXELS_SRGB8,
            Self::Linear8(_) => TEXELS_LINEAR8,
            Self::Float(_) => TEXELS_FLOAT,
        }
    }
}

/// The 256 values of an sRGB byte, which shaders look up.
pub fn srgb_table() -> Vec<f32> {
    (0..=255u8).map(|byte| srgb_to_linear(f32::from(byte) / 255.0)).collect()
}

/// What coordinates outside of an image show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image mirrored.
    Mirror,
    /// Its edge.
    Clamp,
}

/// What a texture shows.
#[derive(Clone, Copy, Debug)]
pub enum Pattern {
    /// An image, by its index.
    Image(usize),
    /// Squares of two colours: half of the unit square along each axis.
    Checkerboard([f32; 3], [f32; 3]),
}

/// A texture.
#[derive(Clone, Copy, Debug)]
pub struct TextureDescription {
    /// What it shows.
    pub pattern: Pattern,
    /// What lies outside of an image, across and down.
    pub wrap: [Wrap; 2],
    /// The nearest texel instead of bilinear interpolation.
    pub nearest: bool,
    /// What a scalar takes of it: channel 0 to 3, or 4 for luminance.
    pub channel: u32,
    /// Rows of the map from the surface's coordinates to the texture's.
    pub map: [[f32; 3]; 2],
    /// Factor on its values.
    pub scale: [f32; 4],
    /// Added to them.
    pub offset: [f32; 4],
}

impl TextureDescription {
    /// A texture of this pattern: repeated, bilinear, as it is.
    pub fn new(pattern: Pattern) -> Self {
        Self {
            pattern,
            wrap: [Wrap::Repeat; 2],
            nearest: false,
            channel: 4,
            map: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            scale: [1.0; 4],
            offset: [0.0; 4],
        }
    }

    /// As shaders take it. `texels` holds the image's index, for which the upload puts the address.
    pub(super) fn entry(&self, images: &[TextureImage]) -> layout::Texture {
        let wrap = |wrap: Wrap| match wrap {
            Wrap::Repeat => WRAP_REPEAT,
            Wrap::Mirror => WRAP_MIRROR,
            Wrap::Clamp => WRAP_CLAMP,
        };
        let sampling = wrap(self.wrap[0]) | wrap(self.wrap[1]) << 8 | if self.nearest { FILTER_NEAREST_BIT } else { 0 };
        let common = layout::Texture {
            sampling,
            channel: self.channel,
            row_u: self.map[0],
            row_v: self.map[1],
            ..layout::Texture::default()
        };
        match self.pattern {
            Pattern::Image(index) => layout::Texture {
                kind: TEXTURE_IMAGE,
                format: images[index].texels.format(),
                texels: [index as u32, 0],
                width: images[index].width,
                height: images[index].height,
                levels: 1,
                scale: self.scale,
                offset: self.offset,
                ..common
            },
            Pattern::Checkerboard([r, g, b], [p, q, s]) => layout::Texture {
                kind: TEXTURE_CHECKERBOARD,
                scale: [r, g, b, 1.0],
                offset: [p, q, s, 1.0],
                width: 1,
                height: 1,
                levels: 1,
                ..common
            },
        }
    }
}
