//! A technique that renders independent images of a scene, for a series.

use super::candidates::Candidate;
use super::series::Series;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::image::Image;
use crate::render::{Renderer, Settings};
use crate::scene::Scene;
use crate::techniques::MergeSchedule;

/// Seconds of one rendering, at most where a sample is not longer: so often progress is heard of, and can be kept.
const LONGEST: f64 = 4.0;

/// Factor on the radius of what is blurred: noise can be taken off an error and blur cannot, so there is to be less of that than would be
/// best for an image.
const FINER: f32 = 0.8;

/// A technique on a scene.
pub(super) struct Runner {
    renderer: Renderer,
    is_consistent: bool,
    /// Seeds of its renderings begin here.
    seeds: u32,
    /// Seconds that one sample of all pixels takes.
    pub seconds_per_sample: f64,
}

impl Runner {
    /// Makes the kernels. `seconds_per_sample` may be 0 where it is to be found out, by [`Runner::calibrate`].
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        candidate: &Candidate,
        seeds: u32,
        seconds_per_sample: f64,
    ) -> Result<Self> {
        let settings =
            Settings { max_depth: candidate.max_depth, ..settings.for_technique(candidate.technique.clone()) };
        let renderer = Renderer::new(gpu, scene, &settings)?;
        Ok(Self { renderer, is_consistent: candidate.is_consistent, seeds, seconds_per_sample })
    }

    /// Renders for about so many seconds, to find out what a sample takes.
    pub fn calibrate(&mut self, seconds: f64) -> Result<()> {
        self.renderer.restart(self.seeds)?;
        let mut target = 1;
        loop {
            while self.renderer.advance(target)? {}
            if self.renderer.seconds().render >= seconds || target >= 1 << 20 {
                break;
            }
            target *= 2;
        }
        self.seconds_per_sample = (self.renderer.seconds().render / f64::from(target)).max(1e-9);
        Ok(())
    }

    /// An empty series with as many images as so many seconds have room for, 4 to `most`.
    pub fn series(&self, seconds: f64, most: usize) -> Series {
        let settings = self.renderer.settings();
        let room = (seconds / self.seconds_per_sample) as usize;
        // An even number: the images of a blurred series go by twos.
        let images = room.clamp(4, most.max(4)) / 2 * 2;
        Series::new(settings.width, settings.height, images, self.is_consistent)
    }

    /// Goes on with a series until it has taken so many seconds, and each image has a sample. `hear` is told the seconds after each
    /// rendering.
    pub fn extend(
        &mut self,
        series: &mut Series,
        seconds: f64,
        hear: &mut dyn FnMut(&Series) -> Result<()>,
    ) -> Result<()> {
        let share = ((seconds - series.seconds) / series.images.len() as f64).min(LONGEST);
        let samples = ((share / self.seconds_per_sample) as u32).max(1);
        let expected = f64::from(samples) * self.seconds_per_sample;
        while series.count() < series.images.len() || series.seconds + 0.5 * expected < seconds {
            let index = series.next();
            let (image, took) = self.render(series, index, samples, hear)?;
            series.add(index, &image, f64::from(samples));
            series.renderings += 1;
            series.seconds += took;
            hear(series)?;
        }
        Ok(())
    }

    fn render(
        &mut self,
        series: &Series,
        index: usize,
        samples: u32,
        hear: &mut dyn FnMut(&Series) -> Result<()>,
    ) -> Result<(Image, f64)> {
        let count = series.images.len() as u32;
        let before = series.samples[index] as u32;
        let coarse = series.is_blurred && index % 2 == 1;
        self.renderer.set_merge_schedule(MergeSchedule {
            first: before.saturating_mul(count).saturating_add(index as u32),
            stride: count,
            scale: if coarse { FINER * std::f32::consts::SQRT_2 } else { FINER },
        });
        // The first seed was spent on finding out what a sample takes.
        self.renderer.restart(self.seeds.wrapping_add(1 + series.renderings))?;
        while self.renderer.advance(samples)? {
            hear(series)?;
        }
        Ok((self.renderer.film()?.mean(), self.renderer.seconds().render))
    }
}
