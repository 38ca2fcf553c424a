//! Textures and their images as shaders take them.

use crate::image::{Texels, TextureImage};
use crate::layout::{
    self, FILTER_NEAREST_BIT, NONE, SECOND_UVS_BIT, TEXELS_FLOAT, TEXELS_LINEAR8, TEXELS_SRGB8, TEXTURE_ATTRIBUTE,
    TEXTURE_CHECKERBOARD, TEXTURE_IMAGE, WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT,
};
use crate::scene::texture::{Pattern, TextureDescription, Wrap};

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

impl TextureDescription {
    /// As shaders take it. `texels` holds the image's index, for which the upload puts the address; `vertices` have attributes.
    pub(super) fn entry(&self, images: &[TextureImage], vertices: usize) -> layout::Texture {
        let wrap = |wrap: Wrap| match wrap {
            Wrap::Repeat => WRAP_REPEAT,
            Wrap::Mirror => WRAP_MIRROR,
            Wrap::Clamp => WRAP_CLAMP,
        };
        let bit = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        let sampling = wrap(self.wrap[0])
            | wrap(self.wrap[1]) << 8
            | bit(self.nearest, FILTER_NEAREST_BIT)
            | bit(self.second_uvs, SECOND_UVS_BIT);
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
                texels: self.squares.map(|square| square.unwrap_or(NONE)),
                scale: [r, g, b, 1.0],
                offset: [p, q, s, 1.0],
                width: 1,
                height: 1,
                levels: 1,
                ..common
            },
            Pattern::Attribute(index) => layout::Texture {
                kind: TEXTURE_ATTRIBUTE,
                texels: [(index * vertices) as u32, 0],
                width: 1,
                height: 1,
                levels: 1,
                scale: self.scale,
                offset: self.offset,
                ..common
            },
        }
    }
}
