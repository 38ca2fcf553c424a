//! Smaller copies of images (mip maps; Williams 1983, "Pyramidal parametrics"), for paths that see many texels at once.
//!
//! A texture is looked up in them only where the BSDF is linear in it, so that the mean of the texture gives the mean of what
//! it reflects: colours, tints, and the weights of lobes. Left out are roughness and normal and bump maps, whose means make
//! another surface (the mean of many slopes is a mirror); masks and the weights of blends, which a path meets by chance: a
//! chance of the mean has the same variance as a mean of chances, so nothing is won; and what asks for the nearest texel.

use rayon::prelude::*;

use crate::image::{Texels, TextureImage, srgb_byte, srgb_table};
use crate::layout::{FILTER_NEAREST_BIT, PROPERTIES, PropertyTexture, TEXTURE_IMAGE, Texture};

/// Levels of a chain from an image of this size down to one texel, the image itself included.
pub fn level_count(width: u32, height: u32) -> u32 {
    width.max(height).max(1).ilog2() + 1
}

/// Half of a side, and at least one texel.
fn half(side: u32) -> u32 {
    (side / 2).max(1)
}

/// A linear value in 0..1 as a byte.
fn unit_byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Which texels of a side of `from` a texel of a side of `to` covers, and by what share of itself each: two halves where
/// `from` is even, three parts where it is odd.
fn taps(from: u32, to: u32) -> Vec<Vec<(usize, f32)>> {
    let scale = f64::from(from) / f64::from(to);
    (0..to)
        .map(|texel| {
            let (begin, end) = (f64::from(texel) * scale, (f64::from(texel) + 1.0) * scale);
            (begin.floor() as u32..(end.ceil() as u32).min(from))
                .map(|i| (i as usize, (end.min(f64::from(i) + 1.0) - begin.max(f64::from(i))) / scale))
                .filter(|(_, share)| *share > 1e-9)
                .map(|(i, share)| (i, share as f32))
                .collect()
        })
        .collect()
}

/// The next level: each texel is the mean of the area that it covers.
fn halve(size: [u32; 2], texel: impl Fn(usize) -> [f32; 4] + Sync) -> ([u32; 2], Vec<[f32; 4]>) {
    let [width, height] = size;
    let smaller = [half(width), half(height)];
    let (across, down) = (taps(width, smaller[0]), taps(height, smaller[1]));
    let mut level = vec![[0.0; 4]; smaller[0] as usize * smaller[1] as usize];
    level.par_chunks_mut(smaller[0] as usize).zip(&down).for_each(|(row, down)| {
        for (out, across) in row.iter_mut().zip(&across) {
            for (y, share_y) in down {
                for (x, share_x) in across {
                    let value = texel(y * width as usize + x);
                    out.iter_mut().zip(value).for_each(|(sum, value)| *sum += share_y * share_x * value);
                }
            }
        }
    });
    (smaller, level)
}

/// Appends an image's smaller levels to its texels, each behind the one before, in the same format. Each is made from the one
/// before as it was before rounding.
pub fn append_levels(image: &mut TextureImage) {
    let mut size = [image.width, image.height];
    let mut above: Option<Vec<[f32; 4]>> = None;
    for _ in 1..level_count(image.width, image.height) {
        let (smaller, level) = match &above {
            Some(above) => halve(size, |index| above[index]),
            None => match &image.texels {
                Texels::Float(texels) => halve(size, |index| texels[index]),
                Texels::Linear8(texels) => halve(size, |index| texels[index].map(|byte| f32::from(byte) / 255.0)),
                Texels::Srgb8(texels) => {
                    let decode = srgb_table();
                    halve(size, |index| {
                        let [r, g, b, a] = texels[index];
                        let [r, g, b] = [r, g, b].map(|byte| decode[usize::from(byte)]);
                        [r, g, b, f32::from(a) / 255.0]
                    })
                }
            },
        };
        match &mut image.texels {
            Texels::Float(texels) => texels.extend(&level),
            Texels::Linear8(texels) => texels.par_extend(level.par_iter().map(|texel| texel.map(unit_byte))),
            Texels::Srgb8(texels) => texels.par_extend(level.par_iter().map(|[r, g, b, a]| {
                let [r, g, b] = [*r, *g, *b].map(srgb_byte);
                [r, g, b, unit_byte(*a)]
            })),
        }
        size = smaller;
        above = Some(level);
    }
}

/// Gives levels to the images of all textures that materials are linear in, and tells those textures.
pub(super) fn add(images: &mut [TextureImage], textures: &mut [Texture], uses: &[PropertyTexture]) {
    let mut filtered = vec![false; images.len()];
    for own in uses.iter().filter(|own| PROPERTIES[own.property as usize].linear) {
        let texture = &mut textures[own.texture as usize];
        if texture.kind == TEXTURE_IMAGE && texture.sampling & FILTER_NEAREST_BIT == 0 {
            texture.levels = level_count(texture.width, texture.height);
            filtered[texture.texels[0] as usize] |= texture.levels > 1;
        }
    }
    images.iter_mut().zip(filtered).filter(|(_, filtered)| *filtered).for_each(|(image, _)| append_levels(image));
}
