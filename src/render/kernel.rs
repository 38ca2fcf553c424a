//! A compiled kernel with the scene that it runs on.

use std::sync::Arc;

use super::device_scene::DeviceScene;
use crate::error::Result;
use crate::gpu::{self, Bindings, DeviceKind, Gpu, Pipeline};
use crate::layout::{INLINE_FIRST_ID, NONE, Primitive, SPHERE_BIT, Specialisation};
use crate::scene::{Needs, Scene};
use crate::techniques::{Pass, Sampler, Settings};

/// A pipeline, specialised to a scene, and the scene on the device.
pub(super) struct Kernel {
    pub pipeline: Pipeline,
    pub bindings: Bindings,
    pub scene: Arc<DeviceScene>,
    /// What the pipeline was made of.
    made_of: gpu::Kernel,
}

impl Kernel {
    /// Makes a pipeline of the module `name` for a scene that is on the device. The caller has checked the settings.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        name: &str,
        device_scene: Arc<DeviceScene>,
    ) -> Result<Self> {
        let constants = Self::constants(gpu, scene, settings, &device_scene)?;
        Self::with_constants(gpu, settings, name, constants, device_scene)
    }

    /// The values of the specialisation constants that all modules of a rendering get.
    fn constants(gpu: &Gpu, scene: &Scene, settings: &Settings, on_device: &DeviceScene) -> Result<Constants> {
        let DeviceScene { stack_size, has_pairs, inline, .. } = on_device;
        let structure = Structure { stack_size: *stack_size, has_pairs: *has_pairs, inline };
        constants(scene, settings, on_device.needs, gpu.survey().kind, structure)
    }

    fn with_constants(
        gpu: &Gpu,
        settings: &Settings,
        name: &str,
        constants: Constants,
        device_scene: Arc<DeviceScene>,
    ) -> Result<Self> {
        let made_of = gpu::Kernel {
            module: name.to_owned(),
            constants,
            driver_specialises: settings.driver_specialises,
            arithmetic: settings.arithmetic,
        };
        let (pipeline, bindings) = Self::make(gpu, &made_of, &device_scene)?;
        Ok(Self { pipeline, bindings, scene: device_scene, made_of })
    }

    /// Makes pipelines of several modules, in their order: as many at once as there are cores, for a driver works on each with one.
    pub fn several(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        names: &[String],
        device_scene: &Arc<DeviceScene>,
    ) -> Result<Vec<Self>> {
        use rayon::prelude::*;
        let constants = Self::constants(gpu, scene, settings, device_scene)?;
        let make = |name: &String| Self::with_constants(gpu, settings, name, constants.clone(), device_scene.clone());
        names.par_iter().map(make).collect()
    }

    fn make(gpu: &Gpu, kernel: &gpu::Kernel, scene: &DeviceScene) -> Result<(Pipeline, Bindings)> {
        let pipeline = Pipeline::new(gpu, kernel, scene.tlas.is_some())?;
        let bindings = pipeline.bind(&scene.uniforms, scene.tlas.as_ref())?;
        Ok((pipeline, bindings))
    }

    /// Makes a pipeline of another module with the same constants, for the same scene.
    pub fn sibling(&self, gpu: &Gpu, name: &str) -> Result<Self> {
        let made_of = gpu::Kernel { module: name.to_owned(), ..self.made_of.clone() };
        let (pipeline, bindings) = Self::make(gpu, &made_of, &self.scene)?;
        Ok(Self { pipeline, bindings, scene: self.scene.clone(), made_of })
    }

    /// Makes the same pipeline once more, beside the old one, which goes then: its code comes to lie elsewhere.
    pub fn remake(&mut self, gpu: &Gpu) -> Result<()> {
        (self.pipeline, self.bindings) = Self::make(gpu, &self.made_of, &self.scene)?;
        Ok(())
    }

    /// The module's name, its instructions, and those that are left of them.
    pub fn size(&self) -> KernelSize {
        let (whole, left) = self.pipeline.instructions;
        KernelSize { module: self.made_of.module.clone(), instructions: left, of: whole }
    }
}

/// Values of specialisation constants, as (id, bits).
pub type Constants = Vec<(u32, u32)>;

/// How much of a module is left for a scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct KernelSize {
    /// The module: technique, pass and backend.
    pub module: String,
    /// SPIR-V instructions that the driver is given.
    pub instructions: usize,
    /// Instructions of the module with everything that there is to model.
    pub of: usize,
}

/// What a kernel must know of the structure that it traverses.
struct Structure<'a> {
    /// Entries of the stack.
    stack_size: u32,
    /// Leaves hold pairs of triangles.
    has_pairs: bool,
    /// The primitives that the kernel holds as constants.
    inline: &'a [Primitive],
}

/// The values of all specialisation constants, as (id, bits). `needs` is what the kernel models of the scene.
fn constants(
    scene: &Scene,
    settings: &Settings,
    needs: Needs,
    device: DeviceKind,
    structure: Structure,
) -> Result<Constants> {
    let inline = structure.inline;
    let [param0, param1, param2, param3] = settings.technique.words();
    let spheres = |first: usize| {
        let primitives = inline.iter().skip(first).take(32).enumerate();
        primitives.fold(0, |bits, (index, primitive)| bits | u32::from(primitive.surface & SPHERE_BIT != 0) << index)
    };
    let special = Specialisation {
        needs,
        camera: settings.image_plane(scene)?.kind,
        length_layers: settings.layers(),
        strategies: settings.strategies.is_some(),
        max_depth: settings.max_depth.unwrap_or(NONE),
        rr_depth: settings.rr_depth,
        filter: settings.filter.parameters().0,
        wide_loads: device == DeviceKind::Cpu,
        select_stack: device == DeviceKind::Cpu,
        unroll: device != DeviceKind::Cpu,
        stack_size: structure.stack_size,
        has_pairs: structure.has_pairs || !settings.specialise,
        inline_count: inline.len() as u32,
        inline_spheres: spheres(0),
        inline_spheres_high: spheres(32),
        sobol: settings.sampler == Sampler::Sobol,
        records: settings.records > 0,
        param0,
        param1,
        param2,
        param3,
    };
    let mut constants = special.words();
    let coordinates = inline.iter().flat_map(|primitive| [primitive.v0, primitive.v1, primitive.v2]).flatten();
    constants.extend((INLINE_FIRST_ID..).zip(coordinates.map(f32::to_bits)));
    Ok(constants)
}

/// The names of the modules of a rendering's passes, in their order.
pub(super) fn module_names(settings: &Settings) -> Vec<String> {
    let row = settings.technique.row;
    let name = |pass: &Pass| row.module(pass, settings.backend.name());
    settings.technique.passes().map(name).collect()
}

/// The modules of a rendering's passes and the values of their specialisation constants, as (id, bits), as they are for a device of this kind.
/// Triangles are not in the kernels, and the traversal stack has one entry: neither changes which code is left. Leaves hold pairs, as those of most meshes do.
pub fn modules_of(scene: &Scene, settings: &Settings, device: DeviceKind) -> Result<(Vec<String>, Constants)> {
    Ok((
        module_names(settings),
        constants(
            scene,
            settings,
            settings.needs(scene),
            device,
            Structure { stack_size: 1, has_pairs: true, inline: &[] },
        )?,
    ))
}

/// How much of each of these modules is left, found without a device.
pub fn kernel_sizes(scene: &Scene, settings: &Settings, device: DeviceKind) -> Result<Vec<KernelSize>> {
    let (modules, constants) = modules_of(scene, settings, device)?;
    let size = |module: String| {
        let (driver_specialises, arithmetic) = (settings.driver_specialises, settings.arithmetic);
        let kernel = gpu::Kernel { module, constants: constants.clone(), driver_specialises, arithmetic };
        let (instructions, of) = kernel.size()?;
        Ok(KernelSize { module: kernel.module, instructions, of })
    };
    modules.into_iter().map(size).collect()
}
