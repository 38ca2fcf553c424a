//! Sums over blocks of samples, as whole numbers on the device: their sum does not depend on how blocks are divided among machines.
//!
//! Within a block of [`BLOCK_SAMPLES`] samples the film sums in floats, in the order of the samples. After it the pass
//! `shaders/kernels/film/blocks.glsl` adds these sums to 128-bit integers and clears them.

use super::kernel::Kernel;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{BLOCK_SQUARE_BITS, BLOCK_SUM_BITS};
#[allow(unused_imports)] // named by the documentation
use crate::techniques::BLOCK_SAMPLES;
use crate::techniques::Settings;

/// The module, without its backend.
const MODULE: &str = "film/blocks";
/// What the buffer is called.
pub(super) const NAME: &str = "film by blocks";
/// Bytes of a whole number.
const NUMBER_BYTES: u64 = 16;
/// Whole numbers of a pixel besides those of its layers: three channels of samples, of squares, and of differences of the halves.
pub(super) const NUMBERS: usize = 9;

/// Whole numbers of a pixel with so many layers.
pub(super) fn numbers_of_pixel(layers: u32) -> usize {
    NUMBERS + 3 * layers as usize
}

/// Bytes of all whole numbers of an image.
pub(super) fn bytes(pixels: u64, layers: u32) -> u64 {
    NUMBER_BYTES * pixels * numbers_of_pixel(layers) as u64
}

/// Exponents of the units of sums and of squares, each a power of 2, by the unit of splats.
pub(super) fn units(splat_unit: f32) -> [i32; 2] {
    let unit = (splat_unit.to_bits() >> 23 & 0xff) as i32 - 127;
    [unit - BLOCK_SUM_BITS as i32, 2 * unit + BLOCK_SQUARE_BITS as i32]
}

/// A whole number as the device holds it, the lowest word first.
pub(super) type Number = [u32; 4];

/// Its value in units of 2^unit, rounded to the nearest.
pub(super) fn value(number: Number, unit: i32) -> f64 {
    whole(number) as f64 * f64::from(unit).exp2()
}

/// The sum of two.
pub(super) fn sum(a: Number, b: Number) -> Number {
    let sum = whole(a).wrapping_add(whole(b)) as u128;
    [0, 32, 64, 96].map(|bit| (sum >> bit) as u32)
}

fn whole(number: Number) -> i128 {
    number.iter().rev().fold(0u128, |all, word| all << 32 | u128::from(*word)) as i128
}

/// The whole numbers of an image on the device.
pub(super) struct Blocks {
    pub buffer: Buffer,
    /// Whether some block is in them; otherwise they are 0.
    pub any: bool,
    /// Made for the first block: most images of tests and previews have less than one.
    kernel: Option<Kernel>,
}

impl Blocks {
    pub fn new(gpu: &Gpu, settings: &Settings) -> Result<Self> {
        let bytes = bytes(settings.pixels(), settings.layers());
        Ok(Self { buffer: Buffer::zeroed(gpu, NAME, bytes)?, any: false, kernel: None })
    }

    /// The kernel, made beside another one of the rendering where it is not there yet.
    pub fn prepare(&mut self, gpu: &Gpu, settings: &Settings, beside: &Kernel) -> Result<()> {
        if self.kernel.is_none() {
            self.kernel = Some(beside.sibling(gpu, &format!("{MODULE}.{}", settings.backend.name()))?);
        }
        Ok(())
    }

    pub fn kernel(&self) -> Option<&Kernel> {
        self.kernel.as_ref()
    }

    pub fn clear(&mut self) -> Result<()> {
        if self.any {
            self.buffer.clear()?;
        }
        self.any = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_add_up_beyond_each_word() {
        let minus_one = [u32::MAX; 4];
        assert_eq!(value(minus_one, 3), -8.0);
        assert_eq!(sum(minus_one, [1, 0, 0, 0]), [0; 4]);
        assert_eq!(sum([u32::MAX, u32::MAX, 0, 0], [1, 0, 0, 0]), [0, 0, 1, 0]);
        assert_eq!(value([0, 0, 1, 0], -64), 1.0);
    }
}
