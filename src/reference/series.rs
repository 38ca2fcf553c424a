//! Independent images of one expectation: what a mean, and how well it is known, are made of.

use crate::image::Image;

/// Independent images of the same expectation, each the mean of renderings with seeds of their own.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The images.
    pub images: Vec<Vec<[f32; 3]>>,
    /// Samples per pixel of each.
    pub samples: Vec<f64>,
    /// Seconds that rendering them took.
    pub seconds: f64,
    /// Renderings that they are made of.
    pub renderings: u32,
    /// Whether every other one, from the second on, is blurred by a radius that is larger by the root of two.
    pub is_blurred: bool,
}

impl Series {
    /// With room for so many images, which have no samples yet.
    pub fn new(width: u32, height: u32, images: usize, is_blurred: bool) -> Self {
        let (images, samples) = (vec![Vec::new(); images], vec![0.0; images]);
        Self { width, height, images, samples, is_blurred, ..Self::default() }
    }

    /// Adds a rendering to the image with that index.
    pub fn add(&mut self, index: usize, image: &Image, samples: f64) {
        let (own, count) = (&mut self.images[index], &mut self.samples[index]);
        *count += samples;
        if own.is_empty() {
            own.clone_from(&image.pixels);
            return;
        }
        let share = (samples / *count) as f32;
        for (mean, value) in own.iter_mut().flatten().zip(image.pixels.iter().flatten()) {
            *mean += share * (value - *mean);
        }
    }

    /// The image that has the fewest samples, which gets the next ones.
    pub fn next(&self) -> usize {
        let least = self.samples.iter().copied().fold(f64::INFINITY, f64::min);
        self.samples.iter().position(|samples| *samples == least).unwrap_or(0)
    }

    /// Those of its images that have samples, with their weights, which sum to 1.
    pub fn weighted(&self) -> impl Iterator<Item = (f64, &[[f32; 3]])> {
        let total = self.spp();
        let parts = self.images.iter().zip(&self.samples).filter(|(_, samples)| **samples > 0.0);
        parts.map(move |(image, samples)| (samples / total, image.as_slice()))
    }

    /// How many images have samples.
    pub fn count(&self) -> usize {
        self.samples.iter().filter(|samples| **samples > 0.0).count()
    }

    /// Samples per pixel of all together.
    pub fn spp(&self) -> f64 {
        self.samples.iter().sum()
    }

    fn image_of(&self, value: impl Fn(usize, usize) -> f64) -> Image {
        let pixels = (0..(self.width * self.height) as usize)
            .map(|pixel| std::array::from_fn(|channel| value(pixel, channel) as f32));
        Image { width: self.width, height: self.height, pixels: pixels.collect() }
    }

    /// The mean of all samples.
    pub fn mean(&self) -> Image {
        let parts: Vec<_> = self.weighted().collect();
        self.image_of(|pixel, channel| {
            parts.iter().map(|(weight, image)| weight * f64::from(image[pixel][channel])).sum()
        })
    }

    /// The variance of each pixel of that mean, from the scatter of the images; 0 where there is but one.
    pub fn variance(&self) -> Image {
        let parts: Vec<_> = self.weighted().collect();
        let values =
            |pixel: usize, channel: usize| parts.iter().map(move |(w, image)| (*w, f64::from(image[pixel][channel])));
        self.image_of(|pixel, channel| variance_of_mean(values(pixel, channel)))
    }

    /// Half of the difference of the means of two halves of its images: one more error of the kind that the mean has. Each half has as many
    /// blurred images. Nothing below four images.
    pub fn noise(&self) -> Option<Image> {
        let parts: Vec<_> = self.weighted().collect();
        if parts.len() < 4 {
            return None;
        }
        let in_first = |index: usize| index % 4 < 2;
        let total = |first: bool| -> f64 {
            parts.iter().enumerate().filter(|(index, _)| in_first(*index) == first).map(|(_, (weight, _))| weight).sum()
        };
        let weights = [total(true), total(false)];
        // Half, where both have as many samples.
        let scale = (weights[0] * weights[1]).sqrt();
        Some(self.image_of(|pixel, channel| {
            let terms = parts.iter().enumerate().map(|(index, (weight, image))| {
                let sign = if in_first(index) { 1.0 / weights[0] } else { -1.0 / weights[1] };
                scale * sign * weight * f64::from(image[pixel][channel])
            });
            terms.sum()
        }))
    }

    /// Mixes series that have as many images as the first one, which there must be, with a weight for each pixel; the weights of a pixel
    /// sum to 1. What comes out are independent images again.
    pub fn mixed(parts: &[(&Self, Vec<f32>)]) -> Self {
        let (first, _) = parts[0];
        let mix = |index: usize| -> Vec<[f32; 3]> {
            let pixel = |pixel: usize| {
                let value = |channel: usize| {
                    parts.iter().map(|(series, weights)| weights[pixel] * series.images[index][pixel][channel]).sum()
                };
                std::array::from_fn(value)
            };
            (0..first.images[index].len()).map(pixel).collect()
        };
        Self {
            images: (0..first.images.len()).map(mix).collect(),
            samples: first.samples.clone(),
            seconds: parts.iter().map(|(series, _)| series.seconds).sum(),
            is_blurred: parts.iter().any(|(series, _)| series.is_blurred),
            ..*first
        }
    }
}

/// The variance of a weighted mean of independent values whose variances are in inverse proportion to the weights, which sum to 1.
pub(super) fn variance_of_mean(values: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let count = values.clone().count();
    if count < 2 {
        return 0.0;
    }
    let mean: f64 = values.clone().map(|(weight, value)| weight * value).sum();
    values.map(|(weight, value)| weight * (value - mean).powi(2)).sum::<f64>() / (count - 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_weighs_by_samples_and_the_variance_is_that_of_the_mean() {
        let image = |value: f32| Image { width: 1, height: 1, pixels: vec![[value; 3]] };
        let mut series = Series::new(1, 1, 3, false);
        series.add(0, &image(1.0), 2.0);
        series.add(1, &image(3.0), 2.0);
        assert_eq!((series.next(), series.count()), (2, 2));
        assert_eq!(series.mean().pixels[0][0], 2.0);
        // (1 + 1) / 1 of single ones, halved.
        assert_eq!(series.variance().pixels[0][0], 1.0);
        series.add(1, &image(5.0), 2.0);
        // 2 of the first, 4 with the mean 4 of the second.
        assert_eq!(series.mean().pixels[0][0], 3.0);
        assert!(series.noise().is_none(), "two images have no halves");
    }

    #[test]
    fn the_noise_of_halves_is_that_of_the_mean() {
        let mut random = crate::statistics::random::Normal::new(2);
        let mut series = Series::new(64, 64, 16, false);
        for index in 0..16 {
            let pixels = (0..64 * 64).map(|_| [5.0 + random.next() as f32; 3]).collect();
            series.add(index, &Image { width: 64, height: 64, pixels }, 4.0);
        }
        let square = |image: &Image, mean: f32| {
            image.pixels.iter().map(|pixel| (pixel[0] - mean).powi(2)).sum::<f32>() / (64.0 * 64.0)
        };
        // 1/16 each, known to 2 %.
        for found in [square(&series.mean(), 5.0), square(&series.noise().unwrap(), 0.0)] {
            assert!((found * 16.0 - 1.0).abs() < 0.1, "{found}");
        }
    }
}
