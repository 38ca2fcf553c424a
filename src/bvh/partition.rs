//! Cutting many boxes into chunks that are close together in space, so that each can have a tree of its own.

use glam::Vec3;
use obvhs::Boundable;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::Bounds;

/// Bins along an axis among whose borders the best cut is looked for (Wald 2007).
const BINS: usize = 32;
/// Cuts below the root after which boxes are halved by number, so that no arrangement of them costs more than a sort does.
const MOST_CUTS: u32 = 24;
/// Boxes that one task looks at.
const TASK: usize = 1 << 14;

/// A run of the order, and the box around what it holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    pub first: usize,
    pub count: usize,
    pub bounds: Bounds,
}

/// Reorders `order`, which refers to `boxes`, so that it falls into runs of `most` at most, each compact in space: where
/// the surface-area heuristic says, over the boxes' centres. The runs follow each other, and none is empty.
pub(super) fn partition<T: Boundable + Sync>(boxes: &[T], order: &mut [u32], most: usize) -> Vec<Chunk> {
    let mut chunks = Vec::new();
    let mut pending = vec![(0, order.len(), 0)];
    while let Some((first, count, depth)) = pending.pop() {
        let run = &mut order[first..first + count];
        let extent = Extent::of(boxes, run);
        if count <= most.max(1) {
            chunks.push(Chunk { first, count, bounds: extent.boxes });
            continue;
        }
        let left = divide(boxes, run, extent, depth);
        pending.extend([(first + left, count - left, depth + 1), (first, left, depth + 1)]);
    }
    chunks
}

/// The binary tree of all those cuts, down to single boxes. It is never deep: at most [`MOST_CUTS`] and as many more as halving
/// takes.
pub(super) fn tree_of_cuts<T: Boundable + Sync>(boxes: &[T]) -> Bvh2 {
    let mut tree = Bvh2::zeroed(boxes.len());
    tree.primitive_indices = (0..boxes.len() as u32).collect();
    tree.nodes = vec![Bvh2Node::default()];
    let mut pending = vec![(0, 0, boxes.len(), 0)];
    while let Some((node, first, count, depth)) = pending.pop() {
        let run = &mut tree.primitive_indices[first..first + count];
        let extent = Extent::of(boxes, run);
        if count == 1 {
            tree.nodes[node] = Bvh2Node::new(extent.boxes.aabb(), 1, first as u32);
            continue;
        }
        let left = divide(boxes, run, extent, depth);
        let children = tree.nodes.len();
        tree.nodes[node] = Bvh2Node::new(extent.boxes.aabb(), 0, children as u32);
        tree.nodes.extend([Bvh2Node::default(); 2]);
        pending.extend([(children + 1, first + left, count - left, depth + 1), (children, first, left, depth + 1)]);
    }
    tree
}

/// Divides a run of two or more below so many cuts; how many come to lie on the left, at least one and not all.
fn divide<T: Boundable + Sync>(boxes: &[T], run: &mut [u32], extent: Extent, depth: u32) -> usize {
    let cut = if depth < MOST_CUTS { best_cut(boxes, run, extent.centres) } else { None };
    match cut {
        Some(cut) => separate(run, |index| cut.is_left(bounds_of(&boxes[index as usize]))),
        None => halve(boxes, run, extent.centres),
    }
}

fn bounds_of(item: &impl Boundable) -> Bounds {
    let aabb = item.aabb();
    Bounds { min: aabb.min.into(), max: aabb.max.into() }
}

/// Twice the centre of a box.
fn centre(bounds: Bounds) -> Vec3 {
    bounds.min + bounds.max
}

/// The box around boxes, and the one around their centres.
#[derive(Clone, Copy)]
struct Extent {
    boxes: Bounds,
    centres: Bounds,
}

impl Extent {
    fn of<T: Boundable + Sync>(boxes: &[T], run: &[u32]) -> Self {
        let empty = || Self { boxes: Bounds::EMPTY, centres: Bounds::EMPTY };
        run.par_iter()
            .with_min_len(TASK)
            .fold(empty, |all, index| {
                let bounds = bounds_of(&boxes[*index as usize]);
                Self { boxes: all.boxes.union(bounds), centres: all.centres.with_point(centre(bounds)) }
            })
            .reduce(empty, |a, b| Self { boxes: a.boxes.union(b.boxes), centres: a.centres.union(b.centres) })
    }
}

/// What lies to the left of a border between bins along one axis.
#[derive(Clone, Copy)]
struct Cut {
    axis: usize,
    low: f32,
    scale: f32,
    border: usize,
}

impl Cut {
    fn bin(&self, bounds: Bounds) -> usize {
        (((centre(bounds)[self.axis] - self.low) * self.scale) as usize).min(BINS - 1)
    }

    fn is_left(&self, bounds: Bounds) -> bool {
        self.bin(bounds) < self.border
    }
}

type Bins = [(usize, Bounds); BINS];

/// The cut of least cost, boxes' surface times their number, over all axes; nothing where all centres are in one bin.
fn best_cut<T: Boundable + Sync>(boxes: &[T], run: &[u32], centres: Bounds) -> Option<Cut> {
    let extent = centres.max - centres.min;
    let cuts: Vec<Cut> = (0..3)
        .filter(|axis| extent[*axis] > 0.0 && (BINS as f32 / extent[*axis]).is_finite())
        .map(|axis| Cut { axis, low: centres.min[axis], scale: BINS as f32 / extent[axis], border: 0 })
        .collect();
    let empty = || vec![[(0, Bounds::EMPTY); BINS]; cuts.len()];
    let filled: Vec<Bins> = run
        .par_iter()
        .with_min_len(TASK)
        .fold(empty, |mut all, index| {
            let bounds = bounds_of(&boxes[*index as usize]);
            for (cut, bins) in cuts.iter().zip(&mut all) {
                let (count, held) = &mut bins[cut.bin(bounds)];
                *count += 1;
                *held = held.union(bounds);
            }
            all
        })
        .reduce(empty, |mut all, other| {
            for (bin, (count, bounds)) in all.iter_mut().flatten().zip(other.into_iter().flatten()) {
                *bin = (bin.0 + count, bin.1.union(bounds));
            }
            all
        });
    let mut best: Option<(f64, Cut)> = None;
    for (cut, bins) in cuts.iter().zip(&filled) {
        for (border, cost) in costs(bins) {
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, Cut { border, ..*cut }));
            }
        }
    }
    best.map(|(_, cut)| cut)
}

/// The cost of each border that has boxes on both of its sides.
fn costs(bins: &Bins) -> Vec<(usize, f64)> {
    let join = |a: (usize, Bounds), b: &(usize, Bounds)| (a.0 + b.0, a.1.union(b.1));
    let cost = |(count, bounds): (usize, Bounds)| {
        let d = (bounds.max - bounds.min).as_dvec3();
        count as f64 * (d.x * d.y + d.y * d.z + d.z * d.x)
    };
    let mut right = [(0, Bounds::EMPTY); BINS];
    let mut sum = (0, Bounds::EMPTY);
    for (bin, out) in bins.iter().zip(&mut right).rev() {
        sum = join(sum, bin);
        *out = sum;
    }
    let mut left = (0, Bounds::EMPTY);
    let mut found = Vec::new();
    for border in 1..BINS {
        left = join(left, &bins[border - 1]);
        if left.0 > 0 && right[border].0 > 0 {
            found.push((border, cost(left) + cost(right[border])));
        }
    }
    found
}

/// Brings what is left to the front; how many those are.
fn separate(run: &mut [u32], is_left: impl Fn(u32) -> bool) -> usize {
    let mut left = 0;
    for at in 0..run.len() {
        if is_left(run[at]) {
            run.swap(at, left);
            left += 1;
        }
    }
    left
}

/// Halves by number, along the axis on which the centres are spread furthest.
fn halve<T: Boundable>(boxes: &[T], run: &mut [u32], centres: Bounds) -> usize {
    let extent = centres.max - centres.min;
    let axis = (1..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    let middle = run.len() / 2;
    let key = |index: &u32| centre(bounds_of(&boxes[*index as usize]))[axis];
    run.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    middle
}
