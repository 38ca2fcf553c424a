//! Checkpoints: a rendering that was killed goes on from the last one, and its image has the bits of one that was not.
//!
//! A [`Checkpoints`] is a file and the one before it. The contract and the format are in docs/long_runs.md.

mod files;
mod format;
mod identity;
mod lock;

pub use files::{Checkpoints, Found, check_name, is_checkpoint, read, read_header};
pub use format::Header;
pub use identity::Identity;
