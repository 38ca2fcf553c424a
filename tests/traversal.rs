//! Both backends, through the shaders' own `trace_closest` and `trace_any`, against a CPU brute force in double precision.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod common;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{backends, settings, with_gpu};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use lumbre::backend::Backend;
use lumbre::bvh::{Bvh, CHUNK, primitive_bounds};
use lumbre::gpu::Gpu;
use lumbre::layout::{HitRecord, Primitive, RayRecord, SPHERE_BIT};
use lumbre::render::{Probe, Settings};
use lumbre::scene::{Mesh, Scene, SceneBuilder};
use rayon::prelude::*;

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

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
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

/// An icosahedron, each face cut into four `levels` times, on a sphere of radius 1.
fn icosphere(levels: u32) -> Mesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions: Vec<DVec3> = [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)]
        .into_iter()
        .flat_map(|(a, b)| [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)])
        .map(DVec3::normalize)
        .collect();
    // Faces: all triples of mutually adjacent vertices.
    let adjacent = |a: DVec3, b: DVec3| (a - b).length() < 1.1;
    let mut triangles = Vec::new();
    for a in 0..12u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|index| positions[index as usize]);
                if adjacent(p, q) && adjacent(q, r) && adjacent(r, p) {
                    let outward = (q - p).cross(r - p).dot(p) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..levels {
        let mut middles = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (middle(*a, *b), middle(*b, *c), middle(*c, *a));
                [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]]
            })
            .collect();
    }
    Mesh { positions, triangles, ..Mesh::default() }
}

/// Instances (turned, mirrored, sheared), spheres, slivers, quads along the axes, and a mesh with shared edges.
fn scene() -> Scene {
    let mut random = Random(7);
    let mut builder = SceneBuilder::new("traversal test");
    let surface = builder.matte([0.5; 3]);
    let ball = builder.group("ball");
    builder.mesh(ball, "ball", icosphere(1), DAffine3::IDENTITY, surface);
    builder.sphere(ball, "core", DVec3::new(0.2, 0.1, 0.0), 0.4, surface);
    builder.instance(ball, DAffine3::from_translation(DVec3::new(2.0, 0.0, 0.0)));
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    builder.instance(
        ball,
        DAffine3::from_scale_rotation_translation(DVec3::new(-1.3, 0.7, 1.1), turn, DVec3::new(-2.0, 1.0, 0.5)),
    );
    let shear = DMat3::from_cols(DVec3::new(1.0, 0.4, 0.0), DVec3::new(0.0, 0.5, 0.3), DVec3::new(0.2, 0.0, 2.0));
    builder.instance(ball, DAffine3::from_mat3_translation(shear, DVec3::new(0.0, -2.0, -1.0)));
    // A floor of quads along the axes, their corners on round numbers.
    for x in -4..4 {
        for z in -4..4 {
            builder.parallelogram(DVec3::new(f64::from(x), -4.0, f64::from(z)), DVec3::Z, DVec3::X, surface);
        }
    }
    builder.parallelogram(DVec3::new(-4.0, -4.0, -4.0), DVec3::X * 8.0, DVec3::Y * 8.0, surface);
    for _ in 0..12 {
        let centre = random.in_cube(4.0);
        builder.sphere(0, "sphere", centre, 0.05 + 0.5 * random.next(), surface);
    }
    let mut slivers = Mesh::default();
    for _ in 0..80 {
        let (from, along, aside) = (random.in_cube(4.0), random.direction() * 3.0, random.direction() * 3e-5);
        let first = slivers.positions.len() as u32;
        slivers.positions.extend([from, from + along, from + along * random.next() + aside]);
        slivers.triangles.push([first, first + 1, first + 2]);
    }
    builder.mesh(0, "slivers", slivers, DAffine3::IDENTITY, surface);
    builder.finish().unwrap()
}

/// Random rays, and rays aimed at what is hard: vertices, edges, the axes.
fn rays(scene: &Scene, count: usize) -> Vec<RayRecord> {
    let mut random = Random(11);
    let point = |v: [f32; 3]| glam::Vec3::from(v).as_dvec3();
    (0..count)
        .map(|index| {
            let origin = random.in_cube(if index % 2 == 0 { 4.0 } else { 9.0 }).as_vec3();
            let placed = scene.instances[random.below(scene.instances.len())];
            let group = &scene.groups[placed.group];
            let slot = group.triangles.start as usize + random.below(group.triangles.len());
            let triangle = &scene.primitives[slot];
            let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(|v| placed.to_world.transform_point3(point(v)));
            let target = match index % 8 {
                0 | 1 => None,
                2 => Some(a),
                3 => Some(a.lerp(b, random.next())),
                4 => Some((a + b + c) / 3.0),
                5 => Some(b.lerp(c, random.next())),
                _ => None,
            };
            let axis = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z][random.below(6)];
            let (origin, direction) = match (index % 8, target) {
                (_, Some(target)) => (origin, (target - origin.as_dvec3()).normalize()),
                // Along an axis, from a grid that holds the quads' edges and corners.
                (6 | 7, None) => ((random.in_cube(8.0) * 2.0).round().as_vec3() * 0.5, axis),
                (_, None) => (origin, random.direction()),
            };
            let t_max = if index % 5 == 0 { (random.next() * 8.0) as f32 } else { 3e38 };
            RayRecord { origin: origin.into(), direction: direction.as_vec3().into(), t_max }
        })
        .collect()
}

/// One possible hit in exact arithmetic, with how sure it is.
#[derive(Clone, Copy)]
struct Candidate {
    t: f64,
    primitive: u32,
    instance: u32,
    /// How far the ray passes inside the primitive's outline, in units of the tolerance: below -1 it is a miss for certain,
    /// above 1 a hit for certain.
    inside: f64,
    /// How far t may be off.
    slack: f64,
}

/// Relative error that single precision may make in where a ray passes a vertex: a few roundings of coordinates of the
/// size of the scene, twice where an instance maps the ray first.
const TOLERANCE: f64 = 4e-6;

/// All primitives that a ray may hit.
fn candidates(scene: &Scene, ray: &RayRecord) -> Vec<Candidate> {
    let vector = |v: [f32; 3]| glam::Vec3::from(v).as_dvec3();
    let mut found = Vec::new();
    for (instance, placed) in scene.instances.iter().enumerate() {
        let to_object = placed.to_world.inverse();
        let (origin, direction) =
            (to_object.transform_point3(vector(ray.origin)), to_object.transform_vector3(vector(ray.direction)));
        let length = direction.length();
        let size = origin.abs().max_element() + 9.0;
        let epsilon = TOLERANCE * size;
        for slot in scene.groups[placed.group].primitives() {
            let primitive = &scene.primitives[slot];
            let v0 = vector(primitive.v0);
            if primitive.surface & SPHERE_BIT != 0 {
                let radius = f64::from(primitive.v1[0].abs());
                let to_centre = v0 - origin;
                let along = to_centre.dot(direction) / (length * length);
                let off = (to_centre - direction * along).length();
                let half = (radius * radius - off * off).max(0.0).sqrt() / length;
                // Near the outline the distance is uncertain by the root of the uncertainty.
                let slack =
                    (epsilon + (2.0 * radius * epsilon).sqrt().min(epsilon * radius / half.max(1e-12))) / length;
                let inside = (radius - off) / epsilon;
                if inside > -1.0 {
                    for t in [along - half, along + half] {
                        found.push(Candidate { t, primitive: slot as u32, instance: instance as u32, inside, slack });
                    }
                }
                continue;
            }
            let (v1, v2) = (vector(primitive.v1), vector(primitive.v2));
            let [a, b, c] = [v0 - origin, v1 - origin, v2 - origin];
            let unit = direction / length;
            // Distance of the ray from each edge's line, seen along the ray: signed by the side.
            let edge = |p: DVec3, q: DVec3| {
                let (p, q) = (p - unit * p.dot(unit), q - unit * q.dot(unit));
                let e = q - p;
                (p.cross(q).dot(unit), e.length().max(1e-30), p.length().min(q.length()))
            };
            let edges = [edge(b, c), edge(c, a), edge(a, b)];
            let sign = if edges.iter().map(|edge| edge.0).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
            // How far inside: the least distance to an edge. Beyond an edge's ends the distance to its line is less than
            // that to the triangle, which errs towards calling a hit possible; so the vertices are looked at too.
            let inside = edges.iter().map(|(side, length, _)| sign * side / length).fold(f64::INFINITY, f64::min);
            let n = (v1 - v0).cross(v2 - v0);
            let facing = (n.normalize().dot(unit)).abs();
            if inside / epsilon > -1.0 && facing > 1e-12 {
                let t = n.dot(a) / n.dot(direction);
                let nearest = [a, b, c]
                    .iter()
                    .map(|p| p.dot(unit))
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
                // The plane of a sliver is uncertain by the angle that its height subtends.
                let height = n.length() / (v1 - v0).length().max((v2 - v0).length()).max((v2 - v1).length());
                let tilt = 1.0 + (nearest.1 - nearest.0).max((v1 - v0).length()) / height.max(1e-12) * 6e-8 / TOLERANCE;
                found.push(Candidate {
                    t,
                    primitive: slot as u32,
                    instance: instance as u32,
                    inside: inside / epsilon,
                    slack: epsilon * tilt / (facing * length),
                });
            }
        }
    }
    found
}

#[derive(Default, Debug)]
struct Tally {
    same: usize,
    misses: usize,
    ties: usize,
    near_outline: usize,
    wrong: Vec<String>,
}

impl Tally {
    fn add(mut self, other: Self) -> Self {
        self.same += other.same;
        self.misses += other.misses;
        self.ties += other.ties;
        self.near_outline += other.near_outline;
        self.wrong.extend(other.wrong);
        self
    }
}

/// Holds one answer against the brute force.
fn judge(scene: &Scene, ray: &RayRecord, hit: &HitRecord, primitive: u32, instance: u32, tally: &mut Tally) {
    let all = candidates(scene, ray);
    let t_max = f64::from(ray.t_max);
    let in_range = |c: &&Candidate| c.t > 0.0 && c.t < t_max;
    let certain = all
        .iter()
        .filter(|c| c.inside > 1.0 && c.t - c.slack > 0.0 && c.t + c.slack < t_max)
        .min_by(|a, b| a.t.total_cmp(&b.t));
    let exact = all.iter().filter(|c| c.inside >= 0.0).filter(in_range).min_by(|a, b| a.t.total_cmp(&b.t));
    // The two questions must agree with each other.
    if (hit.t >= 0.0) != (hit.blocked == 1) {
        tally.wrong.push(format!("{ray:?}: closest says {}, any says {}", hit.t, hit.blocked));
        return;
    }
    if hit.t < 0.0 {
        match (certain, exact) {
            (Some(missed), _) => {
                tally.wrong.push(format!("{ray:?}: missed primitive {} at {}", missed.primitive, missed.t))
            }
            (None, None) => tally.misses += 1,
            (None, Some(_)) => tally.near_outline += 1,
        }
        return;
    }
    let t = f64::from(hit.t);
    let mine = all
        .iter()
        .filter(|c| c.primitive == primitive && c.instance == instance)
        .min_by(|a, b| (a.t - t).abs().total_cmp(&(b.t - t).abs()));
    let Some(mine) = mine else {
        tally.wrong.push(format!(
            "{ray:?}: primitive {primitive} of instance {instance} at {t} is no hit at all; expected {:?}",
            exact.map(|c| (c.primitive, c.t))
        ));
        return;
    };
    if (mine.t - t).abs() > mine.slack + 4.0 * f64::from(f32::EPSILON) * t {
        tally.wrong.push(format!(
            "{ray:?}: primitive {primitive} is at {} and was found at {t}, slack {}",
            mine.t, mine.slack
        ));
        return;
    }
    if let Some(nearer) = certain.filter(|c| c.t + c.slack < t - mine.slack) {
        tally
            .wrong
            .push(format!("{ray:?}: primitive {primitive} at {t} is behind {} at {}", nearer.primitive, nearer.t));
        return;
    }
    match exact {
        Some(c) if c.primitive == primitive && c.instance == instance => tally.same += 1,
        // Another primitive at the same distance: within 4 ulp.
        Some(c) if (c.t - t).abs() <= 4.0 * f64::from(f32::EPSILON) * t => tally.ties += 1,
        _ => tally.near_outline += 1,
    }
}

fn check(gpu: &Gpu, scene: &Scene, settings: &Settings, count: usize) {
    let backend = settings.backend;
    let rays = rays(scene, count);
    let probe = Probe::new(gpu, scene, settings, "test/trace").unwrap();
    let hits: Vec<HitRecord> = probe.run(&rays).unwrap();
    // Rays at random or at the middle of triangles, and rays aimed at vertices, edges and along the axes.
    for (kind, is_kind, most_near_outline) in [
        ("random", (|index| matches!(index % 8, 0 | 1 | 4)) as fn(usize) -> bool, 0.002),
        ("aimed", |index| !matches!(index % 8, 0 | 1 | 4), 0.05),
    ] {
        let tally = rays
            .par_iter()
            .zip(&hits)
            .enumerate()
            .filter(|(index, _)| is_kind(*index))
            .fold(Tally::default, |mut tally, (_, (ray, hit))| {
                let primitive = probe.order().get(hit.primitive as usize).copied().unwrap_or(u32::MAX);
                let instance = probe.instance_order().get(hit.instance as usize).copied().unwrap_or(u32::MAX);
                judge(scene, ray, hit, primitive, instance, &mut tally);
                tally
            })
            .reduce(Tally::default, Tally::add);
        let total = tally.same + tally.misses + tally.ties + tally.near_outline + tally.wrong.len();
        println!(
            "{} on {}, {total} {kind} rays: {} hit the same primitive, {} miss, {} tie within 4 ulp, {} differ within rounding of an outline, {} wrong",
            backend.name(),
            gpu.survey().name,
            tally.same,
            tally.misses,
            tally.ties,
            tally.near_outline,
            tally.wrong.len()
        );
        assert!(
            tally.wrong.is_empty(),
            "{}: wrong:\n{}",
            backend.name(),
            tally.wrong[..tally.wrong.len().min(5)].join("\n")
        );
        assert!(tally.same > total / 4, "{}: only {} of {total} rays hit something", backend.name(), tally.same);
        let share = tally.near_outline as f64 / total as f64;
        assert!(share < most_near_outline, "{}: {share} of the {kind} rays differ near outlines", backend.name());
    }
}

#[test]
fn both_backends_find_what_brute_force_finds() {
    let scene = scene();
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            check(gpu, &scene, &settings(&scene, "path", backend), 1_000_000);
        }
    });
}

/// Groups that are cut into chunks, each with a tree of its own, are traversed as one.
#[test]
fn chunked_trees_find_what_brute_force_finds() {
    let scene = scene();
    with_gpu(|gpu| {
        for chunk in [1, 10] {
            check(gpu, &scene, &Settings { chunk, ..settings(&scene, "path", Backend::Bvh) }, 50_000);
        }
    });
}

/// From inside a closed mesh every ray hits, also those at its vertices and edges. `bvh` is watertight; a driver's own ray
/// queries may not be, which is printed, but must not lose rays that are aimed at nothing in particular.
#[test]
fn closed_meshes_have_no_holes() {
    let mut random = Random(3);
    let mut cube = Mesh::default();
    for corner in 0..8 {
        let side = |bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        cube.positions.push(DVec3::new(side(2), side(1), side(0)));
    }
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    cube.triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let shift = DAffine3::from_translation(DVec3::new(0.37, -1.21, 3.3));
    let axes = [DVec3::X, DVec3::NEG_Y, DVec3::Z];
    for (name, mesh, map) in [
        ("cube", cube, DAffine3::IDENTITY),
        ("ball", icosphere(3), DAffine3::IDENTITY),
        ("shifted ball", icosphere(3), shift),
    ] {
        let mut builder = SceneBuilder::new(name);
        let surface = builder.matte([0.5; 3]);
        builder.mesh(0, name, mesh, map, surface);
        let scene = builder.finish().unwrap();
        let rays: Vec<RayRecord> = (0..1_000_000)
            .map(|index| {
                let triangle = &scene.primitives[random.below(scene.primitives.len())];
                let [a, b] = [triangle.v0, triangle.v1].map(|v| glam::Vec3::from(v).as_dvec3());
                let origin = map.transform_point3(random.in_cube(0.5)).as_vec3();
                let direction = match index % 6 {
                    0 | 3 => a - origin.as_dvec3(),
                    1 | 4 => a.lerp(b, random.next()) - origin.as_dvec3(),
                    2 => random.direction(),
                    _ => axes[index % 3],
                };
                RayRecord { origin: origin.into(), direction: direction.normalize().as_vec3().into(), t_max: 3e38 }
            })
            .collect();
        with_gpu(|gpu| {
            for backend in backends(gpu) {
                let probe = Probe::new(gpu, &scene, &settings(&scene, "path", backend), "test/trace").unwrap();
                let hits: Vec<HitRecord> = probe.run(&rays).unwrap();
                let mut missed = [0; 3]; // at vertices, at edges, elsewhere
                for (index, _) in hits.iter().enumerate().filter(|(_, hit)| hit.t < 0.0 || hit.blocked == 0) {
                    missed[index % 3] += 1;
                }
                let driver = &gpu.survey().driver;
                println!(
                    "{name} on {} ({driver}): of {} rays {missed:?} slip out at vertices, edges, elsewhere",
                    backend.name(),
                    rays.len()
                );
                assert_eq!(missed[2], 0, "{name} on {}", backend.name());
                assert!(backend == Backend::RayQuery || missed == [0; 3], "{name} on {}: {missed:?}", backend.name());
            }
        });
    }
}

/// A tiny scene's triangles as constants of the kernel answer bit for bit as the BVH does.
#[test]
fn inline_triangles_answer_as_the_bvh_does() {
    let scene = common::canon("cornell.xml", &[]);
    let mut random = Random(5);
    let rays: Vec<RayRecord> = (0..200_000)
        .map(|_| RayRecord {
            origin: (DVec3::splat(278.0) + random.in_cube(300.0)).as_vec3().into(),
            direction: random.direction().as_vec3().into(),
            t_max: if random.next() < 0.3 { 400.0 } else { 3e38 },
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
                "ray {index}, {:?}: {memory:?} against {inline:?}",
                rays[index]
            );
        }
        assert!(answers[0].iter().filter(|hit| hit.t >= 0.0).count() > 100_000, "the rays should meet the box");
    });
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
