//! Trees, and primitives that are constants of the kernel. Both backends against a brute force, and closed meshes, are rows of `lumbre
//! verify`.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::{canon, settings, with_gpu};
use glam::{DAffine3, DVec3};
use lumbre::bvh::{Bvh, CHUNK, primitive_bounds};
use lumbre::layout::backend::Backend;
use lumbre::layout::{HitRecord, INLINE_MAX, Primitive, RayRecord};
use lumbre::render::{Probe, Settings};
use lumbre::scene::{Mesh, Scene, SceneBuilder};

/// A small generator of reproducible numbers (Steele, Lea and Flood 2014, SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn in_cube(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5) * 2.0 * half
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube(1.0);
            if (1e-3..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

/// Pairs of triangles that share their longest edge, folded at any angle: many rays pass through both.
fn folds(random: &mut Random, count: usize) -> Scene {
    let mut builder = SceneBuilder::new("folds");
    let matte = builder.matte([0.5; 3]);
    for index in 0..count {
        let (a, b) = (random.in_cube(1.0), random.in_cube(1.0));
        let mut side = || {
            let middle = a.lerp(b, 0.3 + 0.4 * random.next());
            middle + 0.3 * (b - a).length() * random.direction().cross((b - a).normalize())
        };
        let positions = vec![a, b, side(), side()];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [1, 0, 3]], ..Mesh::default() };
        builder.mesh(0, &index.to_string(), mesh, DAffine3::IDENTITY, matte);
    }
    builder.finish().unwrap()
}

/// Every triangle of a mesh whose longest edges meet in twos is in a pair, the one after the other; triangles that share no edge stay alone, as do those of an
/// edge that three share, but for one pair.
#[test]
fn leaves_hold_pairs_of_triangles() {
    let mut random = Random(41);
    let folded = folds(&mut random, 700);
    let mut three = SceneBuilder::new("three");
    let matte = three.matte([0.5; 3]);
    let (a, b) = (DVec3::ZERO, DVec3::X);
    let positions = vec![a, b, DVec3::new(0.5, 0.2, 0.0), DVec3::new(0.5, -0.2, 0.0), DVec3::new(0.5, 0.0, 0.2)];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]], ..Mesh::default() };
    three.mesh(0, "three", mesh, DAffine3::IDENTITY, matte);
    let three = three.finish().unwrap();
    for (scene, pairs, chunk) in [(&folded, 700, CHUNK), (&folded, 700, 100), (&three, 1, CHUNK)] {
        let tree = Bvh::over_primitives(&scene.primitives, chunk, &|_| {});
        tree.validate(&scene.primitives.iter().map(primitive_bounds).collect::<Vec<_>>()).unwrap();
        assert_eq!(tree.paired.iter().filter(|paired| **paired).count(), pairs);
        for slot in (0..tree.order.len()).filter(|slot| tree.paired[*slot]) {
            let [before, later] = [slot - 1, slot].map(|slot| &scene.primitives[tree.order[slot] as usize]);
            assert!(before.v1 == later.v2 && before.v2 == later.v1, "slot {slot}: {before:?}, {later:?}");
            // Both are in one leaf.
            let together = tree.nodes.iter().any(|node| {
                (0..8).any(|child| {
                    !node.is_child_empty(child)
                        && node.is_leaf(child)
                        && node.child_primitives(child) == (slot as u32 - 1, 2)
                })
            });
            assert!(together, "slot {slot}");
        }
    }
}

/// A tiny scene's primitives as constants of the kernel answer bit for bit as the BVH does: triangles, both kinds, and as many spheres as fit.
#[test]
fn inline_primitives_answer_as_the_bvh_does() {
    let mut random = Random(5);
    let mut spheres = SceneBuilder::new("spheres");
    let matte = spheres.matte([0.5; 3]);
    for index in 0..INLINE_MAX {
        spheres.sphere(0, &index.to_string(), random.in_cube(1.0), 0.05 + 0.2 * random.next(), matte);
    }
    let canon = |name| (name, canon(name, &[]));
    let folds = ("folds", folds(&mut random, INLINE_MAX as usize / 2));
    for (name, scene) in
        [canon("cornell.xml"), canon("cornell_spheres.xml"), ("spheres", spheres.finish().unwrap()), folds]
    {
        let bounds = scene.bounds;
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
        let rays: Vec<RayRecord> = (0..100_000)
            .map(|_| RayRecord {
                origin: (centre + 1.1 * half * random.in_cube(1.0)).as_vec3().into(),
                direction: random.direction().as_vec3().into(),
                t_max: if random.next() < 0.3 { half.length() as f32 } else { 3e38 },
            })
            .collect();
        with_gpu(|gpu| {
            let answers = [0, u64::MAX].map(|expected_samples| {
                let settings = Settings { expected_samples, ..settings(&scene, "path", Backend::Bvh) };
                let probe = Probe::new(gpu, &scene, &settings, "test/trace").unwrap();
                probe.run::<RayRecord, HitRecord>(&rays).unwrap()
            });
            for (index, (memory, inline)) in answers[0].iter().zip(&answers[1]).enumerate() {
                let same = if memory.t < 0.0 { inline.t < 0.0 } else { memory == inline };
                assert!(
                    same && memory.blocked == inline.blocked,
                    "{name}, ray {index}, {:?}: {memory:?} against {inline:?}",
                    rays[index]
                );
            }
            let met = answers[0].iter().filter(|hit| hit.t >= 0.0).count();
            println!("{name}: {met} of {} rays meet something", rays.len());
            assert!(met > 20_000, "{met} rays meet {name}");
        });
    }
}

#[test]
fn trees_over_awkward_boxes_are_valid() {
    let mut random = Random(23);
    for count in [0, 1, 2, 3, 4, 7, 64, 1000, 20_000] {
        for kind in ["even", "one point", "flat", "far", "wild", "equal", "one is huge"] {
            let boxes: Vec<_> = (0..count)
                .map(|index| {
                    let size = if kind == "one is huge" && index == count / 3 { 1e4 } else { 0.01 };
                    let centre = match kind {
                        "one point" => DVec3::ONE,
                        "flat" => random.in_cube(1.0) * DVec3::new(1.0, 0.0, 1.0),
                        "far" => DVec3::splat(1e6) + random.in_cube(1.0),
                        "wild" => random.in_cube(1.0) * 10f64.powf(random.next() * 16.0 - 8.0),
                        _ => random.in_cube(1.0),
                    };
                    let mut corner = || {
                        (centre
                            + random.in_cube(size)
                                * if kind == "flat" { DVec3::new(1.0, 0.0, 1.0) } else { DVec3::ONE })
                        .as_vec3()
                    };
                    primitive_bounds(&Primitive {
                        v0: corner().into(),
                        v1: corner().into(),
                        v2: corner().into(),
                        surface: 0,
                    })
                })
                .collect();
            let boxes = if kind == "equal" {
                vec![boxes[..].first().copied(); count].into_iter().flatten().collect()
            } else {
                boxes
            };
            for chunk in [CHUNK, 1500, 64, 5, 1].into_iter().filter(|chunk| count / chunk <= 1000) {
                let told = AtomicUsize::new(0);
                let tree = Bvh::build_in_chunks(&boxes, chunk, &|done| {
                    told.fetch_max(done, Ordering::Relaxed);
                });
                let valid = tree.validate(&boxes);
                valid.unwrap_or_else(|error| panic!("{count} boxes, {kind}, chunks of {chunk}: {error}"));
                assert_eq!((tree.order.len(), told.into_inner()), (count, count), "{kind}, chunks of {chunk}");
                assert!(tree.depth < 64, "{count} boxes, {kind}, chunks of {chunk}: {} deep", tree.depth);
            }
        }
    }
}

/// The same boxes give the same tree, whichever chunk is built first.
#[test]
fn chunked_trees_repeat_bit_for_bit() {
    let mut random = Random(37);
    let boxes: Vec<_> = (0..20_000)
        .map(|_| {
            let centre = random.in_cube(1.0);
            let mut corner = || (centre + random.in_cube(0.01)).as_vec3().into();
            primitive_bounds(&Primitive { v0: corner(), v1: corner(), v2: corner(), surface: 0 })
        })
        .collect();
    let first = Bvh::build_in_chunks(&boxes, 500, &|_| {});
    for _ in 0..5 {
        let again = Bvh::build_in_chunks(&boxes, 500, &|_| {});
        assert!(first.nodes == again.nodes && first.order == again.order && first.depth == again.depth);
    }
}

/// `validate` must be able to fail.
#[test]
fn a_damaged_tree_is_not_valid() {
    let mut random = Random(29);
    let boxes: Vec<_> = (0..200)
        .map(|_| {
            let mut corner = || random.in_cube(1.0).as_vec3().into();
            primitive_bounds(&Primitive { v0: corner(), v1: corner(), v2: corner(), surface: 0 })
        })
        .collect();
    let tree = Bvh::build(&boxes);
    let mut shrunk = tree.clone();
    shrunk.nodes[0].child_max_y = shrunk.nodes[0].child_max_y.map(|plane| plane.saturating_sub(3));
    assert!(shrunk.validate(&boxes).is_err(), "a box that is too small");
    let mut doubled = tree.clone();
    doubled.order[0] = doubled.order[1];
    assert!(doubled.validate(&boxes).is_err(), "a box in two leaves");
}
