//! The driver's acceleration structures: one compacted bottom level per part of a group, one top level of instances.

use ash::vk;
use gpu_allocator::MemoryLocation;

use super::buffer::Buffer;
use super::device::Gpu;
use crate::error::{Error, Result};
use crate::layout::{Primitive, SPHERE_BIT};

/// A bottom-level acceleration structure. Freed when dropped.
pub struct Blas {
    structure: Structure,
    address: u64,
}

/// A top-level acceleration structure, with the bottom levels that it refers to. Freed when dropped.
pub struct Tlas {
    structure: Structure,
    _parts: Vec<Blas>,
}

/// One instance of a bottom level.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Index of the bottom level.
    pub part: usize,
    /// World from object, three rows of four.
    pub world: [[f32; 4]; 3],
    /// The index that shaders get back, below 2^24.
    pub index: u32,
}

struct Structure {
    gpu: Gpu,
    raw: vk::AccelerationStructureKHR,
    memory: Buffer,
}

impl Blas {
    /// Builds and compacts the structure over primitives that are all triangles or all spheres.
    pub fn build(gpu: &Gpu, name: &str, primitives: &[Primitive]) -> Result<Self> {
        let spheres = primitives.first().is_some_and(|primitive| primitive.surface & SPHERE_BIT != 0);
        let usage = vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;
        let data: Vec<[f32; 3]> = if spheres {
            primitives.iter().flat_map(sphere_box).collect()
        } else {
            primitives.iter().flat_map(|triangle| [triangle.v0, triangle.v1, triangle.v2]).collect()
        };
        let input = Buffer::with_usage(
            gpu,
            &format!("{name} build input"),
            size_of_val(&data[..]) as u64,
            usage,
            MemoryLocation::GpuOnly,
        )?;
        input.upload(bytemuck::cast_slice(&data))?;
        let input_address = vk::DeviceOrHostAddressConstKHR { device_address: input.address() };
        let geometry = if spheres {
            let boxes = vk::AccelerationStructureGeometryAabbsDataKHR::default().data(input_address).stride(24);
            vk::AccelerationStructureGeometryKHR::default()
                .geometry_type(vk::GeometryTypeKHR::AABBS)
                .geometry(vk::AccelerationStructureGeometryDataKHR { aabbs: boxes })
        } else {
            let triangles = vk::AccelerationStructureGeometryTrianglesDataKHR::default()
                .vertex_format(vk::Format::R32G32B32_SFLOAT)
                .vertex_data(input_address)
                .vertex_stride(12)
                .max_vertex((data.len() as u32).saturating_sub(1))
                .index_type(vk::IndexType::NONE_KHR);
            vk::AccelerationStructureGeometryKHR::default()
                .geometry_type(vk::GeometryTypeKHR::TRIANGLES)
                .geometry(vk::AccelerationStructureGeometryDataKHR { triangles })
                .flags(vk::GeometryFlagsKHR::OPAQUE)
        };
        let flags = vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE
            | vk::BuildAccelerationStructureFlagsKHR::ALLOW_COMPACTION;
        let kind = vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL;
        let structure = Structure::build(gpu, name, kind, flags, geometry, primitives.len() as u32)?.compact(name)?;
        let address = structure.address()?;
        Ok(Self { structure, address })
    }

    /// Bytes on the device.
    pub fn size(&self) -> u64 {
        self.structure.memory.size()
    }
}

impl Tlas {
    /// Builds the structure over instances of `parts`.
    pub fn build(gpu: &Gpu, parts: Vec<Blas>, placements: &[Placement]) -> Result<Self> {
        let mut data = Vec::with_capacity(16 * placements.len());
        for placement in placements {
            let Some(part) = parts.get(placement.part) else {
                return Err(Error::Usage(format!("an instance refers to part {} of {}", placement.part, parts.len())));
            };
            // VkAccelerationStructureInstanceKHR: 12 floats, custom index and mask, SBT offset and flags, address.
            let flags = vk::GeometryInstanceFlagsKHR::TRIANGLE_FACING_CULL_DISABLE.as_raw() << 24;
            data.extend(placement.world.iter().flatten().map(|value| value.to_bits()));
            data.extend([
                placement.index & 0x00ff_ffff | 0xff00_0000,
                flags,
                part.address as u32,
                (part.address >> 32) as u32,
            ]);
        }
        let usage = vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;
        let input = Buffer::with_usage(
            gpu,
            "instances build input",
            size_of_val(&data[..]) as u64,
            usage,
            MemoryLocation::GpuOnly,
        )?;
        input.upload(bytemuck::cast_slice(&data))?;
        let instances = vk::AccelerationStructureGeometryInstancesDataKHR::default()
            .data(vk::DeviceOrHostAddressConstKHR { device_address: input.address() });
        let geometry = vk::AccelerationStructureGeometryKHR::default()
            .geometry_type(vk::GeometryTypeKHR::INSTANCES)
            .geometry(vk::AccelerationStructureGeometryDataKHR { instances });
        let kind = vk::AccelerationStructureTypeKHR::TOP_LEVEL;
        let flags = vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE;
        let structure = Structure::build(gpu, "top level", kind, flags, geometry, placements.len() as u32)?;
        Ok(Self { structure, _parts: parts })
    }

    /// Bytes on the device, the bottom levels included.
    pub fn size(&self) -> u64 {
        self.structure.memory.size() + self._parts.iter().map(Blas::size).sum::<u64>()
    }

    pub(super) fn raw(&self) -> vk::AccelerationStructureKHR {
        self.structure.raw
    }
}

impl Structure {
    fn functions(gpu: &Gpu) -> Result<&ash::khr::acceleration_structure::Device> {
        gpu.shared
            .acceleration
            .as_ref()
            .ok_or_else(|| Error::Device(format!("{} has no acceleration structures", gpu.survey().name)))
    }

    fn empty(gpu: &Gpu, name: &str, kind: vk::AccelerationStructureTypeKHR, size: u64) -> Result<Self> {
        let usage = vk::BufferUsageFlags::ACCELERATION_STRUCTURE_STORAGE_KHR;
        let memory = Buffer::with_usage(gpu, name, size, usage, MemoryLocation::GpuOnly)?;
        let info = vk::AccelerationStructureCreateInfoKHR::default().buffer(memory.raw).size(size).ty(kind);
        // SAFETY: the buffer is alive, large enough, and has the usage that storage asks for.
        let raw = unsafe { Self::functions(gpu)?.create_acceleration_structure(&info, None) }
            .map_err(gpu.failed(format!("create the acceleration structure '{name}'")))?;
        gpu.name(raw, name);
        Ok(Self { gpu: gpu.clone(), raw, memory })
    }

    fn build(
        gpu: &Gpu,
        name: &str,
        kind: vk::AccelerationStructureTypeKHR,
        flags: vk::BuildAccelerationStructureFlagsKHR,
        geometry: vk::AccelerationStructureGeometryKHR<'_>,
        count: u32,
    ) -> Result<Self> {
        let functions = Self::functions(gpu)?;
        let geometries = [geometry];
        let mut info = vk::AccelerationStructureBuildGeometryInfoKHR::default()
            .ty(kind)
            .flags(flags)
            .mode(vk::BuildAccelerationStructureModeKHR::BUILD)
            .geometries(&geometries);
        let mut sizes = vk::AccelerationStructureBuildSizesInfoKHR::default();
        // SAFETY: one geometry and one count; the addresses in it are not read here.
        unsafe {
            functions.get_acceleration_structure_build_sizes(
                vk::AccelerationStructureBuildTypeKHR::DEVICE,
                &info,
                &[count],
                &mut sizes,
            );
        }
        let structure = Self::empty(gpu, name, kind, sizes.acceleration_structure_size)?;
        let alignment = gpu.limits().scratch_alignment;
        let scratch = Buffer::new(gpu, &format!("{name} build scratch"), sizes.build_scratch_size + alignment)?;
        info = info
            .dst_acceleration_structure(structure.raw)
            .scratch_data(vk::DeviceOrHostAddressKHR { device_address: scratch.address().next_multiple_of(alignment) });
        let ranges = [vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(count)];
        gpu.run("acceleration-structure build", &format!("'{name}', {count} primitives"), |commands| {
            commands.barrier();
            // SAFETY: input, scratch and structure are alive until the submission is done; the sizes are the driver's own.
            unsafe { functions.cmd_build_acceleration_structures(commands.raw(), &[info], &[&ranges]) };
            commands.barrier();
        })?;
        Ok(structure)
    }

    /// A copy without the room that the build kept in reserve.
    fn compact(self, name: &str) -> Result<Self> {
        let gpu = &self.gpu;
        let functions = Self::functions(gpu)?;
        let device = &gpu.shared.raw;
        let query_info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR)
            .query_count(1);
        // SAFETY: the device is alive; the pool is destroyed below on every path.
        let query = unsafe { device.create_query_pool(&query_info, None) }.map_err(gpu.failed("create a query"))?;
        gpu.name(query, name);
        let asked = gpu.run("acceleration-structure size query", name, |commands| {
            // SAFETY: the query and the structure are alive until the submission is done, and the build before it is.
            unsafe {
                device.cmd_reset_query_pool(commands.raw(), query, 0, 1);
                functions.cmd_write_acceleration_structures_properties(
                    commands.raw(),
                    &[self.raw],
                    vk::QueryType::ACCELERATION_STRUCTURE_COMPACTED_SIZE_KHR,
                    query,
                    0,
                );
            }
        });
        let mut size = [0u64];
        let read = asked.and_then(|_| {
            let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
            // SAFETY: the query was written by the submission above, which is done.
            unsafe { device.get_query_pool_results(query, 0, &mut size, flags) }
                .map_err(gpu.failed("read the compacted size"))
        });
        // SAFETY: nothing uses the query any more.
        unsafe { device.destroy_query_pool(query, None) };
        read?;
        if size[0] == 0 || size[0] >= self.memory.size() {
            return Ok(self);
        }
        let compacted = Self::empty(gpu, name, vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL, size[0])?;
        let info = vk::CopyAccelerationStructureInfoKHR::default()
            .src(self.raw)
            .dst(compacted.raw)
            .mode(vk::CopyAccelerationStructureModeKHR::COMPACT);
        gpu.run("acceleration-structure compaction", name, |commands| {
            commands.barrier();
            // SAFETY: both structures are alive until the submission is done; the target has the size that was asked for.
            unsafe { functions.cmd_copy_acceleration_structure(commands.raw(), &info) };
            commands.barrier();
        })?;
        Ok(compacted)
    }

    fn address(&self) -> Result<u64> {
        let info = vk::AccelerationStructureDeviceAddressInfoKHR::default().acceleration_structure(self.raw);
        // SAFETY: the structure is alive.
        Ok(unsafe { Self::functions(&self.gpu)?.get_acceleration_structure_device_address(&info) })
    }
}

impl Drop for Structure {
    fn drop(&mut self) {
        if let Some(functions) = &self.gpu.shared.acceleration {
            // SAFETY: nothing on the queue uses it: every submission is waited for.
            unsafe { functions.destroy_acceleration_structure(self.raw, None) };
        }
    }
}

/// The corners of a sphere's bounding box, a little outwards: the box is only asked whether the surface may be inside.
fn sphere_box(sphere: &Primitive) -> [[f32; 3]; 2] {
    let radius = sphere.v1[0].abs();
    let grow = |value: f32| value + (value.abs() + radius) * 4.0 * f32::EPSILON;
    let shrink = |value: f32| value - (value.abs() + radius) * 4.0 * f32::EPSILON;
    [sphere.v0.map(|c| shrink(c - radius)), sphere.v0.map(|c| grow(c + radius))]
}
