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

/// The share of the light above the mean, below which an image counts as even.
const EVEN: f64 = 1e-3;

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
            let band = band(cy, cells[1]);
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
    Some((entries(&weights), cells))
}

/// The alias table of cells with these weights, of which one is positive.
fn entries(weights: &[f64]) -> Vec<AliasEntry> {
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    let entry =
        |((keep, alias), weight): ((f32, u32), &f64)| AliasEntry { keep, alias, density: (weight / mean) as f32 };
    alias_table(weights).into_iter().zip(weights).map(entry).collect()
}

/// Solid angle of a cell in a row, over its area in texture coordinates and 2 pi.
fn band(row: u32, rows: u32) -> f64 {
    let theta = |row: f64| std::f64::consts::PI * row / f64::from(rows);
    (theta(f64::from(row)).cos() - theta(f64::from(row) + 1.0).cos()) * f64::from(rows)
}

/// The same table without the mean radiance of all directions: what is darker is never sampled, and left to the BSDF samples that
/// multiple importance sampling combines these with (MIS compensation, Karlik et al. 2019, equation 16). As it is where nothing is brighter
/// than the mean, which is not rounding.
pub(crate) fn compensated(table: &[AliasEntry], [across, down]: [u32; 2]) -> Vec<AliasEntry> {
    let mean = |row: usize| 0.5 * band(row as u32, down);
    let rest =
        |(index, entry): (usize, &AliasEntry)| (f64::from(entry.density) - mean(index / across as usize)).max(0.0);
    let weights: Vec<f64> = table.iter().enumerate().map(rest).collect();
    let share = weights.iter().sum::<f64>() / weights.len() as f64;
    if share < EVEN { table.to_vec() } else { entries(&weights) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The weights of 8 x 6 cells under radiances that a row and a column have.
    fn cells(radiance: impl Fn(u32, u32) -> f64) -> Vec<f64> {
        (0..48).map(|index| radiance(index % 8, index / 8) * band(index / 8, 6)).collect()
    }

    #[test]
    fn compensation_takes_the_mean_radiance_away() {
        let radiance = |x: u32, y: u32| if (x, y) == (3, 1) { 20.0 } else { 0.25 + 0.125 * f64::from(y) };
        let weights = cells(radiance);
        let mean = weights.iter().sum::<f64>() / cells(|_, _| 1.0).iter().sum::<f64>();
        let above = cells(|x, y| (radiance(x, y) - mean).max(0.0));
        let total: f64 = above.iter().sum();
        let found = compensated(&entries(&weights), [8, 6]);
        for (entry, weight) in found.iter().zip(&above) {
            let expected = weight / total * 48.0;
            assert!(
                (f64::from(entry.density) - expected).abs() < 1e-5 * expected.max(1.0),
                "{} {expected}",
                entry.density
            );
        }
        assert_eq!(
            found.iter().filter(|entry| entry.density == 0.0).count(),
            above.iter().filter(|weight| **weight == 0.0).count()
        );
    }

    #[test]
    fn an_even_environment_is_sampled_as_it_is() {
        let table = entries(&cells(|x, _| 1.0 + 1e-7 * f64::from(x)));
        let found = compensated(&table, [8, 6]);
        assert!(table.iter().zip(&found).all(|(one, other)| one.density == other.density));
    }
}
