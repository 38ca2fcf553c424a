//! Device memory: buffers, uploads through staging, and readback.

use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};

use super::device::Gpu;
use super::omission::{Step, omits};
use crate::error::{Bytes, Error, Result};

/// Bytes that one staging copy moves: bounds the host memory of an upload of any size.
const STAGING_BYTES: u64 = 32 << 20;

/// A buffer on the device, reached by its address. Freed when dropped.
pub struct Buffer {
    gpu: Gpu,
    pub(super) raw: vk::Buffer,
    allocation: Option<Allocation>,
    size: u64,
    address: u64,
    name: String,
    counted: bool,
}

impl Buffer {
    /// An uninitialised buffer of `size` bytes (at least four are allocated) in the device's own memory.
    pub fn new(gpu: &Gpu, name: &str, size: u64) -> Result<Self> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::UNIFORM_BUFFER;
        Self::with_usage(gpu, name, size, usage, MemoryLocation::GpuOnly)
    }

    /// A buffer that holds `data`.
    pub fn with_data<T: Pod>(gpu: &Gpu, name: &str, data: &[T]) -> Result<Self> {
        let buffer = Self::new(gpu, name, size_of_val(data) as u64)?;
        buffer.upload(bytemuck::cast_slice(data))?;
        Ok(buffer)
    }

    /// A buffer of the elements of `data` in the order of `indices`.
    pub fn gathered<T: Pod>(gpu: &Gpu, name: &str, data: &[T], indices: &[u32]) -> Result<Self> {
        Self::generated(gpu, name, indices.len(), |slot| data[indices[slot] as usize])
    }

    /// A buffer of `count` elements, each of which `element` makes.
    pub fn generated<T: Pod>(gpu: &Gpu, name: &str, count: usize, element: impl Fn(usize) -> T) -> Result<Self> {
        let size = size_of::<T>();
        let buffer = Self::new(gpu, name, (size * count) as u64)?;
        buffer.fill((size * count) as u64, size as u64, |offset, bytes| {
            for (out, slot) in bytes.chunks_exact_mut(size).zip(offset as usize / size..) {
                out.copy_from_slice(bytemuck::bytes_of(&element(slot)));
            }
        })?;
        Ok(buffer)
    }

    /// A buffer of several arrays, one after the other.
    pub fn concatenated<T: Pod>(gpu: &Gpu, name: &str, parts: &[Vec<T>]) -> Result<Self> {
        let total: usize = parts.iter().map(|part| size_of_val(part.as_slice())).sum();
        let buffer = Self::new(gpu, name, total as u64)?;
        let mut start = 0;
        for part in parts {
            let bytes: &[u8] = bytemuck::cast_slice(part);
            buffer.upload_at(start, bytes)?;
            start += bytes.len() as u64;
        }
        Ok(buffer)
    }

    /// A buffer of `size` zero bytes.
    pub fn zeroed(gpu: &Gpu, name: &str, size: u64) -> Result<Self> {
        let buffer = Self::new(gpu, name, size)?;
        buffer.clear()?;
        Ok(buffer)
    }

    pub(super) fn with_usage(
        gpu: &Gpu,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Self> {
        let size = size.max(4).next_multiple_of(4);
        let out_of_memory = |limit: String| Error::OutOfMemory {
            what: format!("'{name}'"),
            needs: size,
            in_use: gpu.bytes_in_use(),
            limit,
        };
        let max = gpu.limits().max_allocation;
        if size > max {
            return Err(out_of_memory(format!("; one allocation may have {} on this device", Bytes(max))));
        }
        if gpu.shared.fault.refuses_buffer() {
            return Err(out_of_memory(String::from(" (asked for by a test)")));
        }
        let mut usage = usage
            | vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS
            | vk::BufferUsageFlags::TRANSFER_SRC
            | vk::BufferUsageFlags::TRANSFER_DST;
        if omits(Step::AddressUsage) {
            usage &= !vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS;
        }
        if omits(Step::StructureInput) {
            usage &= !vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;
        }
        let info = vk::BufferCreateInfo::default().size(size).usage(usage).sharing_mode(vk::SharingMode::EXCLUSIVE);
        let device = &gpu.shared.raw;
        // SAFETY: the device is alive and the size is not zero.
        let raw =
            unsafe { device.create_buffer(&info, None) }.map_err(gpu.failed(format!("create the buffer '{name}'")))?;
        // From here on, dropping `buffer` frees what there is.
        let mut buffer =
            Self { gpu: gpu.clone(), raw, allocation: None, size, address: 0, name: name.to_owned(), counted: false };
        // SAFETY: the buffer is alive.
        let requirements = unsafe { device.get_buffer_memory_requirements(raw) };
        let allocation = gpu
            .with_allocator(|allocator| {
                allocator.allocate(&AllocationCreateDesc {
                    name,
                    requirements,
                    location,
                    linear: true,
                    allocation_scheme: AllocationScheme::GpuAllocatorManaged,
                })
            })
            .ok_or_else(|| Error::Device(String::from("the device is being closed")))?
            .map_err(|error| out_of_memory(format!(" ({error})")))?;
        // SAFETY: the memory was allocated for this buffer's requirements and is bound once.
        let bind = || unsafe { device.bind_buffer_memory(raw, allocation.memory(), allocation.offset()) };
        let bound = if omits(Step::BindMemory) { Ok(()) } else { bind() };
        buffer.allocation = Some(allocation);
        bound.map_err(gpu.failed(format!("bind memory to '{name}'")))?;
        // SAFETY: the buffer has memory and was created with SHADER_DEVICE_ADDRESS.
        buffer.address =
            unsafe { device.get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(raw)) };
        buffer.counted = location == MemoryLocation::GpuOnly;
        if buffer.counted {
            gpu.count_allocation(size);
        }
        gpu.name(raw, name);
        gpu.list_buffer(name, size, buffer.address);
        Ok(buffer)
    }

    /// Its address on the device.
    pub fn address(&self) -> u64 {
        self.address
    }

    /// What it is called in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its size in bytes.
    pub fn size(&self) -> u64 {
        self.size
    }

    /// Writes `data` to its beginning.
    pub fn upload(&self, data: &[u8]) -> Result<()> {
        self.upload_at(0, data)
    }

    /// Writes `data` from this byte on.
    pub fn upload_at(&self, start: u64, data: &[u8]) -> Result<()> {
        self.fill_at(start, data.len() as u64, 1, |offset, bytes| {
            bytes.copy_from_slice(&data[offset as usize..offset as usize + bytes.len()]);
        })
    }

    /// Writes `size` bytes to its beginning, which `make` puts, from an offset on, into the slice that it is given: whole
    /// elements of `element` bytes.
    pub(super) fn fill(&self, size: u64, element: u64, make: impl FnMut(u64, &mut [u8])) -> Result<()> {
        self.fill_at(0, size, element, make)
    }

    fn fill_at(&self, start: u64, size: u64, element: u64, mut make: impl FnMut(u64, &mut [u8])) -> Result<()> {
        if size == 0 {
            return Ok(());
        }
        let chunk = (STAGING_BYTES / element * element).min(size);
        let mut staging = Self::with_usage(
            &self.gpu,
            "staging for upload",
            chunk,
            vk::BufferUsageFlags::empty(),
            MemoryLocation::CpuToGpu,
        )?;
        let mut offset = 0;
        while offset < size {
            let part = chunk.min(size - offset);
            make(offset, &mut staging.mapped()?[..part as usize]);
            let region = vk::BufferCopy::default().dst_offset(start + offset).size(part);
            // SAFETY: both buffers are alive here, and the part lies inside both: the callers keep it inside this one.
            unsafe {
                self.gpu.transfer(&format!("upload of '{}'", self.name), staging.raw, self.raw, region)?;
            }
            offset += part;
        }
        Ok(())
    }

    /// Its first `count` elements.
    pub fn read<T: Pod>(&self, count: usize) -> Result<Vec<T>> {
        let mut out = vec![T::zeroed(); count];
        self.read_at(0, bytemuck::cast_slice_mut(&mut out))?;
        Ok(out)
    }

    /// Its bytes from this one on, as many as there is room for in `out`.
    pub fn read_at(&self, start: u64, out: &mut [u8]) -> Result<()> {
        if out.is_empty() {
            return Ok(());
        }
        let chunk = STAGING_BYTES.min(out.len() as u64);
        let mut staging = Self::with_usage(
            &self.gpu,
            "staging for readback",
            chunk,
            vk::BufferUsageFlags::empty(),
            MemoryLocation::GpuToCpu,
        )?;
        for (index, part) in out.chunks_mut(chunk as usize).enumerate() {
            let region = vk::BufferCopy::default().src_offset(start + index as u64 * chunk).size(part.len() as u64);
            // SAFETY: both buffers are alive here, and the part lies inside both: the callers keep it inside this one.
            unsafe {
                self.gpu.transfer(&format!("readback of '{}'", self.name), self.raw, staging.raw, region)?;
            }
            part.copy_from_slice(&staging.mapped()?[..part.len()]);
        }
        Ok(())
    }

    /// Sets every byte to zero.
    pub fn clear(&self) -> Result<()> {
        // SAFETY: this buffer is alive and has a multiple of four bytes.
        unsafe { self.gpu.clear(self.raw, self.size) }
    }

    /// Its bytes, where the host can see them.
    pub(super) fn mapped(&mut self) -> Result<&mut [u8]> {
        let name = &self.name;
        self.allocation.as_mut().and_then(Allocation::mapped_slice_mut).ok_or_else(|| Error::Vulkan {
            doing: format!("map '{name}'"),
            code: String::from("the memory is not visible to the host"),
        })
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        if !omits(Step::Destroy) {
            // SAFETY: nothing on the queue uses it: every submission is waited for before the call that made it returns.
            unsafe { self.gpu.shared.raw.destroy_buffer(self.raw, None) };
        }
        if let Some(allocation) = self.allocation.take() {
            // A failure here means that the allocator's own books are wrong; there is nobody to tell.
            let _ = self.gpu.with_allocator(|allocator| allocator.free(allocation));
        }
        self.gpu.unlist_buffer(self.address);
        if self.counted {
            self.gpu.count_free(self.size);
        }
    }
}
