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
/// Bytes of the whole numbers of a pixel in a plane: three channels.
const PIXEL_BYTES: u64 = 3 * 16;
/// Planes besides those of layers: of samples, of squares, and of differences of the halves.
pub(super) const PLANES: usize = 3;

/// How many planes there are. Each is an allocation of its own: all in one would be larger than some devices allow, where the film is not.
pub(super) fn planes(layers: u32) -> usize {
    PLANES + layers as usize
}

/// Bytes of a plane of an image.
pub(super) fn plane_bytes(pixels: u64) -> u64 {
    PIXEL_BYTES * pixels
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
    pub planes: Vec<Buffer>,
    /// Whether some block is in them; otherwise they are 0.
    pub any: bool,
    /// Made for the first block: most images of tests and previews have less than one.
    kernel: Option<Kernel>,
}

impl Blocks {
    pub fn new(gpu: &Gpu, settings: &Settings) -> Result<Self> {
        let plane = |_| Buffer::zeroed(gpu, NAME, plane_bytes(settings.pixels()));
        let planes = (0..planes(settings.layers())).map(plane).collect::<Result<_>>()?;
        Ok(Self { planes, any: false, kernel: None })
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

    /// All whole numbers, plane by plane; none where there is no block.
    pub fn read(&self, pixels: usize) -> Result<Vec<Number>> {
        let mut all = Vec::new();
        for plane in self.planes.iter().filter(|_| self.any) {
            all.append(&mut plane.read(3 * pixels)?);
        }
        Ok(all)
    }

    pub fn clear(&mut self) -> Result<()> {
        if self.any {
            self.planes.iter().try_for_each(Buffer::clear)?;
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
