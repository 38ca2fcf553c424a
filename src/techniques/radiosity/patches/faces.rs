//! Faces: triangles, parallelograms of two of them, spheres; and their division into cells.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};

use crate::layout::{NONE, Primitive, SMOOTH_BIT, SURFACE_MASK};
use crate::scene::{Group, Scene};

/// How far the fourth corner of a parallelogram may lie off, as a share of its longest edge.
const SKEW: f64 = 1e-4;

/// The shape of a face in the world. Its coordinates u and v run from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    /// `corner + u a + v b`, u + v <= 1; unit normals at corner, a and b where they are smooth.
    Triangle { corner: DVec3, a: DVec3, b: DVec3, normals: Option<[DVec3; 3]> },
    /// `corner + u a + v b`; unit normals, where they are smooth, at (0, 0), (1, 0), (0, 1), (1, 1).
    Parallelogram { corner: DVec3, a: DVec3, b: DVec3, normals: Option<[DVec3; 4]> },
    /// u is the azimuth in turns, v the height from pole to pole, of this map of the unit sphere; -1 faces inwards.
    Sphere { centre: DVec3, map: DMat3, outwards: f64 },
}

/// A patch of a face: a square or triangle of 2^level cells along an edge, the x-th and y-th of that size; a triangle may stand on its
/// head.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Node {
    /// How often it can be quartered.
    pub level: u32,
    /// Its place along the first edge ...
    pub x: u32,
    /// ... and the second one.
    pub y: u32,
    /// Whether it is a triangle that stands on its head.
    pub on_head: bool,
}

/// A surface that is divided into patches.
#[derive(Clone, Debug)]
pub(super) struct Face {
    pub shape: Shape,
    pub primitive: usize,
    pub second: Option<usize>,
    pub turn: u32,
    pub instance: usize,
    pub across: u32,
    pub down: u32,
    /// How often the largest patches may be quartered.
    pub levels: u32,
    /// Whether the front and the back have a material.
    pub sides: [bool; 2],
}

impl Face {
    /// Its longest edge; of a sphere the equator.
    pub fn longest(&self) -> f64 {
        let [across, down] = self.lengths();
        across.max(down)
    }

    fn lengths(&self) -> [f64; 2] {
        match self.shape {
            Shape::Triangle { a, b, .. } => [a.length().max(b.length()).max((b - a).length()); 2],
            Shape::Parallelogram { a, b, .. } => [a.length(), b.length()],
            Shape::Sphere { map, .. } => {
                let radius = map.x_axis.length().max(map.y_axis.length()).max(map.z_axis.length());
                [TAU * radius, PI * radius]
            }
        }
    }

    /// Divides it into cells that are no longer than `edge`, in blocks that can be quartered down to cells up to `levels` times.
    pub fn divide(&mut self, edge: f64, levels: u32) {
        // An edge that is so many cells long but for rounding has that many.
        let count = |length: f64| ((length / edge * (1.0 - 1e-6)).ceil() as u32).max(1);
        [self.across, self.down] = self.lengths().map(count);
        if let Shape::Sphere { .. } = self.shape {
            (self.across, self.down) = (self.across.max(4), self.down.max(2));
        }
        self.levels = levels.min(self.across.min(self.down).ilog2());
        let block = 1 << self.levels;
        (self.across, self.down) = (self.across.next_multiple_of(block), self.down.next_multiple_of(block));
    }

    /// Patches of all its sides.
    pub fn patches(&self) -> u64 {
        let sides = self.sides.iter().filter(|side| **side).count() as u64;
        u64::from(self.across) * u64::from(self.down) * sides
    }

    fn is_triangle(&self) -> bool {
        matches!(self.shape, Shape::Triangle { .. })
    }

    /// The largest patches that it may have.
    pub fn roots(&self) -> impl Iterator<Item = Node> {
        let (across, down) = (self.across >> self.levels, self.down >> self.levels);
        let (level, triangle) = (self.levels, self.is_triangle());
        let square = move |index: u32| (index % across, index / across);
        (0..across * down).map(square).map(move |(x, y)| {
            // Of a triangle, those on their heads take the places beyond the third edge.
            let on_head = triangle && x + y >= across;
            let (x, y) = if on_head { (across - 1 - x, across - 1 - y) } else { (x, y) };
            Node { level, x, y, on_head }
        })
    }

    /// The quarters of a node.
    pub fn quarters(&self, node: Node) -> [Node; 4] {
        let Node { level, x, y, on_head } = node;
        let child = |dx: u32, dy: u32, on_head: bool| Node { level: level - 1, x: 2 * x + dx, y: 2 * y + dy, on_head };
        match (self.is_triangle(), on_head) {
            (false, _) => [child(0, 0, false), child(1, 0, false), child(0, 1, false), child(1, 1, false)],
            (true, false) => [child(0, 0, false), child(1, 0, false), child(0, 1, false), child(0, 0, true)],
            (true, true) => [child(1, 1, true), child(1, 0, true), child(0, 1, true), child(1, 1, false)],
        }
    }

    /// Where a node begins, and how far it goes.
    pub fn extent(&self, node: Node) -> (DVec2, DVec2) {
        let size = f64::from(1 << node.level);
        let step = size / DVec2::new(f64::from(self.across), f64::from(self.down));
        let place = DVec2::new(f64::from(node.x), f64::from(node.y));
        if node.on_head { ((place + 1.0) * step, -step) } else { (place * step, step) }
    }

    /// The cells of a node, as the shader numbers them.
    pub fn cells(&self, node: Node) -> Vec<u32> {
        let size = 1 << node.level;
        let (left, top) = (node.x * size, node.y * size);
        let mut all = Vec::with_capacity((size * size) as usize);
        for (a, b) in (0..size).flat_map(|b| (0..size).map(move |a| (a, b))) {
            let (x, y) = (left + a, top + b);
            let upright = !self.is_triangle() || (a + b < size) != node.on_head;
            let turned = self.is_triangle() && (a + b + 1 < size) != node.on_head;
            if upright {
                all.push(y * self.across + x);
            }
            if turned {
                all.push((self.across - 1 - y) * self.across + self.across - 1 - x);
            }
        }
        all
    }

    /// Area of a part of it.
    pub fn area(&self, corner: DVec2, extent: DVec2) -> f64 {
        let square = (extent.x * extent.y).abs();
        match self.shape {
            Shape::Triangle { a, b, .. } => 0.5 * square * a.cross(b).length(),
            Shape::Parallelogram { a, b, .. } => square * a.cross(b).length(),
            Shape::Sphere { map, .. } => {
                // Equal steps in height are equal areas; a map that stretches the sphere does so by its value in the middle.
                let out = on_sphere(corner + 0.5 * extent);
                let stretch = (map.inverse().transpose() * out).length() * map.determinant().abs();
                4.0 * PI * square * stretch
            }
        }
    }

    /// The point at coordinates.
    pub fn point(&self, c: DVec2) -> Point {
        match self.shape {
            Shape::Triangle { corner, a, b, normals } => {
                let flat = a.cross(b).normalize_or_zero();
                let smooth = |n: [DVec3; 3]| (n[0] * (1.0 - c.x - c.y) + n[1] * c.x + n[2] * c.y).normalize_or(flat);
                Point { position: corner + c.x * a + c.y * b, normal: normals.map_or(flat, smooth) }
            }
            Shape::Parallelogram { corner, a, b, normals } => {
                let flat = a.cross(b).normalize_or_zero();
                let smooth = |n: [DVec3; 4]| n[0].lerp(n[1], c.x).lerp(n[2].lerp(n[3], c.x), c.y).normalize_or(flat);
                Point { position: corner + c.x * a + c.y * b, normal: normals.map_or(flat, smooth) }
            }
            Shape::Sphere { centre, map, outwards } => {
                let out = on_sphere(c);
                let normal = (map.inverse().transpose() * out).normalize_or_zero() * outwards;
                Point { position: centre + map * out, normal }
            }
        }
    }
}

/// The point of the unit sphere at azimuth and height.
fn on_sphere(c: DVec2) -> DVec3 {
    let z = 1.0 - 2.0 * c.y;
    // Both ends of a turn are the same point, to the bit.
    let (sin, cos) = if c.x >= 1.0 { (0.0, 1.0) } else { (TAU * c.x).sin_cos() };
    let radius = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

fn vector(v: [f32; 3]) -> DVec3 {
    Vec3::from(v).as_dvec3()
}

/// All faces with a material on some side.
pub(super) fn faces(scene: &Scene) -> Vec<Face> {
    let mut all = Vec::new();
    let partners: Vec<HashMap<usize, (usize, u32)>> = scene.groups.iter().map(|group| partners(scene, group)).collect();
    for (index, instance) in scene.instances.iter().enumerate() {
        for primitive in scene.groups[instance.group].primitives() {
            let surface = &scene.surfaces[(scene.primitives[primitive].surface & SURFACE_MASK) as usize];
            let sides = [surface.front, surface.back].map(|material| material != NONE);
            let pair = partners[instance.group].get(&primitive);
            if sides == [false; 2] || pair.is_some_and(|(second, _)| *second == primitive) {
                continue;
            }
            let second = pair.map(|(second, _)| *second);
            let turn = pair.map_or(0, |(_, turn)| *turn);
            let shape = shape(scene, primitive, second.map(|second| (second, turn)), &instance.to_world);
            all.push(Face { shape, primitive, second, turn, instance: index, across: 1, down: 1, levels: 0, sides });
        }
    }
    all
}

fn shape(scene: &Scene, primitive: usize, pair: Option<(usize, u32)>, to_world: &DAffine3) -> Shape {
    let p = &scene.primitives[primitive];
    if is_sphere(p) {
        let radius = f64::from(p.v1[0]);
        let map = to_world.matrix3 * radius.abs();
        return Shape::Sphere { centre: to_world.transform_point3(vector(p.v0)), map, outwards: radius.signum() };
    }
    let turn = pair.map_or(0, |(_, turn)| turn & 3) as usize;
    let corner =
        |p: &Primitive, turn: usize, k: usize| to_world.transform_point3(vector([p.v0, p.v1, p.v2][(turn + k) % 3]));
    let [first, along, up] = [0, 1, 2].map(|k| corner(p, turn, k));
    let (a, b) = (along - first, up - first);
    match pair {
        None => Shape::Triangle { corner: first, a, b, normals: normals(scene, primitive, 0, to_world) },
        Some((second, turns)) => {
            let other = normals(scene, second, (turns >> 2) as usize, to_world);
            let own = normals(scene, primitive, turn, to_world);
            let normals = own.zip(other).map(|(own, other)| [own[0], own[1], own[2], other[0]]);
            Shape::Parallelogram { corner: first, a, b, normals }
        }
    }
}

fn is_sphere(p: &Primitive) -> bool {
    p.surface & crate::layout::SPHERE_BIT != 0
}

/// The vertex normals of a triangle from one of its corners on, where it has any.
fn normals(scene: &Scene, primitive: usize, turn: usize, to_world: &DAffine3) -> Option<[DVec3; 3]> {
    if scene.primitives[primitive].surface & SMOOTH_BIT == 0 {
        return None;
    }
    let at = scene.corners.get(primitive)?;
    let map = to_world.matrix3.inverse().transpose();
    let normal = |index: u32| Some((map * vector(*scene.normals.get(index as usize)?)).normalize_or_zero());
    let all = [normal(at.i0)?, normal(at.i1)?, normal(at.i2)?];
    Some([0, 1, 2].map(|k| all[(turn + k) % 3]))
}

/// Triangles of a group that are parallelograms with another one: of the first, that one and the turns of both; of the second, itself.
/// They share their longest edge.
fn partners(scene: &Scene, group: &Group) -> HashMap<usize, (usize, u32)> {
    type Key = [u32; 6];
    let bits = |a: [f32; 3], b: [f32; 3]| -> Key {
        let [x, y, z] = a.map(f32::to_bits);
        let [u, v, w] = b.map(f32::to_bits);
        [x, y, z, u, v, w]
    };
    let mut waiting: HashMap<(Key, u32), (usize, u32)> = HashMap::new();
    let mut found = HashMap::new();
    for index in group.triangles.start as usize..group.triangles.end as usize {
        let p = &scene.primitives[index];
        let corners = [p.v0, p.v1, p.v2];
        let length = |turn: usize| vector(corners[(turn + 1) % 3]).distance_squared(vector(corners[(turn + 2) % 3]));
        // The corner that the longest edge lies opposite to.
        let turn = (0..3).fold(0, |best, turn| if length(turn) > length(best) { turn } else { best });
        let (apex, q, r) = (corners[turn], corners[(turn + 1) % 3], corners[(turn + 2) % 3]);
        if let Some((first, first_turn)) = waiting.remove(&(bits(r, q), p.surface)) {
            let other = &scene.primitives[first];
            let opposite = vector([other.v0, other.v1, other.v2][first_turn as usize]);
            let off = (vector(q) + vector(r) - opposite - vector(apex)).length();
            if off <= SKEW * length(turn).sqrt() {
                found.insert(first, (index, first_turn | (turn as u32) << 2));
                found.insert(index, (index, 0));
                continue;
            }
        }
        waiting.insert((bits(q, r), p.surface), (index, turn as u32));
    }
    found
}

/// The corners of a patch in the coordinates of its face; of a triangle three.
pub(super) fn corners(shape: &Shape, corner: DVec2, extent: DVec2) -> impl Iterator<Item = DVec2> {
    let all = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let count = if matches!(shape, Shape::Triangle { .. }) { 3 } else { 4 };
    all.into_iter().take(count).map(move |(u, v)| corner + extent * DVec2::new(u, v))
}

/// The middle of a patch in the coordinates of its face.
pub(super) fn middle(shape: &Shape, corner: DVec2, extent: DVec2) -> DVec2 {
    corner + extent * if matches!(shape, Shape::Triangle { .. }) { 1.0 / 3.0 } else { 0.5 }
}

/// A point of a surface and its unit normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub position: DVec3,
    pub normal: DVec3,
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::scene::{Camera, Mesh, SceneBuilder};

    fn scene(add: impl FnOnce(&mut SceneBuilder, usize)) -> Scene {
        let mut builder = SceneBuilder::new("faces");
        let surface = builder.matte([0.5; 3]);
        add(&mut builder, surface);
        builder.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 40.0).unwrap());
        builder.finish().unwrap()
    }

    /// Whatever the shape, patches fill it, and so do their quarters' cells, each of which belongs to one.
    #[test]
    fn cells_fill_their_face() {
        let skew = Mesh {
            positions: vec![DVec3::ZERO, DVec3::new(3.0, 0.5, 0.0), DVec3::new(0.2, 2.0, 1.0)],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = scene(|builder, surface| {
            builder.mesh(0, "cube", Mesh::cube(), DAffine3::IDENTITY, surface);
            builder.mesh(0, "triangle", skew, DAffine3::from_translation(DVec3::Z * 3.0), surface);
            builder.sphere(0, "sphere", DVec3::Y * 4.0, 0.7, surface);
        });
        let mut all = faces(&scene);
        assert_eq!(all.len(), 6 + 1 + 1, "a cube has six parallelograms");
        for face in &mut all {
            face.divide(0.3, 0);
            let whole = match face.shape {
                Shape::Triangle { a, b, .. } => 0.5 * a.cross(b).length(),
                Shape::Parallelogram { .. } => 4.0,
                Shape::Sphere { .. } => 4.0 * PI * 0.49,
            };
            let cells = face.roots().map(|node| face.extent(node));
            let area: f64 = cells.map(|(corner, extent)| face.area(corner, extent)).sum();
            assert!((area / whole - 1.0).abs() < 1e-6, "{:?}: {area} against {whole}", face.shape);
            face.divide(0.3, 2);
            assert_eq!(face.levels, 2);
            let mut nodes: Vec<Node> = face.roots().collect();
            // The first and the last root, of which one stands on its head where it is a triangle.
            for root in [nodes.remove(0), nodes.remove(nodes.len() - 1)] {
                let quarters = face.quarters(root);
                nodes.extend(&quarters[..3]);
                nodes.extend(face.quarters(quarters[3]));
            }
            let area: f64 =
                nodes.iter().map(|node| face.extent(*node)).map(|(corner, extent)| face.area(corner, extent)).sum();
            assert!((area / whole - 1.0).abs() < 1e-6, "{:?}, quartered: {area} against {whole}", face.shape);
            let mut cells: Vec<u32> = nodes.iter().flat_map(|node| face.cells(*node)).collect();
            cells.sort_unstable();
            assert!(cells.iter().copied().eq(0..face.across * face.down), "{:?}", face.shape);
        }
    }
}
