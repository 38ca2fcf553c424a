//! Images with alpha in the precision of their file, as textures show them.

use std::path::PathBuf;

use super::srgb_to_linear;

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

impl Texels {
    /// Whether some texel's alpha is below 1.
    pub fn has_alpha(&self) -> bool {
        match self {
            Self::Srgb8(texels) | Self::Linear8(texels) => texels.iter().any(|texel| texel[3] < 255),
            Self::Float(texels) => texels.iter().any(|texel| texel[3] < 1.0),
        }
    }

    /// Whether red, green and blue are equal in all texels.
    pub fn is_grey(&self) -> bool {
        match self {
            Self::Srgb8(texels) | Self::Linear8(texels) => texels.iter().all(|[r, g, b, _]| r == g && g == b),
            Self::Float(texels) => texels.iter().all(|[r, g, b, _]| r == g && g == b),
        }
    }
}

impl TextureImage {
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
