//! What `lumbre rays` measures: the counts of its counting kernel against a traversal on the CPU, and the order of the rays.

use crate::common::sampling::spread;
use crate::common::{backends, canon, settings, with_gpu};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use lumbre::bvh::{Bvh, CELL_MARGIN, CHUNK};
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::layout::{NODE_BYTES, Primitive, RayRecord, TraversalCount};
use lumbre::rays::{self, RayKind, export, make, measure, shuffle};
use lumbre::render::{Probe, Settings};
use lumbre::scene::{Mesh, Scene, SceneBuilder};

/// A point of the cube from -1 to 1.
fn in_cube(u: &[f32]) -> DVec3 {
    Vec3::from_slice(u).as_dvec3() * 2.0 - 1.0
}

/// A scene of so many triangles of all sizes in that cube, placed by each of the maps.
fn soup(count: u32, placements: &[DAffine3]) -> Scene {
    let mut mesh = Mesh::default();
    for (index, u) in (0..).zip(spread::<10>(count as usize)) {
        let (at, size) = (in_cube(&u), 0.4 * f64::from(u[9]).powi(2) + 0.02);
        mesh.positions.extend([at, at + in_cube(&u[3..]) * size, at + in_cube(&u[6..]) * size]);
        mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
    }
    let mut builder = SceneBuilder::new("soup");
    let surface = builder.matte([0.5; 3]);
    if placements.is_empty() {
        builder.mesh(0, "soup", mesh, DAffine3::IDENTITY, surface);
    } else {
        let group = builder.group("soup");
        builder.mesh(group, "soup", mesh, DAffine3::IDENTITY, surface);
        placements.iter().for_each(|placed| builder.instance(group, *placed));
    }
    builder.finish().unwrap()
}

/// Rays from points around the cube to points in it, some of them short.
fn rays(count: usize) -> Vec<RayRecord> {
    let ray = |u: [f32; 7]| {
        let origin = in_cube(&u) * 2.0;
        let direction = (in_cube(&u[3..]) - origin).normalize();
        let t_max = if u[6] < 0.2 { 5.0 * u[6] } else { 3e38 };
        RayRecord { origin: origin.as_vec3().into(), direction: direction.as_vec3().into(), t_max }
    };
    spread(count).into_iter().map(ray).collect()
}

fn count(gpu: &Gpu, scene: &Scene, settings: &Settings, rays: &[RayRecord]) -> Vec<TraversalCount> {
    Probe::new(gpu, scene, settings, "rays/count").unwrap().run(rays).unwrap()
}

/// Traversal of one tree on the CPU: children in the order that the ray's octant gives, nothing remembered for later but what
/// recursion remembers.
struct Walk<'a> {
    tree: &'a Bvh,
    primitives: &'a [Primitive],
    origin: Vec3,
    direction: Vec3,
    any: bool,
    nearest: f32,
    found: bool,
    nodes: u32,
    tested: u32,
}

impl Walk<'_> {
    fn visit(&mut self, index: usize) {
        let node = self.tree.nodes[index];
        self.nodes += 1;
        let cell = Vec3::from_array(node.e.map(|exponent| f32::from_bits(u32::from(exponent) << 23)));
        let corner = |x: &[u8; 8], y: &[u8; 8], z: &[u8; 8], child: usize, outwards: f32| {
            node.p + (Vec3::new(x[child].into(), y[child].into(), z[child].into()) + outwards) * cell
        };
        let margin = CELL_MARGIN as f32;
        let mut leaves = Vec::new();
        let mut inner = Vec::new();
        for child in (0..8).filter(|child| !node.is_child_empty(*child)) {
            let low = corner(&node.child_min_x, &node.child_min_y, &node.child_min_z, child, -margin);
            let high = corner(&node.child_max_x, &node.child_max_y, &node.child_max_z, child, margin);
            let (a, b) = ((low - self.origin) / self.direction, (high - self.origin) / self.direction);
            let (enter, leave) = (a.min(b).max_element().max(0.0), a.max(b).min_element().min(self.nearest));
            if enter <= leave && node.is_leaf(child) {
                let (first, count) = node.child_primitives(child);
                leaves.extend(first..first + count);
            } else if enter <= leave {
                let side = |negative: bool, bit: usize| if negative { 0 } else { bit };
                let d = self.direction;
                let octant = side(d.x < 0.0, 4) | side(d.y < 0.0, 2) | side(d.z < 0.0, 1);
                inner.push((child ^ octant, node.child_node_index(child) as usize));
            }
        }
        leaves.sort_unstable();
        for slot in leaves.into_iter().rev() {
            self.test(self.tree.order[slot as usize]);
            if self.any && self.found {
                return;
            }
        }
        inner.sort_unstable();
        for (_, child) in inner.into_iter().rev() {
            self.visit(child);
            if self.any && self.found {
                return;
            }
        }
    }

    /// Moeller and Trumbore 1997, which is not what the shaders do.
    fn test(&mut self, index: u32) {
        self.tested += 1;
        let [v0, v1, v2] = [|p: &Primitive| p.v0, |p: &Primitive| p.v1, |p: &Primitive| p.v2]
            .map(|vertex| Vec3::from(vertex(&self.primitives[index as usize])).as_dvec3());
        let (origin, direction) = (self.origin.as_dvec3(), self.direction.as_dvec3());
        let (e1, e2) = (v1 - v0, v2 - v0);
        let p = direction.cross(e2);
        let scale = 1.0 / e1.dot(p);
        let s = origin - v0;
        let q = s.cross(e1);
        let weights = Vec2::new((s.dot(p) * scale) as f32, (direction.dot(q) * scale) as f32);
        let t = (e2.dot(q) * scale) as f32;
        if weights.min_element() >= 0.0 && weights.element_sum() <= 1.0 && t > 0.0 && t < self.nearest {
            self.nearest = t;
            self.found = true;
        }
    }
}

fn walk(tree: &Bvh, scene: &Scene, ray: &RayRecord) -> TraversalCount {
    let walked = [false, true].map(|any| {
        let mut walk = Walk {
            tree,
            primitives: &scene.primitives,
            origin: ray.origin.into(),
            direction: ray.direction.into(),
            any,
            nearest: ray.t_max,
            found: false,
            nodes: 0,
            tested: 0,
        };
        walk.visit(0);
        (walk.nodes, walk.tested)
    });
    let [(closest_nodes, closest_primitives), (any_nodes, any_primitives)] = walked;
    TraversalCount { closest_nodes, closest_primitives, any_nodes, any_primitives }
}

/// The tree that is traversed.
fn tree_of(scene: &Scene) -> Bvh {
    Bvh::over_primitives(&scene.primitives, CHUNK, &|_| {})
}

fn sums(counts: &[TraversalCount]) -> [f64; 4] {
    counts.iter().fold([0.0; 4], |sums, count| {
        let values = [count.closest_nodes, count.closest_primitives, count.any_nodes, count.any_primitives];
        [0, 1, 2, 3].map(|index| sums[index] + f64::from(values[index]))
    })
}

#[test]
fn counts_are_those_of_a_traversal_on_the_cpu() {
    let scene = soup(3000, &[]);
    let rays = rays(20_000);
    let tree = tree_of(&scene);
    let expected: Vec<TraversalCount> = rays.iter().map(|ray| walk(&tree, &scene, ray)).collect();
    with_gpu(|gpu| {
        let found = count(gpu, &scene, &settings(&scene, "path", Backend::Bvh), &rays);
        let same = |pair: &(&TraversalCount, &TraversalCount)| bytemuck::bytes_of(pair.0) == bytemuck::bytes_of(pair.1);
        let differ = found.len() - found.iter().zip(&expected).filter(same).count();
        let (found, expected) = (sums(&found), sums(&expected));
        println!("counts {found:?} against {expected:?}; {differ} of {} rays differ", rays.len());
        // Boxes are tested with another rounding and a margin for it: a few rays that graze one go another way.
        assert!(differ * 500 < rays.len(), "{differ} rays differ");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 5e-4, "{found} against {expected}");
        }
        // The scene is one in which order and early ends matter.
        assert!(found[2] < 0.8 * found[0] && found[3] < 0.8 * found[1]);
    });
}

#[test]
fn counts_of_one_leaf_of_instances_and_of_constants() {
    let alone = {
        let mut builder = SceneBuilder::new("one triangle");
        let surface = builder.matte([0.5; 3]);
        let positions = vec![DVec3::new(-0.9, -0.7, 0.2), DVec3::new(0.8, -0.4, -0.5), DVec3::new(0.1, 0.9, 0.3)];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        builder.mesh(0, "triangle", mesh, DAffine3::IDENTITY, surface);
        builder.finish().unwrap()
    };
    let placed = soup(400, &[DAffine3::IDENTITY, DAffine3::from_translation(DVec3::new(0.5, 0.0, 0.0))]);
    let rays = rays(5000);
    with_gpu(|gpu| {
        // One triangle: its node is read for every ray, and it is tested where the ray meets its box.
        let read = Settings { expected_samples: 1, ..settings(&alone, "path", Backend::Bvh) };
        let found = count(gpu, &alone, &read, &rays);
        let tree = tree_of(&alone);
        assert_eq!(tree.nodes.len(), 1);
        assert!(found.iter().all(|count| count.closest_nodes == 1 && count.any_nodes == 1));
        let met = |counts: &[TraversalCount]| counts.iter().filter(|count| count.closest_primitives == 1).count();
        let expected: Vec<TraversalCount> = rays.iter().map(|ray| walk(&tree, &alone, ray)).collect();
        println!("one leaf: {} rays of {} meet its box, {} expected", met(&found), rays.len(), met(&expected));
        assert!((500..4500).contains(&met(&found)) && met(&found).abs_diff(met(&expected)) <= 1);
        assert!(found.iter().all(|count| count.closest_primitives <= 1));

        // The same triangle held by the kernel is always tested, and nothing is read.
        let found = count(gpu, &alone, &settings(&alone, "path", Backend::Bvh), &rays);
        assert!(found.iter().all(|count| (count.closest_nodes, count.closest_primitives) == (0, 1)));
        assert!(found.iter().all(|count| (count.any_nodes, count.any_primitives) == (0, 1)));

        // Two placements: every ray reads the upper level's node, and none more than all of both.
        let found = count(gpu, &placed, &settings(&placed, "path", Backend::Bvh), &rays);
        let nodes = 1 + 2 * tree_of(&placed).nodes.len() as u32;
        assert!(found.iter().all(|count| (1..=nodes).contains(&count.closest_nodes)));
        assert!(
            found.iter().all(|count| count.any_nodes <= count.closest_nodes.max(1) && count.closest_primitives <= 800)
        );
        assert!(found.iter().any(|count| count.closest_nodes > 10));
    });
}

/// Shuffled rays get the answers that they get in order, bit by bit.
#[test]
fn shuffled_rays_find_the_same() {
    let order = shuffle(10_000);
    let mut seen = order.clone();
    seen.sort_unstable();
    assert!(seen.iter().enumerate().all(|(index, slot)| index as u32 == *slot), "not a permutation");
    // In a random order the mean distance of neighbours is a third of the length, and one element stays, give or take a few.
    let apart = order.windows(2).map(|pair| f64::from(pair[0].abs_diff(pair[1]))).sum::<f64>() / 9999.0;
    assert!((apart / (10_000.0 / 3.0) - 1.0).abs() < 0.03, "{apart}");
    assert!(order.iter().enumerate().filter(|(index, slot)| *index as u32 == **slot).count() < 8);
    assert!(shuffle(0).is_empty() && shuffle(1) == [0]);

    let scene = canon("cornell.xml", &[]);
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            let settings = Settings { width: 48, height: 48, ..settings(&scene, "path", backend) };
            let sets = make(gpu, &scene, &settings).unwrap();
            assert_eq!(
                sets.iter().map(|(kind, _)| *kind).collect::<Vec<_>>(),
                [RayKind::Primary, RayKind::Shadow, RayKind::DiffuseBounce]
            );
            for (kind, rays) in sets {
                assert!(rays.len() > 1000 && rays.iter().all(|ray| ray.t_max > 0.0));
                let order = shuffle(rays.len());
                let mixed: Vec<RayRecord> = order.iter().map(|index| rays[*index as usize]).collect();
                for kernel in ["rays/closest", "rays/any"] {
                    let probe = Probe::new(gpu, &scene, &settings, kernel).unwrap();
                    let ordered: Vec<u32> = probe.run(&rays).unwrap();
                    let shuffled: Vec<u32> = probe.run(&mixed).unwrap();
                    let mut sorted = vec![0; rays.len()];
                    order.iter().zip(shuffled).for_each(|(index, answer)| sorted[*index as usize] = answer);
                    assert!(ordered == sorted, "{kind:?} rays, {kernel} on {}", backend.name());
                }
            }
        }
    });
}

#[test]
fn a_measurement_says_what_the_structure_takes() {
    let scene = canon("cornell.xml", &[]);
    with_gpu(|gpu| {
        let backends = backends(gpu);
        let kinds = make(gpu, &scene, &rays::settings(&scene, Backend::Bvh, (32, 32)).unwrap()).unwrap();
        let found = measure(gpu, &scene, &backends, (32, 32), &kinds, 2).unwrap();
        assert_eq!((found.schema, found.primitives), ("lumbre-rays-2", scene.primitives.len()));
        assert_eq!((found.structures.len(), found.throughput.len()), (backends.len(), 3 * backends.len()));
        for (backend, structure) in backends.iter().zip(&found.structures) {
            assert_eq!(structure.backend, backend.name());
            assert!(structure.build_seconds > 0.0 && structure.build_seconds < 10.0);
            assert_eq!(structure.bytes_per_primitive, structure.bytes as f64 / scene.primitives.len() as f64);
            match backend {
                Backend::Bvh => {
                    let nodes = tree_of(&scene).nodes.len();
                    assert_eq!(structure.bytes, nodes as u64 * u64::from(NODE_BYTES));
                    assert_eq!(structure.compiled_in, scene.primitives.len());
                }
                Backend::RayQuery => assert!(structure.bytes > 0 && structure.compiled_in == 0),
            }
        }
        for row in &found.throughput {
            assert_eq!((row.runs.len(), row.shuffled_runs.len()), (2, 2));
            assert!(row.mrays_per_s > 0.0 && row.shuffled_mrays_per_s > 0.0 && (0.05..=1.0).contains(&row.hit));
            let counted = row.tested.map(|tested| (tested.nodes.mean, tested.primitives.mean, tested.primitives.p99));
            let all = scene.primitives.len();
            let expected = (row.backend == "bvh").then_some((0.0, all as f64, all as u32));
            assert_eq!(counted, expected, "{} {:?}", row.backend, row.kind);
        }
        let file = tempfile::NamedTempFile::new().unwrap();
        export(&scene, &kinds, file.path()).unwrap();
        let bytes = std::fs::read(file.path()).unwrap();
        let head = "lumbre-rays-1\ntriangles 38\nprimary 1024 closest\nshadow ";
        assert!(bytes.starts_with(head.as_bytes()));
        let body = bytes.windows(5).position(|window| window == b"\nend\n").unwrap() + 5;
        let rays: usize = kinds.iter().map(|(_, rays)| rays.len()).sum();
        assert_eq!(bytes.len() - body, 36 * scene.primitives.len() + 28 * rays);
        let first: [f32; 3] = bytemuck::pod_read_unaligned(&bytes[body..body + 12]);
        assert_eq!(first, scene.primitives[0].v0);
        let spheres = canon("cornell_spheres.xml", &[]);
        let refused = export(&spheres, &kinds, file.path()).unwrap_err().to_string();
        assert!(refused.contains("this one has spheres"), "{refused}");
        let text = serde_json::to_value(&found).unwrap();
        assert_eq!(text["throughput"][0]["kind"], "primary");
        assert!(text["throughput"][0]["shuffled_runs"].is_array());
    });
}
