//! The table of samplers: where the uniform numbers that techniques draw come from.
//!
//! A sampler is one row here and its numbers in `shaders/core/rng.glsl`. All of them are pure functions of seed, pixel, sample and
//! dimension, and each number by itself is uniform whatever the sampler: techniques need not know which one they have.

use super::table::{Correlated, TechniqueRow};

/// Where uniform numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampler {
    /// Independent numbers.
    Independent,
    /// Pairs of a two-dimensional Sobol sequence over each half of a pixel's samples, shuffled and scrambled for each pair (Burley 2020). The
    /// halves are independent, so that their difference tells the error.
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

/// Every sampler; the first one is the default of most techniques.
pub const SAMPLERS: &[SamplerRow] = &[
    SamplerRow {
        sampler: Sampler::Sobol,
        name: "sobol",
        about: "Owen-scrambled Sobol pairs in two independent halves, by which the error is known; least error at powers of two",
    },
    SamplerRow {
        sampler: Sampler::Independent,
        name: "independent",
        about: "independent numbers; the samples' variance is the error's. The only one for Markov chains",
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

impl TechniqueRow {
    /// The samplers that it can take, its default first: a Markov chain draws its numbers by itself.
    pub fn samplers(&self) -> &'static [SamplerRow] {
        if self.correlated == Correlated::Samples {
            let is_independent = |row: &SamplerRow| row.sampler == Sampler::Independent;
            let at = SAMPLERS.iter().position(is_independent).unwrap_or(0);
            return &SAMPLERS[at..=at];
        }
        SAMPLERS
    }
}
