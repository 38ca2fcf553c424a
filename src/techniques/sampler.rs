//! The table of samplers: where the uniform numbers that techniques draw come from.
//!
//! A sampler is one row here and its numbers in `shaders/core/rng.glsl`. All of them are pure functions of seed, pixel, sample and
//! dimension, and each number by itself is uniform whatever the sampler: techniques need not know which one they have.

/// Where uniform numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampler {
    /// Independent numbers.
    Independent,
    /// Pairs of a two-dimensional Sobol sequence over a pixel's samples, shuffled and scrambled for each pair (Burley 2020).
    Sobol,
}

/// One sampler's row.
#[derive(Clone, Copy, Debug)]
pub struct SamplerRow {
    /// The sampler that the row describes.
    pub sampler: Sampler,
    /// The sampler's name on the command line (`--sampler`).
    pub name: &'static str,
    /// The sampler in a line, for `lumbre list`.
    pub about: &'static str,
}

/// Every sampler; the first one is the default.
pub const SAMPLERS: &[SamplerRow] = &[
    SamplerRow {
        sampler: Sampler::Independent,
        name: "independent",
        about: "independent numbers; the samples' variance is the error's",
    },
    SamplerRow {
        sampler: Sampler::Sobol,
        name: "sobol",
        about: "Owen-scrambled Sobol pairs: less error at powers of two, and estimates of the error that are too high",
    },
];

impl Sampler {
    /// The sampler's name on the command line.
    pub fn name(self) -> &'static str {
        SAMPLERS.iter().find(|row| row.sampler == self).map_or("", |row| row.name)
    }

    /// The sampler of that name.
    pub fn find(name: &str) -> Option<Self> {
        SAMPLERS.iter().find(|row| row.name == name).map(|row| row.sampler)
    }
}
