//! The compressed wide BVH that backend `bvh` traverses (Ylitie, Karras and Laine 2017), built by obvhs, and a check
//! that it is right.

mod bounds;
mod chunked;
mod pairs;
mod partition;
mod tree;

use glam::DVec3;
use obvhs::Boundable;
use obvhs::cwbvh::node::CwBvhNode;

use crate::layout::NODE_BYTES;

pub use bounds::{Bounds, primitive_bounds};
pub use tree::Bvh;
use tree::{depth_below, wide_tree};

const _: () = assert!(size_of::<CwBvhNode>() == NODE_BYTES as usize);

/// By how much of a grid cell traversal widens each child's box; `CELL_MARGIN` in `shaders/trace/bvh.glsl`. It makes up
/// for the rounding of the quantisation, which [`Bvh::validate`] bounds.
pub const CELL_MARGIN: f64 = 1.0 / 256.0;

/// The most boxes that get a tree in one piece. Building takes some 300 bytes for each of them; more are cut into chunks.
pub const CHUNK: usize = 1 << 19;

/// The most boxes in a leaf, as traversal's masks have it.
const MOST_IN_LEAF: u32 = 3;

fn build_tree<T: Boundable + Sync>(boxes: &[T], most_in_leaf: u32, most: usize, done: &(dyn Fn(usize) + Sync)) -> Bvh {
    if boxes.is_empty() {
        return Bvh { nodes: vec![CwBvhNode::default()], order: Vec::new(), paired: Vec::new(), depth: 1 };
    }
    if boxes.len() > most.max(1) {
        return chunked::build(boxes, most_in_leaf, most, done);
    }
    let wide = wide_tree(boxes, most_in_leaf);
    done(boxes.len());
    let depth = depth_below(&wide.nodes);
    Bvh { nodes: wide.nodes, order: wide.primitive_indices, paired: Vec::new(), depth }
}

impl Bvh {
    /// Builds a tree over boxes, or over primitives. No box at all gives a root without children.
    pub fn build<T: Boundable + Sync>(boxes: &[T]) -> Self {
        Self::build_in_chunks(boxes, CHUNK, &|_| {})
    }

    /// Builds a tree over boxes, or over primitives, in chunks of `most` boxes at most, where there are more. `done` is
    /// told from time to time, from any thread, how many boxes have found their place.
    pub fn build_in_chunks<T: Boundable + Sync>(boxes: &[T], most: usize, done: &(dyn Fn(usize) + Sync)) -> Self {
        build_tree(boxes, MOST_IN_LEAF, most, done)
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
