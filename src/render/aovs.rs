//! AOVs (arbitrary output variables): what the camera sees of surfaces, for denoisers and compositing.
//!
//! A kernel of its own samples them where the image's samples stand, once the image is there: so they go with every technique, and no
//! checkpoint need hold them.

use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;

use super::device_scene::DeviceScene;
use super::frames::{Frame, FramePlan};
use super::kernel::Kernel;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{AovPixel, AovTable, FrameConstants, WORKGROUP, address};
use crate::scene::Scene;
use crate::techniques::{AovSettings, FrameLimits, Settings};

/// The most samples per pixel that AOVs are made of, however many the image has: their noise is that of edges, textures and the lens alone.
pub const MOST_SAMPLES: u32 = 1024;

/// The kernel's name, before that of the backend.
pub(super) const MODULE: &str = "film/aov";

/// An AOV.
#[derive(Clone, Copy, Debug)]
pub struct AovRow {
    /// Its name, for `--aov`, and the name of its layer.
    pub name: &'static str,
    /// The layer's channels, as programs that read such layers look for them.
    pub channels: &'static [&'static str],
    /// What its values are.
    pub about: &'static str,
    /// Its values, of the sums over a number of samples in a scene around that origin.
    value: fn(&AovPixel, f64, DVec3) -> [f64; 3],
}

const RGB: &[&str] = &["R", "G", "B"];
const XYZ: &[&str] = &["X", "Y", "Z"];

/// The mean of three sums.
fn mean(sum: [f32; 3], samples: f64) -> [f64; 3] {
    sum.map(|sum| f64::from(sum) / samples)
}

/// Every AOV.
pub const AOVS: [AovRow; 9] = [
    AovRow {
        name: "albedo",
        channels: RGB,
        about: "colour of the surface, 0 to 1: reflectance or base colour, of metals times their Fresnel reflectance; of glass white",
        value: |sums, samples, _| mean(sums.albedo, samples),
    },
    AovRow {
        name: "normal",
        channels: XYZ,
        about: "unit shading normal in world space, with normal and bump maps; not turned to the camera",
        value: |sums, samples, _| mean(sums.normal, samples),
    },
    AovRow {
        name: "geometric_normal",
        channels: XYZ,
        about: "unit normal of the triangle or sphere in world space; not turned to the camera",
        value: |sums, samples, _| mean(sums.geometric_normal, samples),
    },
    AovRow {
        name: "position",
        channels: XYZ,
        about: "position in world space, in scene units",
        value: |sums, samples, origin| {
            let moved = origin * (f64::from(sums.coverage) / samples);
            (DVec3::from(mean(sums.position, samples)) + moved).to_array()
        },
    },
    AovRow {
        name: "depth",
        channels: &["Z"],
        about: "distance along the ray from the camera or its lens, in scene units",
        value: |sums, samples, _| [f64::from(sums.depth) / samples, 0.0, 0.0],
    },
    AovRow {
        name: "uv",
        channels: &["U", "V"],
        about: "texture coordinates",
        value: |sums, samples, _| [f64::from(sums.uv[0]) / samples, f64::from(sums.uv[1]) / samples, 0.0],
    },
    AovRow {
        name: "material_id",
        channels: &["X"],
        about: "number of the material, from 1; 0 where no surface is, or one without a material on that side",
        value: |sums, _, _| [f64::from(sums.material_id), 0.0, 0.0],
    },
    AovRow {
        name: "object_id",
        channels: &["X"],
        about: "number of the shape in the order of the file, from 1, counted again in each instance; 0 where no surface is",
        value: |sums, _, _| [f64::from(sums.object_id), 0.0, 0.0],
    },
    AovRow {
        name: "emission",
        channels: RGB,
        about: "radiance that the surface or the background itself emits, W/(m² sr)",
        value: |sums, samples, _| mean(sums.emission, samples),
    },
];

/// The AOV of that name.
pub fn find(name: &str) -> Option<&'static AovRow> {
    AOVS.iter().find(|row| row.name == name)
}

/// The AOVs of an image.
#[derive(Clone, Debug)]
pub struct AovFilm {
    /// Samples of each pixel.
    pub samples: u32,
    pixels: Vec<AovPixel>,
    origin: DVec3,
}

impl AovFilm {
    /// The values of an AOV, row by row from the upper left; those beyond its channels are 0.
    pub fn values(&self, row: &AovRow) -> Vec<[f32; 3]> {
        let value = |sums: &AovPixel| (row.value)(sums, f64::from(self.samples), self.origin);
        self.pixels.iter().map(|sums| value(sums).map(|channel| channel as f32)).collect()
    }
}

/// What the buffers are called.
const SUMS: &str = "AOVs";
const NUMBERS: &str = "AOV objects";

/// Bytes of each buffer on the device, for a scene that has so many instances there.
pub(super) fn bytes(scene: &Scene, settings: &Settings, instances: u64) -> [(&'static str, u64); 4] {
    [
        (SUMS, settings.pixels() * size_of::<AovPixel>() as u64),
        (NUMBERS, 4 * scene.primitives.len() as u64),
        (NUMBERS, 4 * instances),
        (NUMBERS, size_of::<AovTable>() as u64),
    ]
}

/// The kernel with what it reads and writes.
pub(super) struct AovPass {
    kernel: Kernel,
    pixels: Buffer,
    table: Buffer,
    origin: DVec3,
    /// What the table refers to.
    _shapes: Buffer,
    _objects: Buffer,
}

impl AovPass {
    /// For a scene that is on the device.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        device_scene: &Arc<DeviceScene>,
        own: AovSettings,
    ) -> Result<Self> {
        let pixels = Buffer::zeroed(gpu, SUMS, settings.pixels() * size_of::<AovPixel>() as u64)?;
        let shapes = Buffer::gathered(gpu, NUMBERS, &scene.shape_numbers(), device_scene.order())?;
        let objects = Buffer::gathered(gpu, NUMBERS, &scene.object_numbers(), device_scene.instance_order())?;
        let table = AovTable {
            pixels: address(pixels.address()),
            shapes: address(shapes.address()),
            objects: address(objects.address()),
            through_specular: u32::from(own.through_specular),
        };
        let module = format!("{MODULE}.{}", settings.backend.name());
        Ok(Self {
            kernel: Kernel::new(gpu, scene, settings, &module, device_scene.clone())?,
            pixels,
            table: Buffer::with_data(gpu, NUMBERS, &[table])?,
            origin: scene.origin,
            _shapes: shapes,
            _objects: objects,
        })
    }

    /// Runs a part of the image; of a frame of nothing CPU devices compile.
    pub fn dispatch(&self, gpu: &Gpu, frame: Frame, constants: FrameConstants) -> Result<()> {
        let constants = FrameConstants { technique: address(self.table.address()), ..constants };
        let Frame { first_slot, slots, first_sample, samples, .. } = frame;
        let work =
            format!("{slots} pixels from slot {first_slot}, samples {first_sample} to {}", first_sample + samples);
        let workgroups = slots.div_ceil(WORKGROUP).max(1);
        gpu.run("AOVs", &work, |commands| {
            commands.dispatch(&self.kernel.pipeline, &self.kernel.bindings, bytemuck::bytes_of(&constants), workgroups);
            commands.barrier();
        })?;
        Ok(())
    }

    /// Samples all of the image anew; `constants` are those of a frame.
    pub fn render(
        &self,
        gpu: &Gpu,
        settings: &Settings,
        samples: u32,
        constants: impl Fn(Frame) -> FrameConstants,
    ) -> Result<AovFilm> {
        let samples = samples.clamp(1, MOST_SAMPLES);
        self.pixels.clear()?;
        let most_slots = gpu.limits().max_workgroups.saturating_mul(WORKGROUP).max(WORKGROUP);
        let mut plan = FramePlan::new(settings.width, settings.height, 1, most_slots, FrameLimits::NONE);
        while let Some(frame) = plan.next(samples) {
            let started = Instant::now();
            self.dispatch(gpu, frame, constants(frame))?;
            plan.done(frame, started.elapsed());
        }
        Ok(AovFilm { samples, pixels: self.pixels.read(settings.pixels() as usize)?, origin: self.origin })
    }
}
