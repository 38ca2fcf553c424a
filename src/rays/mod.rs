//! Raw ray throughput by kind of ray: `lumbre rays`.
//!
//! One set of rays is made for a scene and traced by every backend, from memory and with nothing else in the kernel: once in the
//! order of the image, where neighbouring threads trace similar rays, and once shuffled, where they do not.

mod export;
mod sets;

use serde::Serialize;

use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::backend::Backend;
use crate::layout::{RayRecord, TraversalCount};
use crate::render::{Probe, Settings, Technique};
use crate::scene::Scene;

pub use export::export;
pub use sets::{RayKind, make, shuffle};

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
    /// Median of the runs, Mrays/s.
    pub mrays_per_s: f64,
    /// Mrays/s of each run, by the device's clock, for those rays in a random order.
    pub shuffled_runs: Vec<f64>,
    /// Median of the shuffled runs, Mrays/s.
    pub shuffled_mrays_per_s: f64,
    /// What traversal tests; nothing where the backend cannot count.
    pub tested: Option<Tested>,
}

/// What traversal tests for one kind of ray.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Tested {
    /// Nodes read, each with the boxes of its eight children.
    pub nodes: PerRay,
    /// Triangles, of which a pair is one, and spheres.
    pub primitives: PerRay,
}

/// A count per ray.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PerRay {
    /// The mean over rays.
    pub mean: f64,
    /// The 99th percentile, by nearest rank.
    pub p99: u32,
}

/// The acceleration structure of one backend.
#[derive(Clone, Debug, Serialize)]
pub struct Structure {
    /// The backend.
    pub backend: &'static str,
    /// Seconds to build it and have it on the device, without the scene's other arrays.
    pub build_seconds: f64,
    /// Its bytes on the device: nodes, or the driver's structure with its copy of the primitives, and instances. The array of
    /// primitives is not in it, which shading reads with either backend.
    pub bytes: u64,
    /// These bytes by the scene's primitives, each counted once however often it is placed.
    pub bytes_per_primitive: f64,
    /// Triangles that the kernel holds as constants, in which case it reads no structure.
    pub compiled_in: usize,
}

/// All that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// `lumbre-rays-2`.
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

/// The kernels of one backend, and its settings.
struct RayProbe {
    backend: Backend,
    closest: Probe,
    any: Probe,
    count: Option<Probe>,
}

impl RayProbe {
    fn new(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<Self> {
        let closest = Probe::new(gpu, scene, settings, "rays/closest")?;
        let any = closest.sibling(scene, settings, "rays/any")?;
        let counts = settings.backend.counts();
        let count = counts.then(|| closest.sibling(scene, settings, "rays/count")).transpose()?;
        Ok(Self { backend: settings.backend, closest, any, count })
    }

    fn structure(&self, scene: &Scene) -> Structure {
        let uploaded = self.closest.scene();
        let bytes = uploaded.structure_bytes();
        Structure {
            backend: self.backend.name(),
            build_seconds: uploaded.structure_seconds(),
            bytes,
            bytes_per_primitive: bytes as f64 / scene.primitives.len().max(1) as f64,
            compiled_in: uploaded.inline_count(),
        }
    }

    fn tested(&self, kind: RayKind, rays: &[RayRecord]) -> Result<Option<Tested>> {
        let Some(probe) = &self.count else { return Ok(None) };
        let counts: Vec<TraversalCount> = probe.run(rays)?;
        let per_ray = |closest: fn(&TraversalCount) -> u32, any: fn(&TraversalCount) -> u32| {
            per_ray(counts.iter().map(if kind == RayKind::Shadow { any } else { closest }).collect())
        };
        Ok(Some(Tested {
            nodes: per_ray(|count| count.closest_nodes, |count| count.any_nodes),
            primitives: per_ray(|count| count.closest_primitives, |count| count.any_primitives),
        }))
    }
}

/// The settings with which rays of an image of this size are made and traced.
pub fn settings(scene: &Scene, backend: Backend, (width, height): (u32, u32)) -> Result<Settings> {
    Ok(Settings { width, height, ..Settings::new(scene, Technique::parse("path")?, backend) })
}

/// Traces each kind of ray `repeats` times on each backend, in order and shuffled, in turn, after one run that does not count.
pub fn measure(
    gpu: &Gpu,
    scene: &Scene,
    backends: &[Backend],
    size: (u32, u32),
    kinds: &[(RayKind, Vec<RayRecord>)],
    repeats: usize,
) -> Result<Measurement> {
    let mut probes = Vec::new();
    for backend in backends {
        probes.push(RayProbe::new(gpu, scene, &settings(scene, *backend, size)?)?);
    }
    let mut throughput = Vec::new();
    for (kind, rays) in kinds {
        throughput.extend(trace(gpu, &probes, *kind, rays, repeats)?);
    }
    Ok(Measurement {
        schema: "lumbre-rays-2",
        device: gpu.survey().name.clone(),
        driver: gpu.survey().driver.clone(),
        primitives: scene.primitives.len(),
        structures: probes.iter().map(|probe| probe.structure(scene)).collect(),
        throughput,
    })
}

/// One row per backend for one kind of ray.
fn trace(gpu: &Gpu, probes: &[RayProbe], kind: RayKind, rays: &[RayRecord], repeats: usize) -> Result<Vec<Throughput>> {
    let mixed: Vec<RayRecord> = shuffle(rays.len()).into_iter().map(|index| rays[index as usize]).collect();
    let ordered = Buffer::with_data(gpu, "rays", rays)?;
    let shuffled = Buffer::with_data(gpu, "shuffled rays", &mixed)?;
    drop(mixed);
    let to = Buffer::zeroed(gpu, "distances", 4 * rays.len() as u64)?;
    let mut rows = Vec::new();
    for probe in probes {
        rows.push(Throughput {
            backend: probe.backend.name(),
            kind,
            rays: rays.len(),
            hit: 0.0,
            runs: Vec::new(),
            mrays_per_s: 0.0,
            shuffled_runs: Vec::new(),
            shuffled_mrays_per_s: 0.0,
            tested: probe.tested(kind, rays)?,
        });
    }
    for run in 0..=repeats {
        for (of_backend, row) in probes.iter().zip(&mut rows) {
            let probe = if kind == RayKind::Shadow { &of_backend.any } else { &of_backend.closest };
            for (from, runs) in [(&ordered, &mut row.runs), (&shuffled, &mut row.shuffled_runs)] {
                let work = probe.run_on(from, &to, rays.len() as u32)?;
                if run > 0 {
                    runs.push(rays.len() as f64 / work.device.as_secs_f64().max(1e-9) / 1e6);
                }
            }
            if run == 0 {
                let distances: Vec<f32> = to.read(rays.len())?;
                row.hit = distances.iter().filter(|distance| **distance > 0.0).count() as f64 / rays.len() as f64;
            }
        }
    }
    for row in &mut rows {
        row.mrays_per_s = median(&row.runs);
        row.shuffled_mrays_per_s = median(&row.shuffled_runs);
    }
    Ok(rows)
}

fn per_ray(mut counts: Vec<u32>) -> PerRay {
    counts.sort_unstable();
    let rank = (counts.len() * 99).div_ceil(100).max(1) - 1;
    PerRay {
        mean: counts.iter().map(|count| f64::from(*count)).sum::<f64>() / counts.len().max(1) as f64,
        p99: counts.get(rank).copied().unwrap_or(0),
    }
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
