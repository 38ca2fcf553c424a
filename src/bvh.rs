//! The compressed wide BVH that backend `bvh` traverses (Ylitie, Karras and Laine 2017), built by obvhs, and a check
//! that it is right.

mod chunked;
mod partition;

use glam::{DAffine3, DVec3, Vec3};
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::layout::{NODE_BYTES, Primitive, SPHERE_BIT};

const _: () = assert!(size_of::<CwBvhNode>() == NODE_BYTES as usize);

/// By how much of a grid cell traversal widens each child's box; `CELL_MARGIN` in `shaders/trace/bvh.glsl`. It makes up
/// for the rounding of the quantisation, which [`Bvh::validate`] bounds.
pub const CELL_MARGIN: f64 = 1.0 / 256.0;

/// The most boxes that get a tree in one piece. Building takes some 300 bytes for each of them; more are cut into chunks.
pub const CHUNK: usize = 1 << 19;

/// A tree over boxes.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The nodes, the root first; child and primitive indices count from the beginning of this tree.
    pub nodes: Vec<CwBvhNode>,
    /// For each leaf slot, the index of the box that it holds: leaves refer to runs of slots.
    pub order: Vec<u32>,
    /// Nodes on the longest way from the root to a leaf.
    pub depth: u32,
}

/// An axis-aligned box of single-precision corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// A box around what the map makes of it; nothing stays nothing.
    #[must_use]
    pub fn transformed(self, map: &DAffine3) -> Self {
        if self.min.x > self.max.x {
            return Self::EMPTY;
        }
        let corner = |index: usize| {
            let pick = |axis: usize| if index >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            map.transform_point3(Vec3::new(pick(0), pick(1), pick(2)).as_dvec3()).as_vec3()
        };
        (0..8).map(corner).fold(Self::EMPTY, Self::with_point)
    }

    /// The smallest box around it and a point.
    #[must_use]
    pub fn with_point(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }
}

/// The box of a primitive. A sphere's is rounded outwards.
pub fn primitive_bounds(primitive: &Primitive) -> Bounds {
    let v0 = Vec3::from(primitive.v0);
    if primitive.surface & SPHERE_BIT != 0 {
        let radius = primitive.v1[0].abs();
        let reach = Vec3::splat(radius) + (v0.abs() + radius) * 4.0 * f32::EPSILON;
        return Bounds { min: v0 - reach, max: v0 + reach };
    }
    let (v1, v2) = (Vec3::from(primitive.v1), Vec3::from(primitive.v2));
    Bounds { min: v0.min(v1).min(v2), max: v0.max(v1).max(v2) }
}

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        Aabb::new(self.min.into(), self.max.into())
    }
}

/// Trees are built over the primitives as they are: a list of their boxes would take most of the memory that they do.
impl Boundable for Primitive {
    fn aabb(&self) -> Aabb {
        primitive_bounds(self).aabb()
    }
}

impl Bvh {
    /// Builds a tree over boxes, or over primitives. No box at all gives a root without children.
    pub fn build<T: Boundable + Sync>(boxes: &[T]) -> Self {
        Self::build_in_chunks(boxes, CHUNK, &|_| {})
    }

    /// The same in chunks of `most` boxes at most, where there are more. `done` is told from time to time, from any thread,
    /// how many boxes have found their place.
    pub fn build_in_chunks<T: Boundable + Sync>(boxes: &[T], most: usize, done: &(dyn Fn(usize) + Sync)) -> Self {
        if boxes.is_empty() {
            return Self { nodes: vec![CwBvhNode::default()], order: Vec::new(), depth: 1 };
        }
        if boxes.len() > most.max(1) {
            return chunked::build(boxes, most, done);
        }
        let wide = wide_tree(boxes, 3);
        done(boxes.len());
        let depth = depth_below(&wide.nodes);
        Self { nodes: wide.nodes, order: wide.primitive_indices, depth }
    }

    /// Checks that every box is in exactly one leaf, and that each child's decoded box, widened by [`CELL_MARGIN`] as
    /// traversal widens it, contains all that lies below the child. Says what is wrong otherwise.
    pub fn validate(&self, boxes: &[Bounds]) -> Result<(), String> {
        let mut seen = vec![false; boxes.len()];
        let mut visited = vec![false; self.nodes.len()];
        let contents = self.validate_node(0, boxes, &mut seen, &mut visited)?;
        debug_assert!(boxes.is_empty() || contents.min.is_finite());
        match (seen.iter().position(|seen| !seen), visited.iter().position(|visited| !visited)) {
            (Some(index), _) => Err(format!("box {index} is in no leaf")),
            (_, Some(index)) => Err(format!("node {index} is not reachable")),
            _ => Ok(()),
        }
    }

    fn validate_node(
        &self,
        index: usize,
        boxes: &[Bounds],
        seen: &mut [bool],
        visited: &mut [bool],
    ) -> Result<Bounds, String> {
        let node = self.nodes.get(index).ok_or_else(|| format!("node {index} does not exist"))?;
        if std::mem::replace(&mut visited[index], true) {
            return Err(format!("node {index} is reached twice"));
        }
        let mut all = Bounds::EMPTY;
        for child in (0..8).filter(|child| !node.is_child_empty(*child)) {
            let mut contents = Bounds::EMPTY;
            if node.is_leaf(child) {
                let (first, count) = node.child_primitives(child);
                for slot in first..first + count {
                    let index =
                        *self.order.get(slot as usize).ok_or_else(|| format!("slot {slot} does not exist"))? as usize;
                    if std::mem::replace(&mut seen[index], true) {
                        return Err(format!("box {index} is in two leaves"));
                    }
                    contents = contents.union(boxes[index]);
                }
            } else {
                contents = self.validate_node(node.child_node_index(child) as usize, boxes, seen, visited)?;
            }
            let (min, max) = decoded_child(node, child);
            if !(contents.min.as_dvec3().cmpge(min).all() && contents.max.as_dvec3().cmple(max).all()) {
                return Err(format!(
                    "child {child} of node {index} spans {min} to {max}, its contents {} to {}",
                    contents.min, contents.max
                ));
            }
            all = all.union(contents);
        }
        Ok(all)
    }
}

/// Levels of a binary tree from which on it counts as degenerate. Trees of millions of boxes have some fifty.
const DEEP: u32 = 128;

/// The tree over `boxes` in one piece, with so many of them in a leaf at most.
fn wide_tree<T: Boundable + Sync>(boxes: &[T], most_in_leaf: u32) -> CwBvh {
    // Reinsertion is what the quality of the tree comes from; its cost grows faster than the scene.
    let (search, reinsertion) =
        if boxes.len() < 200_000 { (PlocSearchDistance::High, 0.5) } else { (PlocSearchDistance::Medium, 0.15) };
    let names = (0..boxes.len() as u32).collect();
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(search, boxes, names, SortPrecision::U64, 2);
    if !is_deep(&binary) {
        ReinsertionOptimizer::default().run(&mut binary, reinsertion, None);
    }
    // Boxes that are all the same are clustered into a list, whose levels no stack would hold.
    if is_deep(&binary) {
        binary = partition::tree_of_cuts(boxes);
    }
    bvh2_to_cwbvh(&binary, most_in_leaf, true, false)
}

/// Whether a binary tree has more than [`DEEP`] levels.
fn is_deep(tree: &Bvh2) -> bool {
    let mut pending = vec![(0, 1)];
    while let Some((index, level)) = pending.pop() {
        let node = &tree.nodes[index as usize];
        if level > DEEP {
            return true;
        }
        if !node.is_leaf() {
            pending.extend([(node.first_index, level + 1), (node.first_index + 1, level + 1)]);
        }
    }
    false
}

/// A child's box as traversal sees it, in exact arithmetic.
fn decoded_child(node: &CwBvhNode, child: usize) -> (DVec3, DVec3) {
    let corner = node.p.as_dvec3();
    let cell = DVec3::from_array(node.e.map(|exponent| f64::from(f32::from_bits(u32::from(exponent) << 23))));
    let low =
        DVec3::new(node.child_min_x[child].into(), node.child_min_y[child].into(), node.child_min_z[child].into());
    let high =
        DVec3::new(node.child_max_x[child].into(), node.child_max_y[child].into(), node.child_max_z[child].into());
    (corner + (low - CELL_MARGIN) * cell, corner + (high + CELL_MARGIN) * cell)
}

/// Nodes on the longest way down. Children come after their parents, so one pass from the back is enough.
fn depth_below(nodes: &[CwBvhNode]) -> u32 {
    let mut depth = vec![1u32; nodes.len()];
    for index in (0..nodes.len()).rev() {
        for child in (0..8).filter(|child| !nodes[index].is_child_empty(*child) && !nodes[index].is_leaf(*child)) {
            depth[index] = depth[index].max(1 + depth[nodes[index].child_node_index(child) as usize]);
        }
    }
    depth[0]
}
