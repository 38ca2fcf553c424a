//! Textures: values over texture coordinates, from images or patterns.

use std::path::PathBuf;

use crate::layout::{
    self, FILTER_NEAREST_BIT, TEXELS_FLOAT, TEXELS_LINEAR8, TEXELS_SRGB8, TEXTURE_CHECKERBOARD, TEXTURE_IMAGE,
    WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT,
};
use crate::output::srgb_to_linear;

/// The texels of an image, row by row from the top.
#[derive(Clone, Debug)]
pub enum Texels {
    /// sRGB red, green and blue, linear alpha.
    Srgb8(Vec<[u8; 4]>),
    /// Linear values.
    Linear8(Vec<[u8; 4]>),
    /// Linear values of any size.
    Float(Vec<[f32; 4]>),
}

/// An image that textures show.
#[derive(Clone, Debug)]
pub struct TextureImage {
    /// Where it came from, for messages.
    pub source: PathBuf,
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// Its texels; behind them those of its smaller levels, where it was given any.
    pub texels: Texels,
}

impl TextureImage {
    /// Its format, one of the `TEXELS_*` constants.
    pub fn format(&self) -> u32 {
        match self.texels {
            Texels::Srgb8(_) => TEXELS_SRGB8,
            Texels::Linear8(_) => TEXELS_LINEAR8,
            Texels::Float(_) => TEXELS_FLOAT,
        }
    }

    /// Its texels as the device reads them.
    pub fn bytes(&self) -> &[u8] {
        match &self.texels {
            Texels::Srgb8(texels) | Texels::Linear8(texels) => bytemuck::cast_slice(texels),
            Texels::Float(texels) => bytemuck::cast_slice(texels),
        }
    }

    /// A texel as linear values.
    pub fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        let index = y as usize * self.width as usize + x as usize;
        match &self.texels {
            Texels::Srgb8(texels) => {
                let [r, g, b, a] = texels[index];
                let [r, g, b] = [r, g, b].map(|byte| srgb_to_linear(f32::from(byte) / 255.0));
                [r, g, b, f32::from(a) / 255.0]
            }
            Texels::Linear8(texels) => texels[index].map(|byte| f32::from(byte) / 255.0),
            Texels::Float(texels) => texels[index],
        }
    }

    /// Mean of all its texels as linear values.
    pub fn mean(&self) -> [f64; 4] {
        let mut sum = [0.0f64; 4];
        for y in 0..self.height {
            for x in 0..self.width {
                let texel = self.texel(x, y);
                sum.iter_mut().zip(texel).for_each(|(sum, value)| *sum += f64::from(value));
            }
        }
        let count = f64::from(self.width) * f64::from(self.height);
        sum.map(|sum| sum / count.max(1.0))
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
                format: images[index].format(),
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
