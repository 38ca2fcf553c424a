//! Bidirectional path tracing, and vertex connection and merging.

mod connecting;
mod merging;
mod strategies;

pub(super) use connecting::Connecting;
pub(super) use merging::ConnectingAndMerging;
pub use strategies::{LONGEST, Strategies, Strategy};
