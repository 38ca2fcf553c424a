//! The patches of a scene as arrays, and what is asked of them.

use std::collections::HashSet;

use super::faces::Node;
use crate::layout::NONE;
use crate::scene::Scene;
use crate::techniques::table::radiosity::structs::{Patch, PatchFace};

/// Irradiance below this share of the mean counts as that share, where it is to be even.
const DARK: f64 = 0.2;
/// Counts of a patch besides those of fronts by surface: rays that met nothing, what has no patch, and backs.
pub const FIRST_COLUMN: u32 = 3;
pub(super) const BACKS: u32 = 2;
/// Which patches are quartered.
#[derive(Clone, Debug)]
pub enum Quartered {
    /// All of them, down to cells.
    All,
    /// Those of a face, on its back or not.
    These(HashSet<(u32, bool, Node)>),
}

impl Quartered {
    pub(super) fn has(&self, face: u32, back: bool, node: Node) -> bool {
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
    pub(super) count_columns: u32,
}

impl PatchMesh {
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
}
