//! A scene on the device: its arrays, its acceleration structure, its uniforms.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::time::Instant;

use glam::{DAffine3, Vec3};
use obvhs::cwbvh::node::CwBvhNode;

use super::camera_uniforms;
use super::watch::{Building, Watch};
use crate::bvh::{Bounds, Bvh};
use crate::error::Result;
use crate::gpu::accel::{Blas, Placement, Tlas};
use crate::gpu::{Buffer, Gpu};
use crate::layout::backend::Backend;
use crate::layout::{
    self, ARRAY_NAMES, INLINE_MAX, LIGHT_SPHERE, LIGHT_TRIANGLE, NONE, PAIR_BIT, Primitive, SPHERE_BIT, SceneUniforms,
    TEXTURE_IMAGE, UNIFORM_LIGHTS, UNIFORM_MATERIALS, UNIFORM_SURFACES, address,
};
use crate::scene::compile::environment::compensated;
use crate::scene::compile::light::{importance, power};
use crate::scene::{Filter, Needs, Scene};
use crate::techniques::Settings;

/// Pixel samples from which on it pays to compile a tiny scene's triangles into the kernel.
const INLINE_WORTHWHILE: u64 = 1 << 20;

/// A scene on the device. What the scene has none of is not allocated.
pub struct DeviceScene {
    /// What the kernels that read it model of the scene.
    pub(super) needs: Needs,
    /// The uniform buffer.
    pub(super) uniforms: Buffer,
    /// The driver's acceleration structure (`ray-query`).
    pub(super) tlas: Option<Tlas>,
    /// The value of one unit of splats, W/(m² sr).
    pub(super) splat_unit: f32,
    /// Entries that traversal needs of its stack (`bvh`).
    pub(super) stack_size: u32,
    /// Leaves of the tree hold pairs of triangles (`bvh`).
    pub(super) has_pairs: bool,
    /// Triangles that the kernel holds as constants.
    pub(super) inline: Vec<Primitive>,
    buffers: Vec<(&'static str, Buffer)>,
    order: Vec<u32>,
    instance_order: Vec<u32>,
    structure_seconds: f64,
}

/// What a backend's acceleration structure asks of the arrays.
struct Built {
    /// For each uploaded primitive, its index in the scene.
    order: Vec<u32>,
    /// For each of them, whether it and the one before are a pair of triangles; empty where there are no pairs.
    paired: Vec<bool>,
    instances: Vec<layout::Instance>,
    /// For each uploaded instance, its index in the scene.
    instance_order: Vec<u32>,
    /// The trees' nodes, to follow each other.
    nodes: Vec<Vec<CwBvhNode>>,
    tlas: Option<Tlas>,
    stack_size: u32,
}

impl DeviceScene {
    pub(super) fn new(gpu: &Gpu, scene: &Scene, settings: &Settings, watch: Watch) -> Result<Self> {
        let needs = settings.needs(scene);
        let inline_fits = settings.backend == Backend::Bvh
            && settings.specialise
            && !needs.instances
            && scene.primitives.len() <= INLINE_MAX as usize
            && settings.expected_samples >= INLINE_WORTHWHILE;
        let started = Instant::now();
        let mut built = match settings.backend {
            Backend::Bvh => build_bvh(scene, &needs, settings.chunk, watch),
            Backend::RayQuery => build_ray_query(gpu, scene, watch)?,
        };
        let mut structure_seconds = started.elapsed().as_secs_f64();
        watch(Building { doing: "uploading the scene", share: Some(0.0) });
        let mut buffers = Vec::new();
        // In the order of the tree's leaves: gathered on the way to the device, because a copy would double a large scene.
        let primitives = Buffer::generated(gpu, ARRAY_NAMES.primitives, built.order.len(), |slot| {
            let primitive = scene.primitives[built.order[slot] as usize];
            let pair = if built.paired.get(slot).is_some_and(|paired| *paired) { PAIR_BIT } else { 0 };
            Primitive { surface: primitive.surface | pair, ..primitive }
        })?;
        let corners = if scene.corners.is_empty() {
            None
        } else {
            Some(Buffer::gathered(gpu, ARRAY_NAMES.corners, &scene.corners, &built.order)?)
        };
        let started = Instant::now();
        let nodes = if built.nodes.is_empty() {
            None
        } else {
            Some(Buffer::concatenated(gpu, ARRAY_NAMES.nodes, &built.nodes)?)
        };
        drop(std::mem::take(&mut built.nodes));
        structure_seconds += started.elapsed().as_secs_f64();
        let place_of = |buffer: Option<&Buffer>| buffer.map_or([0; 2], |buffer| address(buffer.address()));
        let mut upload = |name: &'static str, bytes: &[u8]| -> Result<[u32; 2]> {
            if bytes.is_empty() {
                return Ok([0, 0]);
            }
            let buffer = Buffer::with_data(gpu, name, bytes)?;
            let place = address(buffer.address());
            buffers.push((name, buffer));
            Ok(place)
        };
        let mut images = Vec::new();
        for image in &scene.images {
            images.push(upload("images", image.bytes())?);
        }
        let mut textures = scene.textures.clone();
        for texture in textures.iter_mut().filter(|texture| texture.kind == TEXTURE_IMAGE) {
            texture.texels = images[texture.texels[0] as usize];
        }
        let compensates = settings.technique.row.compensates_mis;
        // All of it is the mean, which MIS compensation leaves to BSDF samples.
        let is_left_to_bsdfs = compensates && scene.environment.is_none() && scene.lights.is_empty();
        let background_table = match &scene.environment {
            Some(environment) if compensates => Cow::Owned(compensated(&scene.background_table, environment.cells)),
            _ => Cow::Borrowed(&scene.background_table[..]),
        };
        let rotation = scene.environment.as_ref().map_or([[0.0; 3]; 3], |environment| environment.from_world);
        let filter_table = if settings.filter == Filter::Box { Vec::new() } else { settings.filter.cells() };
        let (core_centre, core_radius) = scene.core();
        let splat_unit = splat_unit(scene);
        let mut uniforms = SceneUniforms {
            width: settings.width,
            height: settings.height,
            background: scene.background.unwrap_or_default(),
            background_texture: scene.environment.as_ref().map_or(NONE, |environment| environment.texture),
            background_x: rotation[0],
            background_y: rotation[1],
            background_z: rotation[2],
            background_cells: scene.environment.as_ref().map_or([0; 2], |environment| environment.cells),
            background_probability: if is_left_to_bsdfs { 0.0 } else { scene.background_probability },
            light_count: scene.lights.len() as u32,
            table_lights: scene.table_lights,
            table_probability: scene.table_probability,
            tree_probability: (1.0 - scene.table_probability) * (1.0 - scene.background_probability),
            light_tree_origin: scene.light_tree_origin.into(),
            light_tree_scale: scene.light_tree_scale,
            centre: (0.5 * (scene.bounds.min + scene.bounds.max)).into(),
            radius: sphere_radius(scene),
            core_centre: core_centre.into(),
            core_radius: core_radius * SPHERE_MARGIN,
            splat_unit,
            filter_parameters: settings.filter.parameters().1,
            filter_scale: (1.0 / settings.filter.integral()) as f32,
            primitives: place_of(Some(&primitives)),
            corners: place_of(corners.as_ref()),
            nodes: place_of(nodes.as_ref()),
            textures: upload(ARRAY_NAMES.textures, bytemuck::cast_slice(&textures))?,
            instances: upload(ARRAY_NAMES.instances, bytemuck::cast_slice(&built.instances))?,
            background_table: upload(ARRAY_NAMES.background_table, bytemuck::cast_slice(&background_table))?,
            filter_table: upload(ARRAY_NAMES.filter_table, bytemuck::cast_slice(&filter_table))?,
            ..SceneUniforms::default()
        };
        camera_uniforms::set(&mut uniforms, scene, &settings.image_plane(scene)?);
        for array in scene.arrays(&needs) {
            *(array.address)(&mut uniforms) = upload(array.name, array.bytes)?;
        }
        buffers.push((ARRAY_NAMES.primitives, primitives));
        buffers.extend(corners.map(|buffer| (ARRAY_NAMES.corners, buffer)));
        buffers.extend(nodes.map(|buffer| (ARRAY_NAMES.nodes, buffer)));
        let mut block = bytemuck::bytes_of(&uniforms).to_vec();
        append_table(&mut block, &scene.surfaces, UNIFORM_SURFACES);
        append_table(&mut block, &scene.materials, UNIFORM_MATERIALS);
        append_table(&mut block, &scene.lights, UNIFORM_LIGHTS);
        Ok(Self {
            needs,
            uniforms: Buffer::with_data(gpu, "scene uniforms", &block)?,
            tlas: built.tlas,
            splat_unit,
            stack_size: built.stack_size,
            inline: if inline_fits {
                built.order.iter().map(|index| scene.primitives[*index as usize]).collect()
            } else {
                Vec::new()
            },
            buffers,
            has_pairs: built.paired.contains(&true),
            order: built.order,
            instance_order: built.instance_order,
            structure_seconds,
        })
    }

    /// Bytes on the device by what they hold.
    pub fn bytes(&self) -> Vec<(&'static str, u64)> {
        let mut all: Vec<_> = self.buffers.iter().map(|(name, buffer)| (*name, buffer.size())).collect();
        all.push(("uniforms", self.uniforms.size()));
        all.extend(self.tlas.iter().map(|tlas| ("acceleration structure", tlas.size())));
        all
    }

    /// Bytes of what traversal has besides the primitives, which shading reads as well: nodes or the driver's structure, which
    /// keeps a copy of the primitives, and the instances.
    pub fn structure_bytes(&self) -> u64 {
        let of_structure =
            |name: &str| [ARRAY_NAMES.nodes, ARRAY_NAMES.instances, "acceleration structure"].contains(&name);
        self.bytes().iter().filter(|(name, _)| of_structure(name)).map(|(_, bytes)| bytes).sum()
    }

    /// Primitives that the kernel holds as constants instead: traversal then reads no structure.
    pub fn inline_count(&self) -> usize {
        self.inline.len()
    }

    /// Seconds that building that structure took, its own upload included.
    pub fn structure_seconds(&self) -> f64 {
        self.structure_seconds
    }

    /// For each uploaded primitive, its index in the scene: hits are reported in this order.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// For each uploaded instance, its index in the scene.
    pub fn instance_order(&self) -> &[u32] {
        &self.instance_order
    }
}

/// The sphere around a scene is wider than it by this factor, so that no rounding puts a point outside.
const SPHERE_MARGIN: f32 = 1.0001;

/// [`SceneUniforms::radius`].
pub(super) fn sphere_radius(scene: &Scene) -> f32 {
    scene.radius() * SPHERE_MARGIN
}

/// Units of a splat in the radiance of a scene that is lit evenly: far below the contribution of any path, and sums stay far below 2^63.
const SPLAT_UNITS: f64 = (1u64 << 33) as f64;
/// The most that an emitter's radiance is above that, for the purpose of the unit: with it a sum has room for 2^14 of it.
const BRIGHTEST: f64 = 65536.0;

/// The value of one unit of the splats' fixed-point numbers, W/(m² sr).
fn splat_unit(scene: &Scene) -> f32 {
    let radius = f64::from(scene.radius());
    let flux: f64 = scene.lights.iter().map(|light| power(light, radius)).sum();
    let background = scene.background.map_or(0.0, |rgb| importance(rgb.map(f64::from)));
    let even = flux / (PI * radius).powi(2) + background;
    let area = |light: &&layout::Light| matches!(light.kind, LIGHT_TRIANGLE | LIGHT_SPHERE);
    let brightest = scene.lights.iter().filter(area).flat_map(|light| light.radiance).fold(0.0, f32::max);
    let scale = even.max(f64::from(brightest) / BRIGHTEST);
    if scale > 0.0 { (scale / SPLAT_UNITS) as f32 } else { 1.0 }
}

/// Appends a table with room for `count` entries, with what fits of `entries`.
fn append_table<T: bytemuck::Pod>(block: &mut Vec<u8>, entries: &[T], count: u32) {
    let end = block.len() + count as usize * size_of::<T>();
    block.extend_from_slice(bytemuck::cast_slice(&entries[..entries.len().min(count as usize)]));
    block.resize(end, 0);
}

/// Rows of an affine map.
fn rows(map: &DAffine3) -> [[f32; 4]; 3] {
    let m = map.matrix3.transpose();
    let row = |axis: glam::DVec3, shift: f64| [axis.x as f32, axis.y as f32, axis.z as f32, shift as f32];
    [row(m.x_axis, map.translation.x), row(m.y_axis, map.translation.y), row(m.z_axis, map.translation.z)]
}

fn instance(to_world: &DAffine3, root: u32, first_primitive: u32) -> layout::Instance {
    let [world0, world1, world2] = rows(to_world);
    let [object0, object1, object2] = rows(&to_world.inverse());
    let moved = u32::from(*to_world != DAffine3::IDENTITY);
    layout::Instance { world0, world1, world2, object0, object1, object2, root, first_primitive, moved }
}

fn build_bvh(scene: &Scene, needs: &Needs, chunk: usize, watch: Watch) -> Built {
    let mut order = Vec::with_capacity(scene.primitives.len());
    let mut paired = Vec::new();
    let mut trees = Vec::new();
    for group in &scene.groups {
        let range = group.primitives();
        let told = |count| watch(Building::tree(range.start + count, scene.primitives.len()));
        told(0);
        let mut tree = Bvh::over_primitives(&scene.primitives[range.clone()], chunk, &told);
        order.extend(std::mem::take(&mut tree.order).into_iter().map(|slot| range.start as u32 + slot));
        paired.append(&mut tree.paired);
        paired.resize(order.len(), false);
        trees.push(tree);
    }
    let top = needs.instances.then(|| {
        let bounds: Vec<Bounds> = scene.groups.iter().map(|group| scene.group_bounds(group)).collect();
        let boxes: Vec<Bounds> =
            scene.instances.iter().map(|placed| transform_bounds(&placed.to_world, bounds[placed.group])).collect();
        Bvh::build(&boxes)
    });
    let instance_order = top.as_ref().map_or(vec![0], |top| top.order.clone());
    let top_depth = top.as_ref().map_or(0, |top| top.depth);
    // Below the root each level leaves one group behind; entering an instance leaves the rest of its node's two groups.
    let below = trees.iter().map(|tree| tree.depth).max().unwrap_or(1) - 1;
    let stack_size = (if needs.instances { top_depth + 1 + below } else { below }).max(1);

    let mut nodes = Vec::new();
    let mut instances = Vec::new();
    let mut next_root = top.as_ref().map_or(0, |top| top.nodes.len() as u32);
    let mut roots = Vec::new();
    for tree in &trees {
        roots.push(next_root);
        next_root += tree.nodes.len() as u32;
    }
    if let Some(top) = top {
        instances.extend(top.order.iter().map(|slot| {
            let placed = &scene.instances[*slot as usize];
            instance(&placed.to_world, roots[placed.group], 0)
        }));
        nodes.push(top.nodes);
    }
    for ((tree, root), group) in trees.into_iter().zip(roots).zip(&scene.groups) {
        let mut placed = tree.nodes;
        for node in &mut placed {
            node.child_base_idx += root;
            node.primitive_base_idx += group.triangles.start;
        }
        nodes.push(placed);
    }
    Built { order, paired, instances, instance_order, nodes, tlas: None, stack_size }
}

/// A box around a transformed box, a little outwards: traversal maps rays, not boxes, and rounds differently.
fn transform_bounds(to_world: &DAffine3, bounds: Bounds) -> Bounds {
    if bounds.min.cmpgt(bounds.max).any() {
        return Bounds { min: Vec3::ZERO, max: Vec3::ZERO };
    }
    let out = bounds.transformed(to_world);
    let reach = (out.max - out.min).max_element() + out.min.abs().max(out.max.abs()).max_element();
    let margin = Vec3::splat(reach * 8.0 * f32::EPSILON);
    Bounds { min: out.min - margin, max: out.max + margin }
}

/// The most primitives of one bottom-level structure.
pub(super) fn most_in_part(gpu: &Gpu) -> usize {
    usize::try_from(gpu.limits().max_blas_primitives.saturating_sub(1)).unwrap_or(usize::MAX).clamp(1, 1 << 28)
}

fn build_ray_query(gpu: &Gpu, scene: &Scene, watch: Watch) -> Result<Built> {
    let most = most_in_part(gpu);
    let mut parts = Vec::new();
    let mut parts_of_group = Vec::new();
    let mut done = 0;
    watch(Building::tree(0, scene.primitives.len()));
    for group in &scene.groups {
        let mut mine = Vec::new();
        for range in [group.triangles.clone(), group.spheres.clone()] {
            let primitives = &scene.primitives[range.start as usize..range.end as usize];
            for (index, chunk) in primitives.chunks(most).enumerate() {
                let kind = if chunk[0].surface & SPHERE_BIT != 0 { "spheres" } else { "triangles" };
                mine.push((parts.len(), range.start + (index * most) as u32));
                parts.push(Blas::build(gpu, &format!("{} of '{}'", kind, group.name), chunk)?);
                done += chunk.len();
                watch(Building::tree(done, scene.primitives.len()));
            }
        }
        parts_of_group.push(mine);
    }
    let mut placements = Vec::new();
    let mut instances = Vec::new();
    let mut instance_order = Vec::new();
    for (index, placed) in scene.instances.iter().enumerate() {
        for (part, first_primitive) in &parts_of_group[placed.group] {
            placements.push(Placement { part: *part, world: rows(&placed.to_world), index: instances.len() as u32 });
            instances.push(instance(&placed.to_world, 0, *first_primitive));
            instance_order.push(index as u32);
        }
    }
    let tlas = Tlas::build(gpu, parts, &placements)?;
    let order = (0..scene.primitives.len() as u32).collect();
    Ok(Built {
        order,
        paired: Vec::new(),
        instances,
        instance_order,
        nodes: Vec::new(),
        tlas: Some(tlas),
        stack_size: 1,
    })
}
