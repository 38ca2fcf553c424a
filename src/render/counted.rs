//! What a rendering counts besides the film.

use crate::error::Result;
use crate::layout::BAD_SAMPLES;
use crate::render::film::BadSample;
use crate::techniques::StateStream;

/// What a rendering has counted so far.
#[derive(Clone, Debug, Default)]
pub struct Counted {
    /// Rays traced.
    pub rays: u64,
    /// Samples that were not finite and were dropped.
    pub nonfinite: u64,
    /// Where the first of them were.
    pub bad_samples: Vec<BadSample>,
    /// Seconds of all frames by the host's clock, and by the device's.
    pub seconds: [f64; 2],
}

impl Counted {
    /// Saves it to a stream, or restores it.
    pub(super) fn exchange(&mut self, stream: &mut StateStream) -> Result<()> {
        stream.long(&mut self.rays)?;
        stream.long(&mut self.nonfinite)?;
        let mut count = self.bad_samples.len() as u32;
        stream.numbers([&mut count])?;
        stream.check(count <= BAD_SAMPLES, || format!("{count} bad samples: valid are 0 to {BAD_SAMPLES}"))?;
        self.bad_samples.resize(count as usize, BadSample { x: 0, y: 0, sample: 0 });
        for bad in &mut self.bad_samples {
            stream.numbers([&mut bad.x, &mut bad.y, &mut bad.sample])?;
        }
        stream.reals(&mut self.seconds)
    }

    /// Takes in the places of samples that were dropped, as far as there is room for them.
    pub(super) fn locate(&mut self, located: impl IntoIterator<Item = BadSample>) {
        let room = (BAD_SAMPLES as usize).saturating_sub(self.bad_samples.len());
        self.bad_samples.extend(located.into_iter().take(room));
    }

    /// Adds what another part of the rendering has counted.
    pub fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.nonfinite += other.nonfinite;
        self.locate(other.bad_samples.iter().copied());
        self.seconds.iter_mut().zip(other.seconds).for_each(|(sum, seconds)| *sum += seconds);
    }
}
