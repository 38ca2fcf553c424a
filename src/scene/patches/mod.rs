//! The surfaces of a scene divided into patches, for radiosity.
//!
//! A face is a triangle, two triangles that are a parallelogram, or a sphere. It is divided into cells of equal area, and each side
//! that has a material gets patches of them. Patches meet in vertices, whose values are weighted sums of those of the patches around.

mod faces;
mod hanging;
mod vertices;

use std::collections::HashSet;

use glam::{DVec2, DVec3};

use super::Scene;
use crate::error::{Error, Result};
use crate::layout::{NONE, Patch, PatchFace, SURFACE_MASK};
pub use faces::Node;
use faces::{Face, Shape};

/// The most patches that a scene may have.
const MOST: u64 = 1 << 22;
/// Counts of a patch besides those of fronts by surface: rays that met nothing, what has no patch, and backs.
pub const FIRST_COLUMN: u32 = 3;
const BACKS: u32 = 2;
/// Irradiance below this share of the mean counts as that share, where it is to be even.
const DARK: f64 = 0.2;
/// The most surfaces whose form factors are told apart.
const SURFACES: usize = 16;

/// Which patches are quartered.
#[derive(Clone, Debug)]
pub enum Quartered {
    /// All of them, down to cells.
    All,
    /// Those of a face, on its back or not.
    These(HashSet<(u32, bool, Node)>),
}

impl Quartered {
    fn has(&self, face: u32, back: bool, node: Node) -> bool {
        match self {
            Self::All => true,
            Self::These(nodes) => nodes.contains(&(face, back, node)),
        }
    }
}

/// Patches of a scene, as the device has them but for the order of primitives.
#[derive(Clone, Debug, Default)]
pub struct PatchMesh {
    /// The faces; primitives and instances are those of the scene.
    pub faces: Vec<PatchFace>,
    /// The patches.
    pub patches: Vec<Patch>,
    /// The patch of each cell of a side.
    pub cells: Vec<u32>,
    /// The vertices at the corners of each patch; [`NONE`] after the third of a triangle.
    pub corners: Vec<[u32; 4]>,
    /// The first term of each vertex, and where the last one ends.
    pub term_first: Vec<u32>,
    /// Patches with the bits of their weights.
    pub terms: Vec<[u32; 2]>,
    /// For each instance, where its primitives begin in `face_of`.
    pub starts: Vec<u32>,
    /// The face of each placed primitive, or [`NONE`].
    pub face_of: Vec<u32>,
    /// What each patch is of its face.
    pub nodes: Vec<Node>,
    /// Whether the columns tell surfaces apart.
    pub has_surfaces: bool,
    count_columns: u32,
}

impl PatchMesh {
    /// Patches of a size that puts so many along the longest edge; or larger ones where they may be quartered `levels` times to come
    /// to that size, but are not.
    pub fn new(scene: &Scene, along_longest: f64, levels: u32, quartered: &Quartered) -> Result<Self> {
        let mut shapes = faces::faces(scene);
        let longest = shapes.iter().map(Face::longest).fold(0.0, f64::max);
        if longest > 0.0 {
            shapes.iter_mut().for_each(|face| face.divide(longest / along_longest, levels));
        }
        let count: u64 = shapes.iter().map(Face::patches).sum();
        if count > MOST {
            return Err(Error::Usage(format!(
                "radiosity:patches={along_longest}: {} would have {count} patches, and {MOST} is the most",
                scene.source.display()
            )));
        }
        let has_surfaces = scene.surfaces.len() <= SURFACES;
        let count_columns = FIRST_COLUMN + if has_surfaces { scene.surfaces.len() as u32 } else { 1 };
        let mut mesh = Self { has_surfaces, count_columns, ..Self::default() };
        mesh.place(scene, &shapes);
        for (index, face) in shapes.iter().enumerate() {
            mesh.add_face(scene, face, index as u32, quartered);
        }
        vertices::join(&mut mesh, &shapes);
        Ok(mesh)
    }

    /// Counts of a patch: what its rays met.
    pub fn columns(&self) -> u32 {
        self.count_columns
    }

    /// What an instance adds to a primitive's index to find its face, for instances as they are uploaded.
    pub fn bases(&self, scene: &Scene, instance_order: &[u32]) -> Vec<u32> {
        let base = |index: &u32| {
            let group = &scene.groups[scene.instances[*index as usize].group];
            self.starts[*index as usize].wrapping_sub(group.triangles.start)
        };
        instance_order.iter().map(base).collect()
    }

    /// Puts primitives and instances in the order in which they were uploaded: index by index, those of the scene.
    pub fn reorder(&mut self, scene: &Scene, order: &[u32], instance_order: &[u32]) {
        let mut place = vec![0u32; order.len()];
        order.iter().enumerate().for_each(|(uploaded, primitive)| place[*primitive as usize] = uploaded as u32);
        let mut instance_place = vec![0u32; scene.instances.len()];
        instance_order.iter().enumerate().rev().for_each(|(uploaded, instance)| {
            instance_place[*instance as usize] = uploaded as u32; // of several parts the first: all have the same map
        });
        for face in &mut self.faces {
            face.primitive = place[face.primitive as usize];
            if face.second != NONE {
                face.second = place[face.second as usize];
            }
            face.instance = instance_place[face.instance as usize];
        }
        let old = std::mem::take(&mut self.face_of);
        for (instance, start) in scene.instances.iter().zip(&self.starts) {
            let range = scene.groups[instance.group].primitives();
            let face = |primitive: &u32| old[*start as usize + *primitive as usize - range.start];
            self.face_of.extend(order[range.clone()].iter().map(face));
        }
    }

    /// Patches to be quartered besides those that were: where irradiance, one value for each patch, differs around a vertex by more than
    /// a share of it; nothing where there are none.
    pub fn uneven(&self, light: &[f32], share: f64, quartered: &Quartered) -> Option<Quartered> {
        let area: f64 = self.patches.iter().map(|patch| f64::from(patch.area)).sum();
        let flux: f64 = self.patches.iter().zip(light).map(|(patch, light)| f64::from(patch.area * light)).sum();
        let dark = DARK * flux / area.max(f64::MIN_POSITIVE);
        let mut ranges = vec![(f64::MAX, 0.0f64); self.vertices()];
        let corners = |patch: usize| self.corners[patch].into_iter().filter(|corner| *corner != NONE);
        for (patch, light) in light.iter().enumerate() {
            for corner in corners(patch) {
                let (least, greatest) = &mut ranges[corner as usize];
                (*least, *greatest) = (least.min(f64::from(*light)), greatest.max(f64::from(*light)));
            }
        }
        let is_uneven = |corner: u32| {
            let (least, greatest) = ranges[corner as usize];
            greatest - least > share * (0.5 * (least + greatest)).max(dark)
        };
        let uneven =
            (0..self.patches.len()).filter(|patch| self.nodes[*patch].level > 0 && corners(*patch).any(is_uneven));
        let found = uneven.map(|patch| (self.patches[patch].face, self.patches[patch].back != 0, self.nodes[patch]));
        let mut all = match quartered {
            Quartered::All => return None,
            Quartered::These(nodes) => nodes.clone(),
        };
        let before = all.len();
        all.extend(found);
        (all.len() > before).then_some(Quartered::These(all))
    }

    /// Vertices.
    pub fn vertices(&self) -> usize {
        self.term_first.len().saturating_sub(1)
    }

    /// Which face each placed primitive belongs to.
    fn place(&mut self, scene: &Scene, shapes: &[Face]) {
        for instance in &scene.instances {
            self.starts.push(self.face_of.len() as u32);
            let count = scene.groups[instance.group].primitives().len();
            self.face_of.resize(self.face_of.len() + count, NONE);
        }
        for (index, face) in shapes.iter().enumerate() {
            let group = scene.instances[face.instance].group;
            let first = self.starts[face.instance] as usize;
            for primitive in [Some(face.primitive), face.second].into_iter().flatten() {
                let within = primitive - scene.groups[group].primitives().start;
                self.face_of[first + within] = index as u32;
            }
        }
    }

    fn add_face(&mut self, scene: &Scene, face: &Face, index: u32, quartered: &Quartered) {
        let surface = scene.primitives[face.primitive].surface & SURFACE_MASK;
        let mut sides = [NONE; 2];
        for (back, first) in sides.iter_mut().enumerate().filter(|(back, _)| face.sides[*back]) {
            *first = self.cells.len() as u32;
            self.cells.resize(self.cells.len() + (face.across * face.down) as usize, NONE);
            let mut pending: Vec<Node> = face.roots().collect();
            pending.reverse();
            while let Some(node) = pending.pop() {
                if node.level > 0 && quartered.has(index, back == 1, node) {
                    pending.extend(face.quarters(node).into_iter().rev());
                    continue;
                }
                for cell in face.cells(node) {
                    self.cells[(*first + cell) as usize] = self.patches.len() as u32;
                }
                let (corner, extent) = face.extent(node);
                self.nodes.push(node);
                self.patches.push(Patch {
                    face: index,
                    back: back as u32,
                    corner: corner.as_vec2().into(),
                    extent: extent.as_vec2().into(),
                    area: face.area(corner, extent) as f32,
                    column: match (back, self.has_surfaces) {
                        (0, true) => FIRST_COLUMN + surface,
                        (0, false) => FIRST_COLUMN,
                        _ => BACKS,
                    },
                });
            }
        }
        self.faces.push(PatchFace {
            primitive: face.primitive as u32,
            second: face.second.map_or(NONE, |second| second as u32),
            turn: face.turn,
            instance: face.instance as u32,
            across: face.across,
            down: face.down,
            front: sides[0],
            back: sides[1],
        });
    }
}

/// The corners of a patch in the coordinates of its face; of a triangle three.
fn corners(shape: &Shape, corner: DVec2, extent: DVec2) -> impl Iterator<Item = DVec2> {
    let all = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let count = if matches!(shape, Shape::Triangle { .. }) { 3 } else { 4 };
    all.into_iter().take(count).map(move |(u, v)| corner + extent * DVec2::new(u, v))
}

/// The middle of a patch likewise.
fn middle(shape: &Shape, corner: DVec2, extent: DVec2) -> DVec2 {
    corner + extent * if matches!(shape, Shape::Triangle { .. }) { 1.0 / 3.0 } else { 0.5 }
}

/// A point of a surface and its unit normal.
#[derive(Clone, Copy, Debug)]
struct Point {
    position: DVec3,
    normal: DVec3,
}
