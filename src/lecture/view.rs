//! Pictures as the page shows them.

use crate::image::Image;
use crate::image::metrics::heat_map;

/// A picture of linear values: times the exposure; the file then has the sRGB curve, clamped.
pub fn exposed(image: &Image, exposure: f64) -> Image {
    combined(image, image, |a, _| (f64::from(a) * exposure) as f32)
}

/// What one image has beyond another.
pub fn difference(a: &Image, b: &Image) -> Image {
    combined(a, b, |a, b| a - b)
}

/// The sum of images of one size, rounded once, as the program adds layers up.
pub fn sum(images: &[Image]) -> Option<Image> {
    let first = images.first()?;
    let value = |pixel: usize, channel: usize| {
        images.iter().filter_map(|image| image.pixels.get(pixel)).map(|pixel| f64::from(pixel[channel])).sum::<f64>()
            as f32
    };
    let pixels = (0..first.pixels.len()).map(|pixel| std::array::from_fn(|channel| value(pixel, channel))).collect();
    Some(Image { width: first.width, height: first.height, pixels })
}

fn combined(a: &Image, b: &Image, value: impl Fn(f32, f32) -> f32) -> Image {
    let pixels = a.pixels.iter().zip(&b.pixels);
    let pixels = pixels.map(|(a, b)| std::array::from_fn(|channel| value(a[channel], b[channel])));
    Image { width: a.width, height: a.height, pixels: pixels.collect() }
}

/// A map of the relative difference: blue where too dark, red where too bright, full colour from `scale` on. Noise is averaged
/// over blocks of `block` pixels, so that the map shows what the expectation lacks.
pub fn bias_map(image: &Image, reference: &Image, block: u32, scale: f64) -> Image {
    heat_map(&blocks(image, block), &blocks(reference, block), scale)
}

/// Means of square blocks, each of one pixel.
fn blocks(image: &Image, side: u32) -> Image {
    let (width, height) = (image.width.div_ceil(side).max(1), image.height.div_ceil(side).max(1));
    let mut sums = vec![([0.0f64; 3], 0.0f64); (width * height) as usize];
    for (index, pixel) in (0..).zip(&image.pixels) {
        let (x, y) = (index % image.width / side, index / image.width / side);
        let (sum, count) = &mut sums[(y * width + x) as usize];
        sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += f64::from(*value));
        *count += 1.0;
    }
    let pixels = sums.iter().map(|(sum, count)| sum.map(|sum| (sum / count.max(1.0)) as f32)).collect();
    Image { width, height, pixels }
}

/// The largest difference of any two values.
pub fn largest_difference(a: &Image, b: &Image) -> f64 {
    let pairs = a.pixels.iter().flatten().zip(b.pixels.iter().flatten());
    pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(values: &[f32], width: u32) -> Image {
        Image { width, height: values.len() as u32 / width, pixels: values.iter().map(|value| [*value; 3]).collect() }
    }

    #[test]
    fn maps_average_blocks_and_keep_the_sign() {
        let (a, b) = (image(&[0.0, 2.0, 4.0, 4.0, 0.0, 2.0, 4.0, 4.0], 4), image(&[1.0; 8], 4));
        assert_eq!(blocks(&a, 2).pixels, [[1.0; 3], [4.0; 3]]);
        let map = bias_map(&a, &b, 2, 1.0);
        assert_eq!(map.pixels, [[1.0, 1.0, 1.0], [1.0, 0.0, 0.0]]);
        assert_eq!(bias_map(&b, &a, 3, 0.1).pixels[1], [0.0, 0.0, 1.0]);
    }

    #[test]
    fn sums_differences_and_exposure() {
        let (a, b) = (image(&[1.0, 2.0], 2), image(&[0.5, 0.5], 2));
        assert_eq!(sum(&[a.clone(), b.clone()]).map(|sum| sum.pixels), Some(vec![[1.5; 3], [2.5; 3]]));
        assert_eq!(difference(&a, &b).pixels, [[0.5; 3], [1.5; 3]]);
        assert_eq!(exposed(&a, 4.0).pixels, [[4.0; 3], [8.0; 3]]);
        assert_eq!(largest_difference(&a, &b), 1.5);
    }
}
