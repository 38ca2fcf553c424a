//! A compiled kernel with the scene that it runs on.

use std::sync::Arc;
use std::time::Instant;

use super::settings::Settings;
use super::spent;
use super::upload::Uploaded;
use super::watch::Watch;
use crate::error::Result;
use crate::gpu::{self, Bindings, DeviceKind, Gpu, Pipeline};
use crate::layout::{INLINE_FIRST_ID, NONE, Specialisation};
use crate::sampler::Sampler;
use crate::scene::Scene;

/// A pipeline, specialised to a scene, and the scene on the device.
pub(super) struct Kernel {
    pub pipeline: Pipeline,
    pub bindings: Bindings,
    pub scene: Arc<Uploaded>,
    /// Seconds that building and uploading the scene took.
    pub build_seconds: f64,
    /// Seconds that making the pipeline took.
    pub compile_seconds: f64,
    /// What the pipeline was made of.
    module: String,
    constants: Vec<(u32, u32)>,
    driver_specialises: bool,
}

impl Kernel {
    /// Uploads the scene and makes a pipeline of the module `name` for it. The caller has checked the settings and that the
    /// device has room.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &Settings, name: &str, watch: Watch) -> Result<Self> {
        let started = Instant::now();
        let uploaded = Arc::new(Uploaded::new(gpu, scene, settings, watch)?);
        Self::on(gpu, scene, settings, name, uploaded, started.elapsed().as_secs_f64())
    }

    /// A pipeline of another module for the same scene and settings, which is not uploaded again.
    pub fn sibling(&self, gpu: &Gpu, scene: &Scene, settings: &Settings, name: &str) -> Result<Self> {
        Self::on(gpu, scene, settings, name, self.scene.clone(), self.build_seconds)
    }

    fn on(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        name: &str,
        uploaded: Arc<Uploaded>,
        build_seconds: f64,
    ) -> Result<Self> {
        let started = Instant::now();
        let [param0, param1, param2, param3] = settings.technique.words();
        let mut special = Specialisation {
            length_layers: settings.layers(),
            strategies: settings.strategies.is_some(),
            max_depth: settings.max_depth.unwrap_or(NONE),
            rr_depth: settings.rr_depth,
            filter: settings.filter.parameters().0,
            wide_loads: gpu.survey().kind == DeviceKind::Cpu,
            select_stack: gpu.survey().kind == DeviceKind::Cpu,
            unroll_texels: gpu.survey().kind != DeviceKind::Cpu,
            stack_size: uploaded.stack_size,
            inline_count: uploaded.inline.len() as u32,
            sobol: settings.sampler == Sampler::Sobol,
            param0,
            param1,
            param2,
            param3,
            ..Specialisation::default()
        };
        settings.needs(scene).specialise(&mut special);
        special.camera = settings.image_plane(scene)?.kind;
        let mut constants = special.words();
        let coordinates = uploaded.inline.iter().flat_map(|triangle| [triangle.v0, triangle.v1, triangle.v2]).flatten();
        constants.extend((INLINE_FIRST_ID..).zip(coordinates.map(f32::to_bits)));
        let kernel =
            gpu::Kernel { module: name, constants: &constants, driver_specialises: settings.driver_specialises };
        let (pipeline, bindings) = Self::make(gpu, &kernel, &uploaded)?;
        let compile_seconds = started.elapsed().as_secs_f64();
        spent::compiled(compile_seconds);
        Ok(Self {
            pipeline,
            bindings,
            scene: uploaded,
            build_seconds,
            compile_seconds,
            module: name.to_owned(),
            constants,
            driver_specialises: settings.driver_specialises,
        })
    }

    fn make(gpu: &Gpu, kernel: &gpu::Kernel, scene: &Uploaded) -> Result<(Pipeline, Bindings)> {
        let pipeline = Pipeline::new(gpu, kernel, scene.tlas.is_some())?;
        let bindings = pipeline.bind(&scene.uniforms, scene.tlas.as_ref())?;
        Ok((pipeline, bindings))
    }

    /// Makes the same pipeline once more, beside the old one, which goes then: its code comes to lie elsewhere.
    pub fn remake(&mut self, gpu: &Gpu) -> Result<()> {
        let kernel = gpu::Kernel {
            module: &self.module,
            constants: &self.constants,
            driver_specialises: self.driver_specialises,
        };
        (self.pipeline, self.bindings) = Self::make(gpu, &kernel, &self.scene)?;
        Ok(())
    }
}
