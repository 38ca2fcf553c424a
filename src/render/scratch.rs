//! What techniques with paths from the lights need besides the film: planes of splats, and the vertices of light paths. Both are
//! bounded whatever the image's size: a frame is cut so that it fits.

use super::frames::{Room, slots};
use super::settings::Settings;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{BIDIRECTIONAL_LENGTH, LIGHT_VERTEX_BYTES, LightVertex, WORKGROUP};

/// Bytes of splats that more than one sample per frame may take.
const SPLAT_BYTES: u64 = 64 << 20;
/// Bytes of light paths that more than the least frame may take.
const LIGHT_PATH_BYTES: u64 = 256 << 20;
/// The most samples of a frame: more planes than this save no time.
const MOST_PLANES: u64 = 64;
/// Bytes of one pixel of one layer of a plane: three 64-bit integers.
const SPLAT_PIXEL_BYTES: u64 = 24;

const _: () = assert!(size_of::<LightVertex>() == LIGHT_VERTEX_BYTES as usize);

/// How much there is of each, before anything is allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ScratchSize {
    /// Samples that have a plane of splats; 0 where the technique has none.
    pub planes: u64,
    /// Bytes of all planes.
    pub splat_bytes: u64,
    /// Vertices that a light path has room for.
    pub vertices: u32,
    /// Light paths that have room.
    pub paths: u64,
    /// Bytes of all light paths.
    pub light_path_bytes: u64,
}

impl ScratchSize {
    pub fn of(settings: &Settings) -> Self {
        let row = settings.technique.row;
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        let plane = pixels * u64::from(settings.layers().max(1)) * SPLAT_PIXEL_BYTES;
        let planes = if row.splats { (SPLAT_BYTES / plane).clamp(1, MOST_PLANES) } else { 0 };
        let vertices = if row.light_vertices { light_vertices(settings.max_depth) } else { 0 };
        let path = 4 + u64::from(vertices) * u64::from(LIGHT_VERTEX_BYTES);
        let all = slots(settings.width, settings.height) * planes.max(1);
        let least = u64::from(WORKGROUP) * planes.max(1);
        let paths = if row.light_vertices { (LIGHT_PATH_BYTES / path).max(least).min(all) } else { 0 };
        Self { planes, splat_bytes: planes * plane, vertices, paths, light_path_bytes: paths * path }
    }

    /// What it leaves of frames.
    pub fn room(&self, max_workgroups: u32) -> Room {
        Room {
            slots: max_workgroups.saturating_mul(WORKGROUP).max(WORKGROUP),
            samples: if self.planes > 0 { self.planes as u32 } else { u32::MAX },
            paths: if self.paths > 0 { self.paths } else { u64::MAX },
            whole_passes: self.planes > 0,
        }
    }
}

/// Vertices of a light path that a path from the camera may be connected to: the second one onwards, up to one less than the
/// longest path has segments.
fn light_vertices(max_depth: Option<u32>) -> u32 {
    max_depth.unwrap_or(u32::MAX).min(BIDIRECTIONAL_LENGTH).saturating_sub(2)
}

/// The buffers.
pub(super) struct Scratch {
    pub size: ScratchSize,
    pub splats: Buffer,
    pub light_paths: Buffer,
}

impl Scratch {
    pub fn new(gpu: &Gpu, settings: &Settings) -> Result<Self> {
        let size = ScratchSize::of(settings);
        Ok(Self {
            size,
            splats: Buffer::zeroed(gpu, "splats", size.splat_bytes)?,
            light_paths: Buffer::new(gpu, "light paths", size.light_path_bytes)?,
        })
    }
}
