//! What a dispatch is given and what it leaves: push constants and the film.

use super::types::{Member, SharedStruct, uint, uvec2, vec3};
#[allow(unused_imports)] // named by the documentation
use super::{constants::*, scene_structs::*};

shared_structs! {
    /// What changes from one dispatch to the next: the push constants. What belongs to one technique lies in its table.
    pub struct FrameConstants {
        /// Device address of the [`FilmPixel`]s; for kernels over arrays, of what they write.
        film: uvec2,
        /// Device address of the film's layers: for each pixel, `LENGTH_LAYERS` times six floats (sum, its low part); for kernels over
        /// arrays, of what they read.
        layers: uvec2,
        /// Device address of the one [`Tally`].
        tally: uvec2,
        /// Device address of the technique's own table, whose struct its shaders know; 0 where it has none.
        technique: uvec2,
        /// Device address of the [`RecordHeader`](super::RecordHeader), where the paths of a sample are recorded.
        records: uvec2,
        /// First slot of this dispatch: pixels in tiles of 8 x 8, row by row.
        first_slot: uint,
        /// Slots of this dispatch.
        slot_count: uint,
        /// First sample of each pixel in this dispatch.
        first_sample: uint,
        /// Samples of each pixel in this dispatch.
        sample_count: uint,
        /// Seed of the random numbers.
        seed: uint,
        /// A word of the technique's own, whose meaning its state and its shaders agree on.
        word: uint,
    }

    /// Sums over the samples of one pixel: a value is the sum of a float and its low part (Knuth's two-sum).
    pub struct FilmPixel {
        /// Sum of the samples.
        sum: vec3,
        /// Its low part.
        sum_low: vec3,
        /// Sum of their squares.
        squares: vec3,
        /// Its low part.
        squares_low: vec3,
        /// Sum of the samples of even index less that of the others, where the sampler spreads each half by itself.
        difference: vec3,
    }

    /// A sample that was not finite: where it was.
    pub struct BadSample {
        /// Pixel index, y * width + x.
        pixel: uint,
        /// Sample index within the pixel.
        sample_index: uint,
    }

    /// Counters that the host reads and clears after every frame.
    pub struct Tally {
        /// Samples that were dropped because they were not finite; the first [`BAD_SAMPLES`] are listed after it.
        bad_samples: uint,
    }
}

// Every device has 128 bytes of push constants; half of them is enough.
const _: () = assert!(size_of::<FrameConstants>() <= 64);
