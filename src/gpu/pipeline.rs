//! Compute pipelines: a module, made for the values of its constants, and the one descriptor set that it reads.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::sync::{PoisonError, RwLock};

use ash::vk;

use super::accel::Tlas;
use super::buffer::Buffer;
use super::device::Gpu;
use super::omission::{Step, omits};
use crate::error::{Error, Result};
use crate::layout;
use crate::spirv::{self, Arithmetic, Specialised};

mod generated {
    include!(concat!(env!("OUT_DIR"), "/modules.rs"));
}

/// Modules that stand for those of the same names that were compiled into the program.
static REPLACED: RwLock<BTreeMap<String, Vec<u32>>> = RwLock::new(BTreeMap::new());

/// Has these modules stand for those of the same names in pipelines that are made from now on.
#[cfg(feature = "hot-reload")]
pub fn replace_modules(modules: Vec<(String, Vec<u32>)>) {
    REPLACED.write().unwrap_or_else(PoisonError::into_inner).extend(modules);
}

/// The SPIR-V that `build.rs` made of a technique's pass for a backend (`path.pixels.bvh`), or of a test kernel
/// (`test/trace.bvh`), with everything that there is to model.
pub fn module(name: &str) -> Result<Vec<u32>> {
    if let Some(words) = REPLACED.read().unwrap_or_else(PoisonError::into_inner).get(name) {
        return Ok(words.clone());
    }
    let Some((_, length, deflated)) = generated::MODULES.iter().find(|(module, ..)| *module == name) else {
        return Err(Error::Usage(format!("no shader '{name}' was compiled into this program")));
    };
    let mut bytes = Vec::with_capacity(4 * length);
    flate2::read::DeflateDecoder::new(*deflated)
        .read_to_end(&mut bytes)
        .map_err(|error| Error::Vulkan { doing: format!("inflate the shader {name}"), code: error.to_string() })?;
    Ok(bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect())
}

/// The names of all modules.
pub fn module_names() -> impl Iterator<Item = &'static str> {
    generated::MODULES.iter().map(|(name, ..)| *name)
}

/// A number that stands for all compiled modules: it changes with any shader.
pub fn modules_fingerprint() -> u64 {
    let mut hasher = DefaultHasher::new();
    generated::MODULES.hash(&mut hasher);
    hasher.finish()
}

/// What a pipeline is made of: a module, the values of its specialisation constants, and who works these in.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// The module's name.
    pub module: String,
    /// Pairs of a `constant_id` and its 32 bits.
    pub constants: Vec<(u32, u32)>,
    /// Leave the constants to the driver rather than to [`spirv::specialise`]: the same bits, for comparison.
    pub driver_specialises: bool,
    /// How the driver may treat arithmetic, where the constants are not left to it.
    pub arithmetic: Arithmetic,
}

impl Kernel {
    fn specialised(&self, whole: &[u32]) -> Result<Specialised> {
        spirv::specialise(whole, &self.constants, self.arithmetic)
            .map_err(|error| Error::Vulkan { doing: format!("specialise the shader {}", self.module), code: error })
    }

    /// Instructions that the constants leave of the module, and all that it has.
    pub fn size(&self) -> Result<(usize, usize)> {
        let made = self.specialised(&module(&self.module)?)?;
        Ok((made.after, made.before))
    }
}

/// A compute pipeline. Freed when dropped.
pub struct Pipeline {
    /// Instructions of the module, and of what its constants leave of it; the same where the driver is left to find out.
    pub instructions: (usize, usize),
    /// The module's name.
    pub(super) name: String,
    gpu: Gpu,
    pub(super) raw: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    set_layout: vk::DescriptorSetLayout,
}

/// What a pipeline's descriptor set points to. Freed when dropped.
pub struct Bindings {
    gpu: Gpu,
    pool: vk::DescriptorPool,
    pub(super) set: vk::DescriptorSet,
}

/// The binding numbers and kinds of a set, with or without an acceleration structure.
fn binding_kinds(has_tlas: bool) -> Vec<(u32, vk::DescriptorType)> {
    let mut kinds = vec![(layout::BINDING_SCENE, vk::DescriptorType::UNIFORM_BUFFER)];
    if has_tlas {
        kinds.push((layout::BINDING_TLAS, vk::DescriptorType::ACCELERATION_STRUCTURE_KHR));
    }
    kinds
}

impl Pipeline {
    /// Makes a pipeline.
    pub fn new(gpu: &Gpu, kernel: &Kernel, has_tlas: bool) -> Result<Self> {
        let device = &gpu.shared.raw;
        let name = kernel.module.as_str();
        let whole = module(name)?;
        let made = kernel.specialised(&whole)?;
        let (words, left_to_driver, left) = match kernel.driver_specialises {
            true => (whole, &kernel.constants[..], made.before),
            false => (made.words, &[][..], made.after),
        };
        let bindings: Vec<_> = binding_kinds(has_tlas)
            .into_iter()
            .map(|(binding, kind)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(binding)
                    .descriptor_type(kind)
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let mut new = Self {
            instructions: (made.before, left),
            name: name.to_owned(),
            gpu: gpu.clone(),
            raw: vk::Pipeline::null(),
            layout: vk::PipelineLayout::null(),
            set_layout: vk::DescriptorSetLayout::null(),
        };
        let set_info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive; `new` frees what was created, also on the way out of an error.
        new.set_layout = unsafe { device.create_descriptor_set_layout(&set_info, None) }
            .map_err(gpu.failed(format!("create the descriptor layout of {name}")))?;
        gpu.name(new.set_layout, name);

        let set_layouts = [new.set_layout];
        let ranges = [vk::PushConstantRange::default()
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
            .size(size_of::<layout::FrameConstants>() as u32)];
        let layout_info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(if omits(Step::PushConstantRange) { &[] } else { &ranges });
        // SAFETY: as above.
        new.layout = unsafe { device.create_pipeline_layout(&layout_info, None) }
            .map_err(gpu.failed(format!("create the pipeline layout of {name}")))?;
        gpu.name(new.layout, name);

        // SAFETY: as above; the module is no longer needed once the pipeline is made of it, or could not be.
        let module = unsafe { device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&words), None) }
            .map_err(gpu.failed(format!("load the shader {name}")))?;
        gpu.name(module, name);
        let entries: Vec<_> = (0u32..)
            .zip(left_to_driver)
            .map(|(index, (id, _))| vk::SpecializationMapEntry::default().constant_id(*id).offset(4 * index).size(4))
            .collect();
        let data: Vec<u32> = left_to_driver.iter().map(|(_, word)| *word).collect();
        let special = vk::SpecializationInfo::default().map_entries(&entries).data(bytemuck::cast_slice(&data));
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(c"main")
            .specialization_info(&special);
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(new.layout)];
        // SAFETY: everything that `info` points to lives through the call.
        let made = unsafe { device.create_compute_pipelines(vk::PipelineCache::null(), &info, None) };
        // SAFETY: see above.
        unsafe { device.destroy_shader_module(module, None) };
        let made =
            made.map_err(|(_, code)| code).map_err(gpu.failed(format!("make a pipeline of the shader {name}")))?;
        new.raw = made[0];
        gpu.name(new.raw, name);
        Ok(new)
    }

    /// A descriptor set for this pipeline, and for every other one with the same bindings.
    pub fn bind(&self, uniforms: &Buffer, tlas: Option<&Tlas>) -> Result<Bindings> {
        let device = &self.gpu.shared.raw;
        let sizes: Vec<_> = binding_kinds(tlas.is_some())
            .into_iter()
            .map(|(_, kind)| vk::DescriptorPoolSize::default().ty(kind).descriptor_count(1))
            .collect();
        let pool_info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        let mut bindings =
            Bindings { gpu: self.gpu.clone(), pool: vk::DescriptorPool::null(), set: vk::DescriptorSet::null() };
        // SAFETY: the device is alive; `bindings` frees the pool, and the set with it.
        bindings.pool = unsafe { device.create_descriptor_pool(&pool_info, None) }
            .map_err(self.gpu.failed("create a descriptor pool"))?;
        self.gpu.name(bindings.pool, "scene bindings");
        let layouts = [self.set_layout];
        let set_info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(bindings.pool).set_layouts(&layouts);
        // SAFETY: the pool has room for exactly this set.
        let sets = unsafe { device.allocate_descriptor_sets(&set_info) }
            .map_err(self.gpu.failed("allocate a descriptor set"))?;
        bindings.set = sets[0];
        self.gpu.name(bindings.set, "scene bindings");

        let uniform_info = [vk::DescriptorBufferInfo::default().buffer(uniforms.raw).range(vk::WHOLE_SIZE)];
        let mut writes = vec![
            vk::WriteDescriptorSet::default()
                .dst_set(bindings.set)
                .dst_binding(layout::BINDING_SCENE)
                .descriptor_type(vk::DescriptorType::UNIFORM_BUFFER)
                .buffer_info(&uniform_info),
        ];
        let structures: Vec<_> = tlas.iter().map(|tlas| tlas.raw()).collect();
        let mut structure_info =
            vk::WriteDescriptorSetAccelerationStructureKHR::default().acceleration_structures(&structures);
        if tlas.is_some() {
            writes.push(
                vk::WriteDescriptorSet::default()
                    .dst_set(bindings.set)
                    .dst_binding(layout::BINDING_TLAS)
                    .descriptor_type(vk::DescriptorType::ACCELERATION_STRUCTURE_KHR)
                    .descriptor_count(1)
                    .push_next(&mut structure_info),
            );
        }
        // SAFETY: the set is not in use, and what it is made to point to outlives its use (the renderer owns them all).
        unsafe { device.update_descriptor_sets(&writes, &[]) };
        Ok(bindings)
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        let device = &self.gpu.shared.raw;
        // SAFETY: nothing on the queue uses them (every submission is waited for); null handles are allowed.
        unsafe {
            device.destroy_pipeline(self.raw, None);
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

impl Drop for Bindings {
    fn drop(&mut self) {
        // SAFETY: as for pipelines.
        unsafe { self.gpu.shared.raw.destroy_descriptor_pool(self.pool, None) };
    }
}
