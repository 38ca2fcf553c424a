//! What a rendering will take on the device, by kind, before anything is built; and whether the device has room for it.

use serde::Serialize;

use super::aovs;
use super::blocks;
use super::device_scene::most_in_part;
use crate::error::{Bytes, Error, Result, all_of};
use crate::gpu::Gpu;
use crate::gpu::accel::{self, BuildSizes};
use crate::layout::backend::Backend;
use crate::layout::{
    self, ARRAY_NAMES, BAD_SAMPLES, FilmPixel, Light, Material, NODE_BYTES, RAY_COUNTERS, SceneUniforms, Surface,
    UNIFORM_LIGHTS, UNIFORM_MATERIALS, UNIFORM_SURFACES, VEC3_BYTES,
};
use crate::scene::{Filter, Needs, Scene};
use crate::techniques::Settings;

/// Bytes of one pixel of one layer by path length: two sums of three floats.
pub(super) const LAYER_PIXEL_BYTES: u64 = 2 * VEC3_BYTES as u64;
/// Bytes of the counters that the host reads after each frame.
pub(super) const TALLY_BYTES: u64 = 4 * (1 + 2 * BAD_SAMPLES as u64 + RAY_COUNTERS as u64);
/// The most instances whose index fits into the 24 bits that a driver's instance has for it.
const MOST_PLACED: u64 = 1 << 24;

/// What one kind of data takes on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Part {
    /// What it is, as [`super::DeviceScene::bytes`] calls it.
    pub name: &'static str,
    /// Its bytes.
    pub bytes: u64,
    /// Bytes of the largest allocation that it takes.
    pub largest: u64,
    /// Whether that is what will be allocated; otherwise it is an estimate (`nodes`), or the most that it can be before the
    /// driver compacts it (`acceleration structure`).
    pub exact: bool,
}

/// What a rendering takes on the device.
#[derive(Clone, Debug, Serialize)]
pub struct Prediction {
    /// The backend's name.
    pub backend: &'static str,
    /// Width of the film in pixels.
    pub width: u32,
    /// Height of the film in pixels.
    pub height: u32,
    /// What is held while it renders, the largest first. What takes nothing is left out.
    pub parts: Vec<Part>,
    /// Bytes of all parts together.
    pub total: u64,
    /// The most bytes that are held at any time, also while acceleration structures are built and compacted.
    pub peak: u64,
    /// The most bytes at any time where nothing is compacted, which there need not be room for.
    #[serde(skip)]
    required: u64,
}

impl Prediction {
    /// Of a rendering with these settings. The driver of `gpu` is asked about the sizes of acceleration structures: backend
    /// `ray-query` must not be refused there. Backend `bvh` needs no device.
    pub fn of(scene: &Scene, settings: &Settings, gpu: Option<&Gpu>) -> Result<Self> {
        let mut table = Table::default();
        table.film(settings);
        table.aovs(scene, settings, gpu);
        for part in settings.technique.row.state().bytes(scene, settings)? {
            table.add(part.name, part.bytes, part.exact);
        }
        Self::with_scene(table, scene, settings, gpu)
    }

    /// The scene alone, for kernels without a film.
    pub(super) fn of_scene(scene: &Scene, settings: &Settings, gpu: &Gpu) -> Result<Self> {
        Self::with_scene(Table::default(), scene, settings, Some(gpu))
    }

    fn with_scene(mut table: Table, scene: &Scene, settings: &Settings, gpu: Option<&Gpu>) -> Result<Self> {
        let needs = settings.needs(scene);
        let (required, peak) = match settings.backend {
            Backend::Bvh => {
                table.bvh(scene, &needs);
                (0, 0)
            }
            Backend::RayQuery => {
                let gpu = gpu.ok_or_else(|| {
                    Error::Device(String::from("the size of acceleration structures is the driver's to tell"))
                })?;
                table.ray_query(gpu, scene)?
            }
        };
        table.arrays(scene, settings, &needs);
        let mut parts = table.0;
        parts.retain(|part| part.bytes > 0);
        parts.sort_by(|a, b| b.bytes.cmp(&a.bytes).then(a.name.cmp(b.name)));
        let total = parts.iter().fold(0u64, |sum, part| sum.saturating_add(part.bytes));
        let (width, height) = (settings.width, settings.height);
        let backend = settings.backend.name();
        Ok(Self { backend, width, height, parts, total, peak: total.max(peak), required: total.max(required) })
    }

    /// Why the device has no room for it; nothing where it has.
    fn refusal(&self, gpu: &Gpu) -> Option<String> {
        let (limits, free) = (gpu.limits(), gpu.free_memory());
        if self.required > free {
            let largest = self.parts.iter().take(3).map(|part| format!("{} {}", part.name, Bytes(part.bytes)));
            return Some(format!(
                "the rendering needs {} on {}, which has {} free: {}",
                Bytes(self.required),
                gpu.survey().name,
                Bytes(free),
                all_of(largest)
            ));
        }
        let most = limits.max_allocation.min(limits.max_buffer);
        let large = self.parts.iter().find(|part| part.largest > most)?;
        Some(format!(
            "{} needs {} in one piece, and {} allows {}",
            large.name,
            Bytes(large.largest),
            gpu.survey().name,
            Bytes(most)
        ))
    }
}

/// Fails where the device has no room for a rendering, with what would fit.
pub(super) fn check(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<()> {
    check_instances(gpu, scene, settings)?;
    let refusal = |settings: &Settings| -> Result<Option<String>> {
        Ok(Prediction::of(scene, settings, Some(gpu))?.refusal(gpu))
    };
    let Some(why) = refusal(settings)? else {
        return if u32::try_from(settings.slots()).is_ok() {
            Ok(())
        } else {
            Err(Error::Device(format!(
                "an image of {}x{} pixels: all together they must be fewer than 2^32",
                settings.width, settings.height
            )))
        };
    };
    let plain = Settings { lengths: 0, strategies: None, ..settings.clone() };
    if settings.layers() > 0 && refusal(&plain)?.is_none() {
        let layers = if settings.lengths > 0 { "path length (--lengths)" } else { "strategy (--strategies)" };
        return Err(Error::Device(format!("{why}; without layers by {layers} it fits")));
    }
    let mut smaller = settings.clone();
    while smaller.width > 1 || smaller.height > 1 {
        (smaller.width, smaller.height) = (smaller.width.div_ceil(2), smaller.height.div_ceil(2));
        if refusal(&smaller)?.is_none() {
            return Err(Error::Device(format!("{why}; --size {}x{} fits", smaller.width, smaller.height)));
        }
    }
    Err(Error::Device(format!("{why}; no image is small enough, since the scene alone does not fit")))
}

/// An error of building a rendering; where the device had no room although its driver had promised it, with what a smaller image takes.
pub(super) fn advise(gpu: &Gpu, scene: &Scene, settings: &Settings, error: Error) -> Error {
    let Error::OutOfMemory { what, needs, in_use, limit } = error else { return error };
    let smaller =
        Settings { width: settings.width.div_ceil(2), height: settings.height.div_ceil(2), ..settings.clone() };
    let [all, less] = [settings, &smaller].map(|settings| {
        Prediction::of(scene, settings, Some(gpu))
            .map_or(String::from("an unknown size"), |it| Bytes(it.peak).to_string())
    });
    let (width, height) = (smaller.width, smaller.height);
    let limit = format!("{limit}; the rendering takes {all} in all, --size {width}x{height} {less}");
    Error::OutOfMemory { what, needs, in_use, limit }
}

/// Fails where the device has no room for a scene, for kernels without a film.
pub(super) fn check_scene(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<()> {
    check_instances(gpu, scene, settings)?;
    match Prediction::of_scene(scene, settings, gpu)?.refusal(gpu) {
        None => Ok(()),
        Some(why) => Err(Error::Device(why)),
    }
}

fn check_instances(gpu: &Gpu, scene: &Scene, settings: &Settings) -> Result<()> {
    if settings.backend != Backend::RayQuery {
        return Ok(());
    }
    let (parts, placed) = (parts(gpu, scene).len(), placements(gpu, scene));
    let most = gpu.limits().max_instances.min(MOST_PLACED);
    if placed > most {
        return Err(Error::Device(format!(
            "the scene's {} instances place {placed} of its {parts} meshes, and {} allows {most} in an acceleration structure; --backend bvh takes them",
            scene.instances.len(),
            gpu.survey().name
        )));
    }
    Ok(())
}

/// Primitives of each bottom-level structure, and whether they are spheres.
fn parts(gpu: &Gpu, scene: &Scene) -> Vec<(u32, bool)> {
    let most = most_in_part(gpu) as u32;
    let mut all = Vec::new();
    for group in &scene.groups {
        for (range, spheres) in [(&group.triangles, false), (&group.spheres, true)] {
            let mut rest = range.len() as u32;
            while rest > 0 {
                all.push((rest.min(most), spheres));
                rest -= rest.min(most);
            }
        }
    }
    all
}

/// Instances of bottom-level structures.
fn placements(gpu: &Gpu, scene: &Scene) -> u64 {
    let most = most_in_part(gpu);
    let of_group =
        |group: &crate::scene::Group| group.triangles.len().div_ceil(most) + group.spheres.len().div_ceil(most);
    scene.instances.iter().map(|placed| of_group(&scene.groups[placed.group]) as u64).sum()
}

/// Nodes of a tree over so many primitives. The builder puts ten primitives on each node to within a few percent, where it makes no pairs of
/// them; twelve where all are in pairs, and eight where just enough are.
fn estimated_nodes(primitives: u64) -> u64 {
    1 + primitives / 10
}

/// The parts while they are collected.
#[derive(Default)]
struct Table(Vec<Part>);

impl Table {
    fn add(&mut self, name: &'static str, bytes: u64, exact: bool) {
        // As buffers round it.
        let bytes = if bytes == 0 { 0 } else { bytes.max(4).next_multiple_of(4) };
        match self.0.iter_mut().find(|part| part.name == name) {
            Some(part) => {
                part.bytes = part.bytes.saturating_add(bytes);
                part.largest = part.largest.max(bytes);
            }
            None => self.0.push(Part { name, bytes, largest: bytes, exact }),
        }
    }

    fn list<T>(&mut self, name: &'static str, list: &[T]) {
        self.add(name, size_of_val(list) as u64, true);
    }

    fn film(&mut self, settings: &Settings) {
        let pixels = settings.pixels();
        self.add("film", pixels * size_of::<FilmPixel>() as u64, true);
        // A buffer of nothing takes four bytes.
        self.add("film by path length", (pixels * u64::from(settings.layers()) * LAYER_PIXEL_BYTES).max(4), true);
        for _ in 0..blocks::planes(settings.layers()) {
            self.add(blocks::NAME, blocks::plane_bytes(pixels), true);
        }
        self.add("tally", TALLY_BYTES, true);
    }

    fn aovs(&mut self, scene: &Scene, settings: &Settings, gpu: Option<&Gpu>) {
        if settings.aovs.is_none() {
            return;
        }
        let instances = match (settings.backend, gpu) {
            (Backend::RayQuery, Some(gpu)) => placements(gpu, scene),
            _ if settings.needs(scene).instances => scene.instances.len() as u64,
            _ => 1,
        };
        for (name, bytes) in aovs::bytes(scene, settings, instances) {
            self.add(name, bytes.max(4), true);
        }
    }

    fn arrays(&mut self, scene: &Scene, settings: &Settings, needs: &Needs) {
        let whole = scene.arrays(needs).into_iter().map(|array| (array.name, array.bytes));
        for (name, bytes) in whole.chain(scene.changed_arrays()) {
            self.list(name, bytes);
        }
        if scene.primitives.is_empty() {
            self.add(ARRAY_NAMES.primitives, 4, true);
        }
        scene.images.iter().for_each(|image| self.list("images", image.bytes()));
        if settings.filter != Filter::Box {
            self.list(ARRAY_NAMES.filter_table, &settings.filter.cells());
        }
        let tables = UNIFORM_SURFACES as usize * size_of::<Surface>()
            + UNIFORM_MATERIALS as usize * size_of::<Material>()
            + UNIFORM_LIGHTS as usize * size_of::<Light>();
        self.add("uniforms", (size_of::<SceneUniforms>() + tables) as u64, true);
    }

    fn bvh(&mut self, scene: &Scene, needs: &Needs) {
        let groups: u64 = scene.groups.iter().map(|group| estimated_nodes(group.primitives().len() as u64)).sum();
        let mut nodes = groups;
        if needs.instances {
            let count = scene.instances.len() as u64;
            nodes += estimated_nodes(count);
            self.add(ARRAY_NAMES.instances, count * size_of::<layout::Instance>() as u64, true);
        }
        self.add(ARRAY_NAMES.nodes, nodes * u64::from(NODE_BYTES), false);
    }

    /// Returns what is held while the structures are built, before the other arrays are there: what building takes, and the
    /// most that it can be with copies for compaction.
    fn ray_query(&mut self, gpu: &Gpu, scene: &Scene) -> Result<(u64, u64)> {
        let (mut held, mut required, mut most) = (0u64, 0, 0);
        for (count, spheres) in parts(gpu, scene) {
            let BuildSizes { structure, scratch, input } = accel::bottom_level_sizes(gpu, count, spheres)?;
            required = required.max(held + input + structure + scratch);
            // The copy is made after the scratch memory is gone.
            most = most.max(held + input + structure + scratch.max(structure));
            held += structure;
            self.add("acceleration structure", structure, false);
        }
        let placed = placements(gpu, scene);
        let BuildSizes { structure, scratch, input } = accel::top_level_sizes(gpu, placed as u32)?;
        let top = held + input + structure + scratch;
        self.add("acceleration structure", structure, false);
        self.add(ARRAY_NAMES.instances, placed * size_of::<layout::Instance>() as u64, true);
        Ok((required.max(top), most.max(top)))
    }
}
