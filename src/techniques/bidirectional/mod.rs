//! Bidirectional path tracing, and vertex connection and merging.

mod strategies;

pub use strategies::{LONGEST, Strategies, Strategy};
