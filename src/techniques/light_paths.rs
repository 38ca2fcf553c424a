//! The store of light subpaths: their vertices, for camera subpaths to be connected to or to be merged with.

use super::settings::Settings;
use super::state::{FrameLimits, StateBytes};
use super::stream::StateStream;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{LightSubpathTable, WORKGROUP, address};

const NAME: &str = "light paths";
/// Bytes of light subpaths that more than the least frame may take.
const LIGHT_PATH_BYTES: u64 = 256 << 20;

/// How many light subpaths have room, and how much. It is bounded whatever the image's size: a frame is cut so that its subpaths fit, or
/// a sample has fewer of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LightPathSize {
    /// Light subpaths that have room.
    pub paths: u64,
    /// Vertices that each has room for.
    pub vertices: u32,
    /// Bytes of a subpath: the number of its vertices, and these.
    path_bytes: u64,
}

impl LightPathSize {
    /// Subpaths for the camera subpaths of the same slots and samples of a frame, which has up to so many samples.
    pub fn of_frame(settings: &Settings, vertices: u32, vertex_bytes: usize, samples: u64) -> Self {
        let path_bytes = path_bytes(vertices, vertex_bytes);
        let (all, least) = (settings.slots() * samples, u64::from(WORKGROUP) * samples);
        Self { paths: (LIGHT_PATH_BYTES / path_bytes).max(least).min(all), vertices, path_bytes }
    }

    /// Subpaths for all camera subpaths of one sample: as many as are wanted, where there is room.
    pub fn of_sample(wanted: u64, vertices: u32, vertex_bytes: usize) -> Self {
        let path_bytes = path_bytes(vertices, vertex_bytes);
        Self { paths: (LIGHT_PATH_BYTES / path_bytes).min(wanted), vertices, path_bytes }
    }

    /// What they take.
    pub fn bytes(self) -> StateBytes {
        StateBytes::exact(NAME, self.paths * self.path_bytes)
    }

    /// Places for vertices.
    pub fn places(self) -> u64 {
        self.paths * u64::from(self.vertices)
    }

    /// A frame has no more pixel samples than there is room for subpaths.
    pub fn limits(self) -> FrameLimits {
        FrameLimits { pixel_samples: self.paths, ..FrameLimits::NONE }
    }
}

fn path_bytes(vertices: u32, vertex_bytes: usize) -> u64 {
    4 + u64::from(vertices) * vertex_bytes as u64
}

/// The vertices of light subpaths on the device.
pub(super) struct LightPathStore {
    pub size: LightPathSize,
    buffer: Buffer,
}

impl LightPathStore {
    /// Room for them; what it holds is undefined.
    pub fn new(gpu: &Gpu, size: LightPathSize) -> Result<Self> {
        Ok(Self { size, buffer: Buffer::new(gpu, NAME, size.paths * size.path_bytes)? })
    }

    /// Writes where they are.
    pub fn describe(&self, table: &mut LightSubpathTable) {
        table.light_paths = address(self.buffer.address());
        table.light_vertices = self.size.vertices;
    }

    /// Between passes they are of no further use.
    pub fn exchange(&self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        if under_way { stream.buffer(&self.buffer) } else { Ok(()) }
    }
}
