//! Raw ray throughput by kind of ray: `lumbre rays`.
//!
//! One set of rays is made for a scene and traced by every backend, from memory and with nothing else in the kernel.

use serde::Serialize;

use crate::backend::Backend;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{RAY_BOUNCES, RayRecord};
use crate::render::{Probe, Settings, Technique};
use crate::scene::Scene;

/// A kind of ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RayKind {
    /// From the camera through neighbouring pixels: coherent.
    Primary,
    /// From where paths hit towards a light: any hit ends it.
    Shadow,
    /// From where paths hit, as a diffuse surface scatters: incoherent.
    DiffuseBounce,
}

/// What one backend did with one kind of ray.
#[derive(Clone, Debug, Serialize)]
pub struct Throughput {
    /// The backend.
    pub backend: &'static str,
    /// The kind of ray.
    pub kind: RayKind,
    /// How many there were.
    pub rays: usize,
    /// Share of them that hit something.
    pub hit: f64,
    /// Mrays/s of each run, by the device's clock, in the order of the runs.
    pub runs: Vec<f64>,
    /// Their median.
    pub mrays_per_s: f64,
}

/// The acceleration structure of one backend.
#[derive(Clone, Debug, Serialize)]
pub struct Structure {
    /// The backend.
    pub backend: &'static str,
    /// Seconds to build and upload it, with the scene's arrays.
    pub build_seconds: f64,
    /// Its bytes on the device: nodes, or the driver's structure.
    pub bytes: u64,
}

/// All that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// `lumbre-rays-1`.
    pub schema: &'static str,
    /// The device's name.
    pub device: String,
    /// Its driver.
    pub driver: String,
    /// Triangles and spheres in the scene.
    pub primitives: usize,
    /// One entry per backend.
    pub structures: Vec<Structure>,
    /// One entry per backend and kind.
    pub throughput: Vec<Throughput>,
}

/// Traces each kind of ray `repeats` times on each backend, in turn, after one run that does not count.
pub fn measure(
    gpu: &Gpu,
    scene: &Scene,
    backends: &[Backend],
    size: (u32, u32),
    repeats: usize,
) -> Result<Measurement> {
    let settings = |backend| -> Result<Settings> {
        let mut settings = Settings::new(scene, Technique::parse("path")?, backend);
        (settings.width, settings.height) = size;
        Ok(settings)
    };
    let sets = make_rays(gpu, scene, &settings(backends.first().copied().unwrap_or(Backend::Bvh))?)?;

    let mut structures = Vec::new();
    let mut probes = Vec::new();
    for backend in backends {
        let settings = settings(*backend)?;
        let closest = Probe::new(gpu, scene, &settings, "rays/closest")?;
        let any = Probe::new(gpu, scene, &settings, "rays/any")?;
        let of_structure = |name: &&str| matches!(*name, "nodes" | "instances" | "acceleration structure");
        let bytes = closest.bytes().iter().filter(|(name, _)| of_structure(name)).map(|(_, bytes)| bytes).sum();
        structures.push(Structure { backend: backend.name(), build_seconds: closest.build_seconds(), bytes });
        probes.push((*backend, closest, any));
    }

    let mut throughput = Vec::new();
    for (kind, rays) in sets {
        let from = Buffer::with_data(gpu, "rays", &rays)?;
        let to = Buffer::zeroed(gpu, "distances", 4 * rays.len() as u64)?;
        let mut rows: Vec<Throughput> = Vec::new();
        for (backend, ..) in &probes {
            rows.push(Throughput {
                backend: backend.name(),
                kind,
                rays: rays.len(),
                hit: 0.0,
                runs: Vec::new(),
                mrays_per_s: 0.0,
            });
        }
        for run in 0..=repeats {
            for ((_, closest, any), row) in probes.iter().zip(&mut rows) {
                let probe = if kind == RayKind::Shadow { any } else { closest };
                let work = probe.run_on(&from, &to, rays.len() as u32)?;
                if run > 0 {
                    row.runs.push(rays.len() as f64 / work.device.as_secs_f64().max(1e-9) / 1e6);
                } else {
                    let distances: Vec<f32> = to.read(rays.len())?;
                    row.hit =
                        distances.iter().filter(|distance| **distance > 0.0).count() as f64 / rays.len().max(1) as f64;
                }
            }
        }
        for mut row in rows {
            row.mrays_per_s = median(&row.runs);
            throughput.push(row);
        }
    }
    Ok(Measurement {
        schema: "lumbre-rays-1",
        device: gpu.survey().name.clone(),
        driver: gpu.survey().driver.clone(),
        primitives: scene.primitives.len(),
        structures,
        throughput,
    })
}

/// The rays of each kind; those of paths that left the scene are taken out.
fn make_rays(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Vec<(RayKind, Vec<RayRecord>)>> {
    let slots = settings.width.div_ceil(8) * settings.height.div_ceil(8) * 64;
    let sets = 1 + 2 * RAY_BOUNCES as usize;
    let records = Buffer::zeroed(gpu, "rays", sets as u64 * u64::from(slots) * size_of::<RayRecord>() as u64)?;
    let unused = Buffer::zeroed(gpu, "film", u64::from(settings.width) * u64::from(settings.height) * 48)?;
    Probe::new(gpu, scene, settings, "rays/make")?.run_on(&records, &unused, slots)?;
    let all: Vec<RayRecord> = records.read(sets * slots as usize)?;
    let mut kinds =
        vec![(RayKind::Primary, Vec::new()), (RayKind::Shadow, Vec::new()), (RayKind::DiffuseBounce, Vec::new())];
    for (index, set) in all.chunks_exact(slots as usize).enumerate() {
        let kind = if index == 0 { 0 } else { 1 + (index - 1) % 2 };
        kinds[kind].1.extend(set.iter().filter(|ray| ray.t_max > 0.0));
    }
    kinds.retain(|(_, rays)| !rays.is_empty());
    Ok(kinds)
}

/// The median of some values.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => 0.0,
        count if count % 2 == 1 => sorted[middle],
        _ => (sorted[middle - 1] + sorted[middle]) / 2.0,
    }
}
