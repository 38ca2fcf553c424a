//! Running the kernels of `shaders/kernels/test` and `shaders/kernels/rays` over arrays: how tests and `lumbre rays` reach the shaders'
//! functions one by one.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use bytemuck::Pod;

use super::device_scene::{DeviceScene, sphere_radius};
use super::frames::Frame;
use super::kernel::Kernel;
use super::spent;
use super::{Renderer, Settings, memory};
use crate::error::{Error, Result};
use crate::gpu::{Buffer, Gpu, Work};
use crate::layout::{FrameConstants, LightSubpathTable, WORKGROUP, address};
use crate::scene::Scene;

/// A kernel of `shaders/kernels/test` or `shaders/kernels/rays` with the scene that it runs on.
pub struct Probe {
    gpu: Gpu,
    kernel: Kernel,
    name: String,
    seed: u32,
    scene_radius: f32,
    /// Whether it has run: CPU devices compile when it does so first.
    has_run: AtomicBool,
}

fn compile(
    gpu: &Gpu,
    scene: &Scene,
    settings: &Settings,
    module: &str,
    device_scene: Arc<DeviceScene>,
) -> Result<Kernel> {
    let started = Instant::now();
    let kernel = Kernel::new(gpu, scene, settings, module, device_scene)?;
    spent::compiled(started.elapsed().as_secs_f64());
    Ok(kernel)
}

impl Probe {
    /// Makes the kernel `shaders/<name>.glsl` for a scene and the backend of `settings`.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &Settings, name: &str) -> Result<Self> {
        let module = format!("{name}.{}", settings.backend.name());
        settings.check(gpu, scene)?;
        settings.technique.row.state().check(gpu, settings)?;
        memory::check_scene(gpu, scene, settings)?;
        let device_scene = Arc::new(DeviceScene::new(gpu, scene, settings, &|_| {})?);
        let kernel = compile(gpu, scene, settings, &module, device_scene)?;
        Ok(Self::of(gpu, scene, settings, name, kernel))
    }

    /// Another kernel for the same scene and settings, which are not uploaded again.
    pub fn sibling(&self, scene: &Scene, settings: &Settings, name: &str) -> Result<Self> {
        let module = format!("{name}.{}", settings.backend.name());
        let kernel = compile(&self.gpu, scene, settings, &module, self.kernel.scene.clone())?;
        Ok(Self::of(&self.gpu, scene, settings, name, kernel))
    }

    fn of(gpu: &Gpu, scene: &Scene, settings: &Settings, name: &str, kernel: Kernel) -> Self {
        Self {
            gpu: gpu.clone(),
            kernel,
            name: name.to_owned(),
            seed: settings.seed,
            scene_radius: sphere_radius(scene),
            has_run: AtomicBool::new(false),
        }
    }

    /// Runs one thread per element of `input`, each of which writes one element of the result.
    pub fn run<I: Pod, O: Pod>(&self, input: &[I]) -> Result<Vec<O>> {
        // One light subpath.
        let table = LightSubpathTable { light_path_count: 1, ..LightSubpathTable::default() };
        let table = Buffer::with_data(&self.gpu, "probe table", &[table])?;
        self.run_with(input, address(table.address()))
    }

    /// Runs one thread per element of buffers that are already there.
    pub fn run_on(&self, from: &Buffer, to: &Buffer, count: u32) -> Result<Work> {
        self.dispatch(self.constants(from, to, count), count)
    }

    /// Runs one thread per element of `input`, on the technique's state of a rendering under way with the same scene and settings.
    pub fn run_on_state<I: Pod, O: Pod>(&self, renderer: &Renderer, input: &[I]) -> Result<Vec<O>> {
        self.run_with(input, renderer.constants(Frame::NOTHING).technique)
    }

    fn run_with<I: Pod, O: Pod>(&self, input: &[I], technique: [u32; 2]) -> Result<Vec<O>> {
        let count = input.len() as u32;
        let from = Buffer::with_data(&self.gpu, "probe input", input)?;
        let to = Buffer::zeroed(&self.gpu, "probe output", size_of::<O>() as u64 * input.len() as u64)?;
        self.dispatch(FrameConstants { technique, ..self.constants(&from, &to, count) }, count)?;
        to.read(input.len())
    }

    fn constants(&self, from: &Buffer, to: &Buffer, count: u32) -> FrameConstants {
        FrameConstants {
            film: address(to.address()),
            layers: address(from.address()),
            slot_count: count,
            sample_count: 1,
            seed: self.seed,
            // Merges are within the square of the scene's radius.
            word: (self.scene_radius / std::f32::consts::PI.sqrt()).to_bits(),
            ..FrameConstants::default()
        }
    }

    fn dispatch(&self, constants: FrameConstants, count: u32) -> Result<Work> {
        let (workgroups, most) = (count.div_ceil(WORKGROUP).max(1), self.gpu.limits().max_workgroups);
        if workgroups > most {
            let (name, device) = (&self.name, &self.gpu.survey().name);
            let fit = u64::from(most) * u64::from(WORKGROUP);
            return Err(Error::Usage(format!("{name} over {count} elements: {device} runs {fit} at once")));
        }
        let (kernel, started) = (&self.kernel, Instant::now());
        let work = self.gpu.run(&format!("kernel {}", self.name), &format!("{count} elements"), |commands| {
            commands.dispatch(&kernel.pipeline, &kernel.bindings, bytemuck::bytes_of(&constants), workgroups);
            commands.barrier();
        })?;
        let seconds = started.elapsed().as_secs_f64();
        if self.has_run.swap(true, Ordering::Relaxed) {
            spent::rendered(seconds, 0)
        } else {
            spent::compiled(seconds)
        }
        Ok(work)
    }

    /// The scene on the device.
    pub fn scene(&self) -> &DeviceScene {
        &self.kernel.scene
    }

    /// Bytes on the device by what they hold.
    pub fn bytes(&self) -> Vec<(&'static str, u64)> {
        self.kernel.scene.bytes()
    }

    /// For each uploaded primitive, its index in the scene: hits are reported in this order.
    pub fn order(&self) -> &[u32] {
        self.kernel.scene.order()
    }

    /// For each uploaded instance, its index in the scene.
    pub fn instance_order(&self) -> &[u32] {
        self.kernel.scene.instance_order()
    }
}
