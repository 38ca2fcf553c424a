//! What a rendering is to come to.

use std::path::PathBuf;

/// What to do, checked before anything is rendered.
pub(super) struct Job {
    pub outputs: Vec<PathBuf>,
    pub spp: u32,
    pub time: Option<f64>,
}
