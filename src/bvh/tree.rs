//! The tree, and building one in one piece.

use obvhs::Boundable;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::partition;

/// A tree over boxes.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The nodes, the root first; child and primitive indices count from the beginning of this tree.
    pub nodes: Vec<CwBvhNode>,
    /// For each leaf slot, the index of the box that it holds: leaves refer to runs of slots.
    pub order: Vec<u32>,
    /// For each slot, whether it and the one before hold a pair of triangles; empty where there are no pairs.
    pub paired: Vec<bool>,
    /// Nodes on the longest way from the root to a leaf.
    pub depth: u32,
}

/// Levels of a binary tree from which on it counts as degenerate. Trees of millions of boxes have some fifty.
const DEEP: u32 = 128;

/// The tree over `boxes` in one piece, with so many of them in a leaf at most.
pub(super) fn wide_tree<T: Boundable + Sync>(boxes: &[T], most_in_leaf: u32) -> CwBvh {
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

/// Nodes on the longest way down. Children come after their parents, so one pass from the back is enough.
pub(super) fn depth_below(nodes: &[CwBvhNode]) -> u32 {
    let mut depth = vec![1u32; nodes.len()];
    for index in (0..nodes.len()).rev() {
        for child in (0..8).filter(|child| !nodes[index].is_child_empty(*child) && !nodes[index].is_leaf(*child)) {
            depth[index] = depth[index].max(1 + depth[nodes[index].child_node_index(child) as usize]);
        }
    }
    depth[0]
}
