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

/// Bytes that building one structure takes.
#[derive(Clone, Copy, Debug)]
pub struct BuildSizes {
    /// The structure, before it is compacted.
    pub structure: u64,
    /// Memory that the driver works in.
    pub scratch: u64,
    /// What it is built from.
    pub input: u64,
}

const BOTTOM_FLAGS: vk::BuildAccelerationStructureFlagsKHR = vk::BuildAccelerationStructureFlagsKHR::from_raw(
    vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE.as_raw()
        | vk::BuildAccelerationStructureFlagsKHR::ALLOW_COMPACTION.as_raw(),
);
const TOP_FLAGS: vk::BuildAccelerationStructureFlagsKHR = vk::BuildAccelerationStructureFlagsKHR::PREFER_FAST_TRACE;

/// What the driver asks for a bottom level over so many triangles or spheres.
pub fn bottom_level_sizes(gpu: &Gpu, count: u32, spheres: bool) -> Result<BuildSizes> {
    let kind = vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL;
    let geometry = bottom_geometry(spheres, count, 0);
    let input = element_bytes(spheres) * u64::from(count);
    Ok(total_sizes(gpu, driver_sizes(Structure::functions(gpu)?, kind, BOTTOM_FLAGS, geometry, count), input))
}

/// What the driver asks for a top level over so many instances.
pub fn top_level_sizes(gpu: &Gpu, count: u32) -> Result<BuildSizes> {
    let kind = vk::AccelerationStructureTypeKHR::TOP_LEVEL;
    let input = size_of::<vk::AccelerationStructureInstanceKHR>() as u64 * u64::from(count);
    Ok(total_sizes(gpu, driver_sizes(Structure::functions(gpu)?, kind, TOP_FLAGS, top_geometry(0), count), input))
}

fn total_sizes(gpu: &Gpu, sizes: vk::AccelerationStructureBuildSizesInfoKHR<'_>, input: u64) -> BuildSizes {
    let scratch = sizes.build_scratch_size + gpu.limits().scratch_alignment;
    BuildSizes { structure: sizes.acceleration_structure_size, scratch, input }
}

/// Bytes of the build input per triangle or sphere: three corners, or two of a box.
fn element_bytes(spheres: bool) -> u64 {
    if spheres { 24 } else { 36 }
}

fn bottom_geometry(spheres: bool, count: u32, input: u64) -> vk::AccelerationStructureGeometryKHR<'static> {
    let data = vk::DeviceOrHostAddressConstKHR { device_address: input };
    if spheres {
        let boxes = vk::AccelerationStructureGeometryAabbsDataKHR::default().data(data).stride(24);
        vk::AccelerationStructureGeometryKHR::default()
            .geometry_type(vk::GeometryTypeKHR::AABBS)
            .geometry(vk::AccelerationStructureGeometryDataKHR { aabbs: boxes })
    } else {
        let triangles = vk::AccelerationStructureGeometryTrianglesDataKHR::default()
            .vertex_format(vk::Format::R32G32B32_SFLOAT)
            .vertex_data(data)
            .vertex_stride(12)
            .max_vertex((3 * count).saturating_sub(1))
            .index_type(vk::IndexType::NONE_KHR);
        vk::AccelerationStructureGeometryKHR::default()
            .geometry_type(vk::GeometryTypeKHR::TRIANGLES)
            .geometry(vk::AccelerationStructureGeometryDataKHR { triangles })
            .flags(vk::GeometryFlagsKHR::OPAQUE)
    }
}

fn top_geometry(input: u64) -> vk::AccelerationStructureGeometryKHR<'static> {
    let instances = vk::AccelerationStructureGeometryInstancesDataKHR::default()
        .data(vk::DeviceOrHostAddressConstKHR { device_address: input });
    vk::AccelerationStructureGeometryKHR::default()
        .geometry_type(vk::GeometryTypeKHR::INSTANCES)
        .geometry(vk::AccelerationStructureGeometryDataKHR { instances })
}

fn build_info<'a>(
    kind: vk::AccelerationStructureTypeKHR,
    flags: vk::BuildAccelerationStructureFlagsKHR,
    geometries: &'a [vk::AccelerationStructureGeometryKHR<'a>],
) -> vk::AccelerationStructureBuildGeometryInfoKHR<'a> {
    vk::AccelerationStructureBuildGeometryInfoKHR::default()
        .ty(kind)
        .flags(flags)
        .mode(vk::BuildAccelerationStructureModeKHR::BUILD)
        .geometries(geometries)
}

fn driver_sizes(
    functions: &ash::khr::acceleration_structure::Device,
    kind: vk::AccelerationStructureTypeKHR,
    flags: vk::BuildAccelerationStructureFlagsKHR,
    geometry: vk::AccelerationStructureGeometryKHR<'_>,
    count: u32,
) -> vk::AccelerationStructureBuildSizesInfoKHR<'static> {
    let geometries = [geometry];
    let mut sizes = vk::AccelerationStructureBuildSizesInfoKHR::default();
    // SAFETY: one geometry and one count; the addresses in it are not read here.
    unsafe {
        functions.get_acceleration_structure_build_sizes(
            vk::AccelerationStructureBuildTypeKHR::DEVICE,
            &build_info(kind, flags, &geometries),
            &[count],
            &mut sizes,
        );
    }
    sizes
}

impl Blas {
    /// Builds and compacts the structure over primitives that are all triangles or all spheres.
    pub fn build(gpu: &Gpu, name: &str, primitives: &[Primitive]) -> Result<Self> {
        let spheres = primitives.first().is_some_and(|primitive| primitive.surface & SPHERE_BIT != 0);
        let usage = vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;
        let element = element_bytes(spheres);
        let size = element * primitives.len() as u64;
        let input = Buffer::with_usage(gpu, &format!("{name} build input"), size, usage, MemoryLocation::GpuOnly)?;
        // Written on the way to the device: a copy of a large mesh would take as much memory as the mesh.
        input.fill(size, element, |offset, bytes| {
            let first = (offset / element) as usize;
            for (out, primitive) in bytes.chunks_exact_mut(element as usize).zip(&primitives[first..]) {
                if spheres {
                    out.copy_from_slice(bytemuck::cast_slice(&sphere_box(primitive)));
                } else {
                    out.copy_from_slice(bytemuck::cast_slice(&[primitive.v0, primitive.v1, primitive.v2]));
                }
            }
        })?;
        let count = primitives.len() as u32;
        let geometry = bottom_geometry(spheres, count, input.address());
        let kind = vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL;
        let structure = Structure::build(gpu, name, kind, BOTTOM_FLAGS, geometry, count)?.compact(name)?;
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
        let geometry = top_geometry(input.address());
        let kind = vk::AccelerationStructureTypeKHR::TOP_LEVEL;
        let structure = Structure::build(gpu, "top level", kind, TOP_FLAGS, geometry, placements.len() as u32)?;
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
        let sizes = driver_sizes(functions, kind, flags, geometry, count);
        let mut info = build_info(kind, flags, &geometries);
        let structure = Self::empty(gpu, name, kind, sizes.acceleration_structure_size)?;
        let alignment = gpu.limits().scratch_alignment;
        let scratch = Buffer::new(gpu, &format!("{name} build scratch"), sizes.build_scratch_size + alignment)?;
        info = info
            .dst_acceleration_structure(structure.raw)
            .scratch_data(vk::DeviceOrHostAddressKHR { device_address: scratch.address().next_multiple_of(alignment) });
        let ranges = [vk::AccelerationStructureBuildRangeInfoKHR::default().primitive_count(count)];
        gpu.run_raw("acceleration-structure build", &format!("'{name}', {count} primitives"), |recording| {
            recording.barrier();
            // SAFETY: input, scratch and structure are alive until the submission is done; the sizes are the driver's own.
            unsafe { functions.cmd_build_acceleration_structures(recording.raw, &[info], &[&ranges]) };
            recording.barrier();
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
        let asked = gpu.run_raw("acceleration-structure size query", name, |recording| {
            // SAFETY: the query and the structure are alive until the submission is done, and the build before it is.
            unsafe {
                device.cmd_reset_query_pool(recording.raw, query, 0, 1);
                functions.cmd_write_acceleration_structures_properties(
                    recording.raw,
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
        // Compaction is for memory's sake: where there is no room for the copy, the structure serves as it is.
        let compacted = match Self::empty(gpu, name, vk::AccelerationStructureTypeKHR::BOTTOM_LEVEL, size[0]) {
            Err(Error::OutOfMemory { .. }) => return Ok(self),
            made => made?,
        };
        let info = vk::CopyAccelerationStructureInfoKHR::default()
            .src(self.raw)
            .dst(compacted.raw)
            .mode(vk::CopyAccelerationStructureModeKHR::COMPACT);
        gpu.run_raw("acceleration-structure compaction", name, |recording| {
            recording.barrier();
            // SAFETY: both structures are alive until the submission is done; the target has the size that was asked for.
            unsafe { functions.cmd_copy_acceleration_structure(recording.raw, &info) };
            recording.barrier();
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
