//! A brute force in double precision, and how answers of a backend are held against it.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::geometry::{Random, icosphere};
use crate::error::Result;
use crate::layout::{HitRecord, Primitive, RayRecord, SPHERE_BIT};
use crate::scene::{Mesh, Scene, SceneBuilder};

/// Instances (turned, mirrored, sheared), spheres, slivers, quads along the axes, and a mesh with shared edges.
pub(super) fn scene() -> Result<Scene> {
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
    builder.finish()
}

/// Random rays, and rays aimed at what is hard: vertices, edges, the axes.
pub(super) fn rays(scene: &Scene, count: usize) -> Vec<RayRecord> {
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

fn vector(v: [f32; 3]) -> DVec3 {
    glam::Vec3::from(v).as_dvec3()
}

/// Centre and radius of a sphere around each primitive.
pub(super) fn around(scene: &Scene) -> Vec<(DVec3, f64)> {
    let of = |primitive: &Primitive| {
        let [v0, v1, v2] = [primitive.v0, primitive.v1, primitive.v2].map(vector);
        if primitive.surface & SPHERE_BIT != 0 {
            return (v0, f64::from(primitive.v1[0].abs()));
        }
        let centre = (v0 + v1 + v2) / 3.0;
        (centre, [v0, v1, v2].iter().map(|v| v.distance(centre)).fold(0.0, f64::max))
    };
    scene.primitives.iter().map(of).collect()
}

/// All primitives that a ray may hit.
fn candidates(scene: &Scene, around: &[(DVec3, f64)], ray: &RayRecord) -> Vec<Candidate> {
    let mut found = Vec::new();
    for (instance, placed) in scene.instances.iter().enumerate() {
        let to_object = placed.to_world.inverse();
        let (origin, direction) =
            (to_object.transform_point3(vector(ray.origin)), to_object.transform_vector3(vector(ray.direction)));
        let length = direction.length();
        let unit = direction / length;
        let size = origin.abs().max_element() + 9.0;
        let epsilon = TOLERANCE * size;
        for slot in scene.groups[placed.group].primitives() {
            // What passes outside of the sphere around a primitive, tolerance and more besides, misses it for certain.
            let (centre, radius) = around[slot];
            let to_centre = centre - origin;
            let off2 = to_centre.length_squared() - to_centre.dot(unit).powi(2);
            if off2 > (radius + 3.0 * epsilon).powi(2) {
                continue;
            }
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
pub(super) struct Tally {
    pub same: usize,
    pub misses: usize,
    pub ties: usize,
    pub near_outline: usize,
    pub wrong: Vec<String>,
}

impl Tally {
    pub fn add(mut self, other: Self) -> Self {
        self.same += other.same;
        self.misses += other.misses;
        self.ties += other.ties;
        self.near_outline += other.near_outline;
        self.wrong.extend(other.wrong);
        self
    }
}

/// Holds one answer against the brute force.
pub(super) fn judge(
    (scene, around): (&Scene, &[(DVec3, f64)]),
    ray: &RayRecord,
    hit: &HitRecord,
    primitive: u32,
    instance: u32,
    tally: &mut Tally,
) {
    let all = candidates(scene, around, ray);
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
