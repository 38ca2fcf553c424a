//! Sampling an environment image in proportion to what it sheds.

use glam::DMat3;
use rayon::prelude::*;

use super::alias::alias_table;
use super::light::importance;
use crate::error::{Error, Result};
use crate::image::TextureImage;
use crate::layout::AliasEntry;
use crate::scene::texture::Pattern;
use crate::scene::{Environment, SceneBuilder};

/// The most cells of the table along one side. Larger images share cells.
const MAX_CELLS: u32 = 2048;

/// The environment with the table that it is sampled by; nothing where it is black.
pub(super) fn sampled(
    description: &SceneBuilder,
    texture: u32,
    axes: DMat3,
) -> Result<Option<(Environment, Vec<AliasEntry>)>> {
    let Pattern::Image(image) = description.textures[texture as usize].pattern else {
        return Err(Error::scene(&description.source, "an environment must be an image"));
    };
    let rows = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.normalize().as_vec3().to_array());
    Ok(table(&description.images[image])
        .map(|(table, cells)| (Environment { texture, from_world: rows, cells }, table)))
}

/// An alias table over the cells of an image in latitude and longitude, weighted by luminance and solid angle; with its cells
/// across and down. Nothing where the image is black.
///
/// A cell's weight is the integral of the bilinear interpolation over it, whose kernel along one axis is (1, 6, 1) / 8: it
/// is positive wherever the image sheds light, so that no direction is missed.
fn table(image: &TextureImage) -> Option<(Vec<AliasEntry>, [u32; 2])> {
    let (width, height) = (image.width, image.height);
    let luminance: Vec<f64> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            (0..width).map(move |x| {
                let [r, g, b, _] = image.texel(x, y);
                importance([r, g, b].map(|value| f64::from(value.max(0.0))))
            })
        })
        .collect();
    let at = |x: i64, y: i64| {
        let x = x.rem_euclid(i64::from(width)) as usize;
        let y = y.clamp(0, i64::from(height) - 1) as usize;
        luminance[y * width as usize + x]
    };
    let cells = [width.min(MAX_CELLS), height.min(MAX_CELLS)];
    let weights: Vec<f64> = (0..cells[1])
        .into_par_iter()
        .flat_map_iter(|cy| {
            let span = |cell: u32, cells: u32, texels: u32| {
                let first = u64::from(cell) * u64::from(texels) / u64::from(cells);
                let last = (u64::from(cell + 1) * u64::from(texels)).div_ceil(u64::from(cells));
                first as i64..last as i64
            };
            let theta = |row: f64| std::f64::consts::PI * row / f64::from(cells[1]);
            // Solid angle of a row of cells, per unit of its area in the image.
            let band = theta(f64::from(cy)).cos() - theta(f64::from(cy) + 1.0).cos();
            (0..cells[0]).map(move |cx| {
                let mut sum = 0.0;
                let mut count = 0.0;
                for y in span(cy, cells[1], height) {
                    for x in span(cx, cells[0], width) {
                        for (dy, wy) in [(-1, 0.125), (0, 0.75), (1, 0.125)] {
                            for (dx, wx) in [(-1, 0.125), (0, 0.75), (1, 0.125)] {
                                sum += wx * wy * at(x + dx, y + dy);
                            }
                        }
                        count += 1.0;
                    }
                }
                sum / count * band
            })
        })
        .collect();
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return None;
    }
    let count = weights.len() as f64;
    let entries = alias_table(&weights)
        .into_iter()
        .zip(&weights)
        .map(|((keep, alias), weight)| AliasEntry { keep, alias, density: (weight / total * count) as f32 })
        .collect();
    Some((entries, cells))
}
