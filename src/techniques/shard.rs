//! A share of a rendering's samples, for one of several machines.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Samples that the film sums before it adds their sums, as whole numbers, to those of other blocks. Shards begin where blocks do.
pub const BLOCK_SAMPLES: u32 = 64;

/// One of the parts into which the samples of a rendering are divided by their index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which one, from 1.
    pub number: u32,
    /// How many there are.
    pub of: u32,
    /// Samples of each pixel in all of them together.
    pub samples: u32,
}

impl Shard {
    /// Shard `number` of `of`, of so many samples per pixel. Fails where there is no such one, or one of them had no samples.
    pub fn new(number: u32, of: u32, samples: u32) -> Result<Self> {
        if !(1..=of).contains(&number) {
            return Err(Error::Usage(format!("shard {number}/{of}: valid are K/N with K from 1 to N")));
        }
        let blocks = samples.div_ceil(BLOCK_SAMPLES);
        if of > blocks {
            return Err(Error::Usage(format!(
                "shard {number}/{of} of {samples} samples per pixel: shards are made of blocks of {BLOCK_SAMPLES} samples, of which there are \
                 {blocks}; valid is N up to {blocks}, or -n from {} on",
                u64::from(of - 1) * u64::from(BLOCK_SAMPLES) + 1
            )));
        }
        Ok(Self { number, of, samples })
    }

    /// The index of its first sample.
    pub fn first(self) -> u32 {
        self.boundary(self.number - 1)
    }

    /// How many samples of each pixel it has.
    pub fn count(self) -> u32 {
        self.boundary(self.number) - self.first()
    }

    /// The index of the sample that the shard after this number begins with.
    fn boundary(self, number: u32) -> u32 {
        let blocks = u64::from(self.samples.div_ceil(BLOCK_SAMPLES));
        let block = u64::from(number) * blocks / u64::from(self.of);
        (block * u64::from(BLOCK_SAMPLES)).min(u64::from(self.samples)) as u32
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_all_samples_once_and_none_is_empty() {
        for (of, samples) in [(1, 1), (1, 64), (3, 129), (8, 512), (8, 1000), (7, 449), (1000, u32::MAX)] {
            let mut next = 0;
            for number in 1..=of {
                let shard = Shard::new(number, of, samples).unwrap();
                assert_eq!((shard.first(), shard.first() % BLOCK_SAMPLES), (next, 0));
                assert!(shard.count() > 0, "{shard} of {samples}");
                next = shard.first() + shard.count();
            }
            assert_eq!(next, samples);
        }
        for (number, of, samples) in [(0, 4, 4096), (5, 4, 4096), (1, 0, 4096), (1, 8, 448)] {
            assert!(Shard::new(number, of, samples).is_err());
        }
    }
}
