//! Rows of images: all variants after the same time, or at the same number of samples.

use super::results::{Cell, Point, Row, Run};
use super::run::{Bench, Variant};
use super::subject::Stop;
use crate::error::Result;
use crate::image::metrics::{heat_map, heat_scale};
use crate::image::{Image, Picture, write_picture};
use crate::reference::Truth;

/// The image's width and height over those of a crop.
const CROP: u32 = 4;
/// Factor by which crops are enlarged.
const ENLARGED: u32 = 4;

/// One variant's image with its figures.
struct Entry {
    variant: String,
    image: Image,
    point: Point,
}

impl Bench<'_> {
    /// The rows of equal time and of equal samples. One of them is the end of the first run of each variant; for the other,
    /// each variant renders once more.
    pub(super) fn rows(&self, variants: &mut [Variant], runs: &[Vec<Run>]) -> Result<(Option<Row>, Option<Row>)> {
        let mut ends = Vec::new();
        for (variant, runs) in variants.iter().zip(runs) {
            let Some((run, point)) = runs.first().and_then(|run| Some((run, *run.points.last()?))) else {
                return Ok((None, None));
            };
            ends.push(Entry { variant: variant.name.clone(), image: self.image(run)?, point });
        }
        if variants.len() < 2 {
            return Ok((None, None));
        }
        if let Some(seconds) = self.limits.seconds {
            let least = ends.iter().map(|end| end.point.spp).min().unwrap_or(0);
            let spp = u32::try_from(least).unwrap_or(u32::MAX).checked_ilog2().map(|exponent| 1u32 << exponent);
            let equal_spp = spp
                .map(|spp| {
                    let row = self.again(variants, Stop { spp, seconds: None })?;
                    self.row(&row, f64::from(spp), "equal-spp")
                })
                .transpose()?;
            return Ok((Some(self.row(&ends, seconds, "equal-time")?), equal_spp));
        }
        let seconds = ends.iter().map(|end| end.point.seconds).fold(f64::INFINITY, f64::min);
        let row = self.again(variants, Stop { spp: u32::MAX, seconds: Some(seconds) })?;
        let spp = self.limits.spp.map_or(0.0, f64::from);
        Ok((Some(self.row(&row, seconds, "equal-time")?), Some(self.row(&ends, spp, "equal-spp")?)))
    }

    fn again(&self, variants: &mut [Variant], stop: Stop) -> Result<Vec<Entry>> {
        let mut entries = Vec::new();
        for variant in variants {
            variant.subject.begin(0)?;
            let snapshot = variant.subject.advance(stop)?;
            let point = self.truth.point(&snapshot)?;
            entries.push(Entry { variant: variant.name.clone(), image: snapshot.image, point });
        }
        Ok(entries)
    }

    /// Writes the pictures of a row.
    fn row(&self, entries: &[Entry], at: f64, name: &str) -> Result<Row> {
        let corner = crop_corner(entries, self.truth);
        // One scale for all of the row, by its worst image.
        let scales = entries.iter().map(|entry| heat_scale(&entry.image, &self.truth.image));
        let scale = scales.fold(0.0, f64::max).clamp(1e-6, 1.0);
        let mut cells = Vec::new();
        for (index, entry) in entries.iter().enumerate() {
            let write = |what: &str, image: Image| -> Result<String> {
                let file = format!("images/{}-{name}-{index}{what}.png", self.scene);
                let picture = Picture { image, layers: Vec::new(), header: Vec::new() };
                write_picture(&self.folder.join(&file), &picture)?;
                Ok(file)
            };
            cells.push(Cell {
                variant: entry.variant.clone(),
                spp: entry.point.spp as f64,
                seconds: entry.point.seconds,
                relmse: entry.point.relmse,
                picture: write("", entry.image.clone())?,
                crop: write("-crop", crop(&entry.image, corner))?,
                heat_map: write("-heat", heat_map(&entry.image, &self.truth.image, scale))?,
                heat_scale: scale,
            });
        }
        Ok(Row { at, cells })
    }
}

/// The upper left corner of the part in which the images differ most from the reference, without the brightest spots
/// deciding alone.
fn crop_corner(entries: &[Entry], truth: &Truth) -> (u32, u32) {
    let (width, height) = (truth.image.width, truth.image.height);
    let (w, h) = ((width / CROP).max(1), (height / CROP).max(1));
    let error = |x: u32, y: u32| -> f64 {
        let pixel = (y * width + x) as usize;
        let b = truth.image.pixels[pixel];
        entries
            .iter()
            .flat_map(|entry| entry.image.pixels[pixel].into_iter().zip(b))
            .map(|(a, b)| (f64::from(a - b).abs() / (f64::from(b.abs()) + 0.1)).min(1.0))
            .sum()
    };
    let mut best = (f64::NEG_INFINITY, (0, 0));
    for y in (0..=height - h).step_by((h as usize / 2).max(1)) {
        for x in (0..=width - w).step_by((w as usize / 2).max(1)) {
            let sum: f64 = (y..y + h).flat_map(|j| (x..x + w).map(move |i| (i, j))).map(|(i, j)| error(i, j)).sum();
            if sum > best.0 {
                best = (sum, (x, y));
            }
        }
    }
    best.1
}

/// A part of an image, each pixel enlarged to a square.
fn crop(image: &Image, (left, top): (u32, u32)) -> Image {
    let (width, height) = ((image.width / CROP).max(1) * ENLARGED, (image.height / CROP).max(1) * ENLARGED);
    let pixel = |x: u32, y: u32| image.pixels[((top + y / ENLARGED) * image.width + left + x / ENLARGED) as usize];
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    Image { width, height, pixels }
}
