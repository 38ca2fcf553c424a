//! Trees over so many boxes that building one in one piece would take several times their memory: chunks that are close
//! together in space get a tree each, a few at a time, and a small tree over the chunks joins them.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::node::CwBvhNode;

use super::bounds::Bounds;
use super::partition::{Chunk, partition};
use super::tree::{Bvh, depth_below, wide_tree};

/// One of the boxes of a chunk: a list of references takes a third of the memory of a list of boxes.
struct Member<'a, T>(&'a T);

impl<T: Boundable> Boundable for Member<'_, T> {
    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
}

/// The tree over `boxes` out of chunks of `most` at most. `done` is told, from any thread, how many boxes have found
/// their place.
pub(super) fn build<T: Boundable + Sync>(
    boxes: &[T],
    most_in_leaf: u32,
    most: usize,
    done: &(dyn Fn(usize) + Sync),
) -> Bvh {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let chunks = partition(boxes, &mut order, most);
    let bounds: Vec<Bounds> = chunks.iter().map(|chunk| chunk.bounds).collect();
    let (mut nodes, roots) = top(&bounds);
    let mut places: Vec<(Chunk, &mut [u32])> = Vec::with_capacity(chunks.len());
    let mut rest = order.as_mut_slice();
    for chunk in &chunks {
        let (mine, others) = rest.split_at_mut(chunk.count);
        places.push((*chunk, mine));
        rest = others;
    }
    // Trees of a quarter of the boxes at once take as much memory as all boxes do.
    let lanes = (boxes.len() / (4 * most.max(1))).max(2).min(rayon::current_num_threads());
    let joined = Mutex::new(Joined { nodes: &mut nodes, roots: &roots, next: 0, early: Vec::new() });
    let places = Mutex::new(places.into_iter().enumerate());
    let built = AtomicUsize::new(0);
    let take = || places.lock().unwrap_or_else(PoisonError::into_inner).next();
    rayon::scope(|scope| {
        for _ in 0..lanes {
            scope.spawn(|_| {
                while let Some((index, (chunk, run))) = take() {
                    let members: Vec<_> = run.iter().map(|index| Member(&boxes[*index as usize])).collect();
                    let tree = wide_tree(&members, most_in_leaf);
                    let names = run.to_vec();
                    run.iter_mut().zip(&tree.primitive_indices).for_each(|(out, name)| *out = names[*name as usize]);
                    joined.lock().unwrap_or_else(PoisonError::into_inner).add(index, chunk.first as u32, tree.nodes);
                    done(built.fetch_add(chunk.count, Ordering::Relaxed) + chunk.count);
                }
            });
        }
    });
    nodes.shrink_to_fit();
    let depth = depth_below(&nodes);
    Bvh { nodes, order, paired: Vec::new(), depth }
}

/// The tree over the chunks' boxes, with a slot for the root of each chunk's tree, and where those slots are. A node's inner
/// children follow each other, so the roots take the places of the leaves and all nodes move up.
fn top(bounds: &[Bounds]) -> (Vec<CwBvhNode>, Vec<usize>) {
    let tree = wide_tree(bounds, 1);
    let mut nodes = vec![CwBvhNode::default()];
    let mut roots = vec![0; bounds.len()];
    let mut pending = vec![(0, 0)];
    while let Some((from, to)) = pending.pop() {
        let old = &tree.nodes[from];
        let mut node = *old;
        node.child_base_idx = nodes.len() as u32;
        node.primitive_base_idx = 0;
        for child in (0..8).filter(|child| !old.is_child_empty(*child)) {
            if old.is_leaf(child) {
                let (slot, _) = old.child_primitives(child);
                roots[tree.primitive_indices[slot as usize] as usize] = nodes.len();
                node.imask |= 1 << child;
                node.child_meta[child] = 0b0010_0000 | (24 + child as u8);
            } else {
                pending.push((old.child_node_index(child) as usize, nodes.len()));
            }
            nodes.push(CwBvhNode::default());
        }
        nodes[to] = node;
    }
    (nodes, roots)
}

/// The chunks' trees in one array of nodes. They are taken in by their number, whichever is built first: the same boxes give
/// the same array.
struct Joined<'a> {
    nodes: &'a mut Vec<CwBvhNode>,
    roots: &'a [usize],
    next: usize,
    /// Trees that wait for one before them.
    early: Vec<(usize, u32, Vec<CwBvhNode>)>,
}

impl Joined<'_> {
    fn add(&mut self, index: usize, first: u32, nodes: Vec<CwBvhNode>) {
        self.early.push((index, first, nodes));
        while let Some(ready) = self.early.iter().position(|(index, ..)| *index == self.next) {
            let (index, first, nodes) = self.early.swap_remove(ready);
            self.append(index, first, &nodes);
            self.next += 1;
        }
    }

    /// The root goes to its slot in the tree above, all others to the end.
    fn append(&mut self, index: usize, first: u32, nodes: &[CwBvhNode]) {
        let shift = self.nodes.len() as u32;
        let moved = |node: &CwBvhNode| CwBvhNode {
            child_base_idx: (node.child_base_idx + shift).saturating_sub(1),
            primitive_base_idx: node.primitive_base_idx + first,
            ..*node
        };
        let Some((root, rest)) = nodes.split_first() else { return };
        self.nodes.extend(rest.iter().map(moved));
        self.nodes[self.roots[index]] = moved(root);
    }
}
