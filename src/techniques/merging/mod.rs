//! What techniques share that merge camera subpaths with light subpaths nearby: photon mapping, vertex connection and merging.

mod grid;
mod radius;

pub(super) use grid::Grid;
pub(super) use radius::MergeRadius;
pub use radius::MergeSchedule;

use super::settings::Settings;

/// Vertices of a light subpath that camera subpaths may be merged with: as many as the longest path has segments, less one, and no more
/// than `most`.
pub(super) fn merged_vertices(settings: &Settings, most: u32) -> u32 {
    most.min(settings.max_depth.unwrap_or(u32::MAX).saturating_sub(1))
}
