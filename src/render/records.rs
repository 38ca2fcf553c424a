//! The buffer that kernels record the paths of a sample in (`shaders/core/record.glsl`).

use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{NONE, PathRecord, RecordHeader};

/// Which records are wanted.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Bit `RECORD_*`: the kinds.
    pub kinds: u32,
    /// The pixel, y * width + x; nothing is all of them.
    pub pixel: Option<u32>,
    /// The sample of each pixel; nothing is all of them.
    pub sample: Option<u32>,
    /// The light subpath that is recorded as well.
    pub light_path: Option<u32>,
    /// The path that is recorded of a chain: the chain, and the mutation that proposed it, 0 of the bootstrap sample that it begins at.
    pub chain_path: Option<[u32; 2]>,
    /// Finished samples are recorded where their largest channel is above this.
    pub threshold: f32,
}

impl Wanted {
    /// No record at all.
    pub const NOTHING: Self =
        Self { kinds: 0, pixel: None, sample: None, light_path: None, chain_path: None, threshold: f32::NEG_INFINITY };
}

/// Records on the device.
pub(super) struct Recorder {
    buffer: Buffer,
    capacity: u32,
}

impl Recorder {
    /// Room for so many records, of which none is wanted yet.
    pub fn new(gpu: &Gpu, capacity: u32) -> Result<Self> {
        let bytes = size_of::<RecordHeader>() as u64 + u64::from(capacity) * size_of::<PathRecord>() as u64;
        let recorder = Self { buffer: Buffer::zeroed(gpu, "records of paths", bytes)?, capacity };
        recorder.want(&Wanted::NOTHING)?;
        Ok(recorder)
    }

    /// The address that kernels get.
    pub fn address(&self) -> u64 {
        self.buffer.address()
    }

    /// Forgets what was recorded, and has this recorded from now on.
    pub fn want(&self, wanted: &Wanted) -> Result<()> {
        let [chain, mutation] = wanted.chain_path.unwrap_or([NONE; 2]);
        let header = RecordHeader {
            count: 0,
            capacity: self.capacity,
            kinds: wanted.kinds,
            pixel: wanted.pixel.unwrap_or(NONE),
            sample_index: wanted.sample.unwrap_or(NONE),
            light_path: wanted.light_path.unwrap_or(NONE),
            chain,
            mutation,
            threshold: wanted.threshold,
        };
        self.buffer.upload(bytemuck::bytes_of(&header))
    }

    /// What has been recorded, each path's records in their order, and how many there was no room for.
    pub fn read(&self) -> Result<(Vec<PathRecord>, u32)> {
        let header: Vec<RecordHeader> = self.buffer.read(1)?;
        let count = header.first().map_or(0, |header| header.count);
        let mut records = vec![PathRecord::default(); count.min(self.capacity) as usize];
        self.buffer.read_at(size_of::<RecordHeader>() as u64, bytemuck::cast_slice_mut(&mut records))?;
        Ok((records, count.saturating_sub(self.capacity)))
    }
}
