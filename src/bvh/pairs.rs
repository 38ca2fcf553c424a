//! Trees whose leaves hold pairs of triangles: two that share their longest edge are four vertices rather than six, and traversal tests
//! both at once.

use std::hash::{DefaultHasher, Hash, Hasher};

use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::node::CwBvhNode;
use rayon::slice::ParallelSliceMut;

use super::bounds::primitive_bounds;
use super::tree::Bvh;
use super::{MOST_IN_LEAF, build_tree};
use crate::layout::{Primitive, SPHERE_BIT};

/// One primitive, or a pair of triangles.
struct Unit<'a> {
    primitives: &'a [Primitive],
    first: u32,
    /// The first again where there is no second.
    second: u32,
}

impl Unit<'_> {
    fn is_pair(&self) -> bool {
        self.second != self.first
    }
}

impl Boundable for Unit<'_> {
    fn aabb(&self) -> Aabb {
        let bounds = |index: u32| primitive_bounds(&self.primitives[index as usize]);
        bounds(self.first).union(bounds(self.second)).aabb()
    }
}

impl Bvh {
    /// Builds a tree over primitives, with a pair of triangles or another primitive in each leaf if at least half of the primitives are in pairs,
    /// in chunks of `most` of those at most. The triangles of a pair follow each other in `order`, and `paired` tells which slot holds the later one. `done` is told from time to
    /// time, from any thread, how many primitives have found their place.
    pub fn over_primitives(primitives: &[Primitive], most: usize, done: &(dyn Fn(usize) + Sync)) -> Self {
        let units = units(primitives);
        // Runs of up to three single triangles make fewer nodes than leaves of one, so pairs must be many.
        if 4 * units.len() > 3 * primitives.len() {
            return build_tree(primitives, MOST_IN_LEAF, most, done);
        }
        let done = |count: usize| done(count * primitives.len() / units.len());
        let mut tree = build_tree(&units, 1, most, &done);
        hold_pairs(&mut tree, &units);
        tree
    }
}

/// The primitives as units: every triangle with the one that it shares its longest edge with, if that is the other's longest edge, too.
fn units(primitives: &[Primitive]) -> Vec<Unit<'_>> {
    let unit = |first, second| Unit { primitives, first, second };
    let mut edges: Vec<(u64, u32)> = (0..primitives.len() as u32)
        .filter(|index| primitives[*index as usize].surface & SPHERE_BIT == 0)
        .map(|index| (edge_key(&primitives[index as usize]), index))
        .collect();
    edges.par_sort_unstable();
    let mut partner: Vec<u32> = (0..primitives.len() as u32).collect();
    for run in edges.chunk_by(|(a, _), (b, _)| a == b) {
        for (at, (_, first)) in run.iter().enumerate() {
            let free = |index: u32, partner: &[u32]| partner[index as usize] == index;
            let fits = |second: u32, partner: &[u32]| {
                free(second, partner) && share_longest_edge(&primitives[*first as usize], &primitives[second as usize])
            };
            if !free(*first, &partner) {
                continue;
            }
            // Of many triangles at one edge only near ones are asked.
            if let Some((_, second)) = run[at + 1..].iter().take(8).find(|(_, second)| fits(*second, &partner)) {
                partner[*first as usize] = *second;
                partner[*second as usize] = *first;
            }
        }
    }
    (0..)
        .zip(&partner)
        .filter(|(index, partner)| index <= *partner)
        .map(|(index, partner)| unit(index, *partner))
        .collect()
}

/// A number for the longest edge, which lies opposite the first vertex: the same for both of its directions.
fn edge_key(triangle: &Primitive) -> u64 {
    let (a, b) = (triangle.v1.map(f32::to_bits), triangle.v2.map(f32::to_bits));
    let mut hasher = DefaultHasher::new();
    (a.min(b), a.max(b)).hash(&mut hasher);
    hasher.finish()
}

/// Whether the longest edge of both is the same, to the last bit, and they lie on its two sides.
fn share_longest_edge(a: &Primitive, b: &Primitive) -> bool {
    let bits = |v: [f32; 3]| v.map(f32::to_bits);
    bits(a.v1) == bits(b.v2) && bits(a.v2) == bits(b.v1)
}

/// Turns the slots of a tree over units into those of primitives.
fn hold_pairs(tree: &mut Bvh, units: &[Unit]) {
    let mut order = Vec::new();
    let mut starts = Vec::with_capacity(tree.order.len() + 1);
    for slot in &tree.order {
        let unit = &units[*slot as usize];
        starts.push(order.len() as u32);
        if unit.is_pair() {
            order.push(unit.second);
            tree.paired.push(false);
        }
        order.push(unit.first);
        tree.paired.push(unit.is_pair());
    }
    starts.push(order.len() as u32);
    for node in &mut tree.nodes {
        hold_primitives(node, &starts);
    }
    tree.order = order;
}

/// A node's leaves as runs of primitives: unit i is the run from `starts[i]` to `starts[i + 1]`.
fn hold_primitives(node: &mut CwBvhNode, starts: &[u32]) {
    let base = starts[node.primitive_base_idx as usize];
    for child in 0..8 {
        if node.is_child_empty(child) || !node.is_leaf(child) {
            continue;
        }
        let unit = node.child_primitives(child).0 as usize;
        let (first, count) = (starts[unit] - base, starts[unit + 1] - starts[unit]);
        node.child_meta[child] = first as u8 | if count == 1 { 0b0010_0000 } else { 0b0110_0000 };
    }
    node.primitive_base_idx = base;
}
