//! The state of a rendering as a stream of little-endian bytes.
//!
//! One function of each part says what belongs to its state, and serves both directions: what is written is what is read.

use std::cell::RefCell;
use std::io::{Read, Write};
use std::path::Path;

use bytemuck::Pod;

use crate::error::{Error, Result};
use crate::gpu::Buffer;

/// Bytes of a buffer that are in the host's memory at once.
const CHUNK: u64 = 16 << 20;

/// Bytes that a stream is filled from, or fills: on the device, or on the host.
pub(crate) trait Store {
    /// What it is called in messages.
    fn name(&self) -> &str;
    /// How many bytes there are.
    fn size(&self) -> u64;
    /// Reads them from `start` on.
    fn read_at(&self, start: u64, out: &mut [u8]) -> Result<()>;
    /// Writes them from `start` on.
    fn upload_at(&self, start: u64, data: &[u8]) -> Result<()>;
    /// Sets all of them to 0.
    fn clear(&self) -> Result<()>;
}

impl Store for Buffer {
    fn name(&self) -> &str {
        Self::name(self)
    }

    fn size(&self) -> u64 {
        Self::size(self)
    }

    fn read_at(&self, start: u64, out: &mut [u8]) -> Result<()> {
        Self::read_at(self, start, out)
    }

    fn upload_at(&self, start: u64, data: &[u8]) -> Result<()> {
        Self::upload_at(self, start, data)
    }

    fn clear(&self) -> Result<()> {
        Self::clear(self)
    }
}

/// Bytes on the host. What is read comes in order, so that memory is taken only for what is there.
pub(crate) struct HostStore {
    size: u64,
    bytes: RefCell<Vec<u8>>,
}

impl HostStore {
    /// So many, each 0.
    pub fn new(size: u64) -> Self {
        Self { size, bytes: RefCell::default() }
    }

    /// The bytes of some values.
    pub fn of<T: Pod>(values: &[T]) -> Self {
        let bytes = bytemuck::cast_slice(values).to_vec();
        Self { size: bytes.len() as u64, bytes: RefCell::new(bytes) }
    }

    /// The bytes as values.
    pub fn values<T: Pod>(&self) -> Vec<T> {
        bytemuck::pod_collect_to_vec(&self.bytes.borrow())
    }
}

impl Store for HostStore {
    fn name(&self) -> &str {
        "film"
    }

    fn size(&self) -> u64 {
        self.size
    }

    fn read_at(&self, start: u64, out: &mut [u8]) -> Result<()> {
        let bytes = self.bytes.borrow();
        let rest = bytes.get(start as usize..).unwrap_or_default();
        let (there, beyond) = out.split_at_mut(rest.len().min(out.len()));
        there.copy_from_slice(&rest[..there.len()]);
        beyond.fill(0);
        Ok(())
    }

    fn upload_at(&self, start: u64, data: &[u8]) -> Result<()> {
        let mut bytes = self.bytes.borrow_mut();
        bytes.truncate(start as usize);
        bytes.extend_from_slice(data);
        Ok(())
    }

    fn clear(&self) -> Result<()> {
        self.bytes.borrow_mut().clear();
        Ok(())
    }
}

/// A stream that a state is saved to, or restored from.
pub struct StateStream<'a> {
    /// The file, for messages.
    file: &'a Path,
    way: Way<'a>,
}

enum Way<'a> {
    Out(&'a mut dyn Write),
    In(&'a mut dyn Read),
}

impl<'a> StateStream<'a> {
    /// Saves to `to`, which messages call `file`.
    pub fn saving(file: &'a Path, to: &'a mut dyn Write) -> Self {
        Self { file, way: Way::Out(to) }
    }

    /// Restores from `from`, which messages call `file`.
    pub fn restoring(file: &'a Path, from: &'a mut dyn Read) -> Self {
        Self { file, way: Way::In(from) }
    }

    /// Whether it restores: what it is shown is overwritten then.
    pub(crate) fn restores(&self) -> bool {
        matches!(self.way, Way::In(_))
    }

    fn bytes(&mut self, bytes: &mut [u8]) -> Result<()> {
        match &mut self.way {
            Way::Out(to) => to.write_all(bytes).map_err(|error| Error::write(self.file, error)),
            Way::In(from) => from.read_exact(bytes).map_err(|error| Error::read(self.file, error)),
        }
    }

    /// 32-bit integers.
    pub(crate) fn numbers<'b>(&mut self, values: impl IntoIterator<Item = &'b mut u32>) -> Result<()> {
        for value in values {
            let mut bytes = value.to_le_bytes();
            self.bytes(&mut bytes)?;
            *value = u32::from_le_bytes(bytes);
        }
        Ok(())
    }

    /// A 64-bit integer.
    pub(crate) fn long(&mut self, value: &mut u64) -> Result<()> {
        let mut bytes = value.to_le_bytes();
        self.bytes(&mut bytes)?;
        *value = u64::from_le_bytes(bytes);
        Ok(())
    }

    /// Numbers in double precision, bit by bit.
    pub(crate) fn reals<'b>(&mut self, values: impl IntoIterator<Item = &'b mut f64>) -> Result<()> {
        for value in values {
            let mut bits = value.to_bits();
            self.long(&mut bits)?;
            *value = f64::from_bits(bits);
        }
        Ok(())
    }

    /// The contents of a buffer, after its size, which must be the same when it is read.
    pub(crate) fn buffer(&mut self, buffer: &dyn Store) -> Result<()> {
        let mut size = buffer.size();
        self.long(&mut size)?;
        self.check(size == buffer.size(), || {
            format!("{size} bytes for the buffer '{}': valid are {}", buffer.name(), buffer.size())
        })?;
        let mut chunk = vec![0; CHUNK.min(size) as usize];
        let mut start = 0;
        while start < size {
            let part = CHUNK.min(size - start) as usize;
            if !self.restores() {
                buffer.read_at(start, &mut chunk[..part])?;
            }
            self.bytes(&mut chunk[..part])?;
            if self.restores() {
                buffer.upload_at(start, &chunk[..part])?;
            }
            start += part as u64;
        }
        Ok(())
    }

    /// Fails where what was read is not valid; the message says what it was, and what is valid.
    pub(crate) fn check(&self, holds: bool, message: impl FnOnce() -> String) -> Result<()> {
        if holds { Ok(()) } else { Err(Error::read(self.file, message())) }
    }
}
