//! Shards of a rendering, put together: sums are added, and what does not belong together is refused by name.
//!
//! Checkpoints give the bits of one run, because their sums over blocks of samples are whole numbers ([`crate::render::SavedFilm`]); images hold
//! rounded means, whose mean by samples is right to rounding.

mod header;
pub mod images;
mod order;
mod sums;

use std::path::{Path, PathBuf};

pub use header::names;
pub use order::Part;
pub use sums::{Merged, merge};

use crate::checkpoint::is_checkpoint;
use crate::error::{Error, Result};

/// What is to be said of techniques whose samples depend on the ones before.
pub const CHAINS_ARE_OWN: &str =
    "the chains of each shard are its own: merged shards are statistically equal to one run, and have other bits";

/// What files are to be merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Checkpoints of shards.
    Checkpoints,
    /// EXR images of shards.
    Images,
    /// Folders of `lumbre bench`.
    Benches,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Checkpoints => "a checkpoint",
            Self::Images => "an image",
            Self::Benches => "a bench's folder",
        }
    }

    fn of(path: &Path) -> Result<Self> {
        if path.is_dir() {
            return Ok(Self::Benches);
        }
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
            return Ok(Self::Images);
        }
        if is_checkpoint(path)? {
            return Ok(Self::Checkpoints);
        }
        Err(Error::Usage(format!(
            "{} cannot be merged: valid are checkpoints and EXR images of lumbre render --shard, and folders of lumbre bench",
            path.display()
        )))
    }
}

/// What all of these files are; fails where they differ.
pub fn kind(paths: &[PathBuf]) -> Result<Kind> {
    let mut kinds = paths.iter().map(|path| Kind::of(path).map(|kind| (path, kind)));
    let Some(first) = kinds.next() else { return Err(Error::Usage(String::from("there is nothing to merge"))) };
    let (first, kind) = first?;
    for other in kinds {
        let (other, its) = other?;
        if its != kind {
            return Err(Error::Usage(format!(
                "{} is {}, and {} {}: merge files of one kind",
                first.display(),
                kind.name(),
                other.display(),
                its.name()
            )));
        }
    }
    Ok(kind)
}
