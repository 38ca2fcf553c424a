//! Planes of splats: where samples of one frame add up their contributions to pixels other than their own.

use super::settings::Settings;
use super::state::{FrameLimits, StateBytes};
use super::stream::StateStream;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{FIXED_RGB_BYTES, LightSubpathTable, address};

const NAME: &str = "splats";
/// Bytes of splats that more than one sample per frame may take.
const SPLAT_BYTES: u64 = 64 << 20;
/// The most samples of a frame: more planes than this save no time.
const MOST_PLANES: u64 = 64;

/// One plane of the image for each sample of a frame, in integers, so that the order of splats changes no bit. The pass `resolve` adds
/// them to the film and clears them.
pub(super) struct SplatPlanes {
    planes: u64,
    buffer: Buffer,
}

/// Bytes of a plane: the image, or its layers.
fn plane_bytes(settings: &Settings) -> u64 {
    settings.pixels() * u64::from(settings.layers().max(1)) * u64::from(FIXED_RGB_BYTES)
}

impl SplatPlanes {
    /// How many planes frames of several samples have.
    pub fn several(settings: &Settings) -> u64 {
        (SPLAT_BYTES / plane_bytes(settings)).clamp(1, MOST_PLANES)
    }

    /// What they take.
    pub fn bytes(settings: &Settings, planes: u64) -> StateBytes {
        StateBytes::exact(NAME, planes * plane_bytes(settings))
    }

    /// Makes so many, empty.
    pub fn new(gpu: &Gpu, settings: &Settings, planes: u64) -> Result<Self> {
        Ok(Self { planes, buffer: Buffer::zeroed(gpu, NAME, planes * plane_bytes(settings))? })
    }

    /// A frame has no more samples than there are planes; these count once all of the image has them.
    pub fn limits(&self) -> FrameLimits {
        FrameLimits { samples: self.planes as u32, whole_passes: true, ..FrameLimits::NONE }
    }

    /// Writes where they are.
    pub fn describe(&self, table: &mut LightSubpathTable) {
        table.splats = address(self.buffer.address());
    }

    /// Empties them.
    pub fn restart(&self) -> Result<()> {
        self.buffer.clear()
    }

    /// Between passes they are empty.
    pub fn exchange(&self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        match (under_way, stream.restores()) {
            (true, _) => stream.buffer(&self.buffer),
            (false, true) => self.buffer.clear(),
            (false, false) => Ok(()),
        }
    }
}
