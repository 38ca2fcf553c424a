//! The vertices where patches meet, and how their values follow from those of the patches.
//!
//! A vertex among patches has their mean. At the rim of a surface it lies outside of all their middles: there a plane through the values
//! of more patches is laid by weighted least squares, so that what is linear on a surface is shown as it is, up to its rim.

use std::collections::HashMap;

use glam::{DMat3, DVec2, DVec3};

use super::faces::{Face, Point, corners, middle};
use super::hanging;
use super::mesh::PatchMesh;
use crate::layout::NONE;

/// Positions that are the same but for rounding, as a share of the largest coordinate.
const SAME: f64 = 1e-7;
/// Cosine between normals of surfaces that are one at a vertex.
const SMOOTH: f64 = 0.999;
/// How far the mean of the middles may lie off a vertex that is among them, as a share of their distance.
const AMONG: f64 = 0.05;
/// Weight of a plane's slope being zero, where the patches do not say.
const RIDGE: f64 = 1e-6;
/// Weights below this share are left out.
const LEAST: f64 = 1e-4;

/// The vertices while they are found: by place, then by normal and side.
#[derive(Default)]
struct Welded {
    by_place: HashMap<[i64; 3], u32>,
    points: Vec<Point>,
    next: Vec<u32>,
}

impl Welded {
    fn vertex(&mut self, point: Point, quantum: f64) -> u32 {
        let place = (point.position / quantum).round().as_i64vec3().to_array();
        let first = self.by_place.get(&place).copied();
        let mut at = first.unwrap_or(NONE);
        while at != NONE {
            if self.points[at as usize].normal.dot(point.normal) >= SMOOTH {
                return at;
            }
            at = self.next[at as usize];
        }
        let index = self.points.len() as u32;
        self.points.push(point);
        self.next.push(first.unwrap_or(NONE));
        self.by_place.insert(place, index);
        index
    }
}

/// Finds the vertices of a mesh of patches, and their terms.
pub(super) fn join(mesh: &mut PatchMesh, faces: &[Face]) {
    let mut welded = Welded::default();
    let reach = |face: &Face| face.point(DVec2::splat(0.5)).position.abs().max_element() + face.longest();
    let quantum = SAME * faces.iter().map(reach).fold(f64::MIN_POSITIVE, f64::max);
    let mut middles = Vec::with_capacity(mesh.patches.len());
    for patch in &mesh.patches {
        let face = &faces[patch.face as usize];
        let [corner, extent] = [patch.corner, patch.extent].map(|v| glam::Vec2::from(v).as_dvec2());
        let turned = if patch.back != 0 { -1.0 } else { 1.0 };
        let mut own = [NONE; 4];
        for (slot, c) in own.iter_mut().zip(corners(&face.shape, corner, extent)) {
            let Point { position, normal } = face.point(snapped(c, face));
            *slot = welded.vertex(Point { position, normal: turned * normal }, quantum);
        }
        mesh.corners.push(own);
        middles.push(face.point(middle(&face.shape, corner, extent)).position);
    }
    let around = around(&mesh.corners, welded.points.len());
    mesh.term_first.push(0);
    let mut ring = Vec::new();
    for (vertex, point) in welded.points.iter().enumerate() {
        ring.clear();
        ring.extend_from_slice(around.of(vertex));
        if !is_among(point, &ring, &middles) {
            let corners = ring.iter().flat_map(|patch| mesh.corners[*patch as usize]).filter(|corner| *corner != NONE);
            let wider: Vec<u32> = corners.flat_map(|corner| around.of(corner as usize).iter().copied()).collect();
            ring.extend(wider);
            ring.sort_unstable();
            ring.dedup();
        }
        let near = around.of(vertex).iter().map(|patch| middles[*patch as usize].distance_squared(point.position));
        let scale = near.fold(0.0, f64::max);
        let areas: Vec<f64> = ring.iter().map(|patch| f64::from(mesh.patches[*patch as usize].area)).collect();
        for (patch, weight) in ring.iter().zip(weights(point, &ring, &areas, &middles, scale)) {
            if weight != 0.0 {
                mesh.terms.push([*patch, (weight as f32).to_bits()]);
            }
        }
        mesh.term_first.push(mesh.terms.len() as u32);
    }
    hanging::anchor(mesh, faces);
}

/// Coordinates in single precision back on the grid that they came from, so that neighbours agree on their corners.
fn snapped(c: DVec2, face: &Face) -> DVec2 {
    let cells = DVec2::new(f64::from(face.across), f64::from(face.down));
    (c * cells).round() / cells
}

/// The patches around each vertex.
struct Around {
    first: Vec<u32>,
    patches: Vec<u32>,
}

impl Around {
    fn of(&self, vertex: usize) -> &[u32] {
        &self.patches[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }
}

fn around(corners: &[[u32; 4]], vertices: usize) -> Around {
    let pairs = || {
        let of_patch = |(patch, own): (usize, &[u32; 4])| own.map(|corner| (corner, patch as u32));
        corners.iter().enumerate().flat_map(of_patch).filter(|(corner, _)| *corner != NONE)
    };
    let mut first = vec![0u32; vertices + 1];
    pairs().for_each(|(corner, _)| first[corner as usize + 1] += 1);
    for vertex in 0..vertices {
        first[vertex + 1] += first[vertex];
    }
    let mut next = first.clone();
    let mut patches = vec![0; first[vertices] as usize];
    for (corner, patch) in pairs() {
        patches[next[corner as usize] as usize] = patch;
        next[corner as usize] += 1;
    }
    // At a pole two corners of a patch are the same vertex.
    let mut unique = Around { first: vec![0], patches: Vec::with_capacity(patches.len()) };
    for vertex in 0..vertices {
        let own = &mut patches[first[vertex] as usize..first[vertex + 1] as usize];
        own.sort_unstable();
        unique
            .patches
            .extend(own.iter().enumerate().filter(|(at, patch)| *at == 0 || own[at - 1] != **patch).map(|p| *p.1));
        unique.first.push(unique.patches.len() as u32);
    }
    unique
}

/// Whether a vertex lies in the midst of these patches.
fn is_among(point: &Point, patches: &[u32], middles: &[DVec3]) -> bool {
    let offsets = || patches.iter().map(|patch| flattened(point, middles[*patch as usize]));
    let count = patches.len() as f64;
    let mean = offsets().sum::<DVec2>() / count;
    let distance = offsets().map(DVec2::length).sum::<f64>() / count;
    mean.length() <= AMONG * distance
}

/// A place relative to a point, in the plane of its surface.
fn flattened(point: &Point, position: DVec3) -> DVec2 {
    let (x, y) = point.normal.any_orthonormal_pair();
    let off = position - point.position;
    DVec2::new(off.dot(x), off.dot(y))
}

/// Weights of patches, whose sum is one, for the value at a vertex: the plane of least squares, weighted by area and distance.
fn weights(point: &Point, patches: &[u32], areas: &[f64], middles: &[DVec3], scale: f64) -> Vec<f64> {
    let largest = areas.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let unit = scale.sqrt().max(f64::MIN_POSITIVE);
    let rows: Vec<(f64, DVec3)> = patches
        .iter()
        .zip(areas)
        .map(|(patch, area)| {
            let off = flattened(point, middles[*patch as usize]) / unit;
            (area / largest * (-off.length_squared()).exp(), DVec3::new(1.0, off.x, off.y))
        })
        .collect();
    let mut sum = DMat3::ZERO;
    for (weight, row) in &rows {
        sum += DMat3::from_cols(*row * row.x, *row * row.y, *row * row.z) * *weight;
    }
    let ridge = RIDGE * sum.x_axis.x;
    sum.y_axis.y += ridge;
    sum.z_axis.z += ridge;
    let first = sum.inverse().x_axis;
    let raw: Vec<f64> = rows.iter().map(|(weight, row)| weight * first.dot(*row)).collect();
    let kept = |weight: &f64| if weight.abs() < LEAST { 0.0 } else { *weight };
    let total: f64 = raw.iter().map(kept).sum();
    raw.iter().map(|weight| kept(weight) / total).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::Quartered;
    use super::*;
    use crate::scene::{Camera, Mesh, SceneBuilder};
    use glam::DAffine3;

    /// What is linear over a surface is shown as it is, also at its rim; a vertex among four patches has their mean.
    #[test]
    fn planes_are_kept() {
        let triangle = Mesh {
            positions: vec![DVec3::ZERO, DVec3::new(3.0, 0.5, 0.0), DVec3::new(0.2, 2.0, 1.0)],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let mut builder = SceneBuilder::new("vertices");
        let surface = builder.matte([0.5; 3]);
        builder.mesh(0, "cube", Mesh::cube(), DAffine3::IDENTITY, surface);
        builder.mesh(0, "triangle", triangle, DAffine3::from_translation(DVec3::Z * 3.0), surface);
        builder.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 40.0).unwrap());
        let scene = builder.finish().unwrap();
        let mesh = PatchMesh::new(&scene, 5.0, 0, &Quartered::All).unwrap();
        let mut shapes = super::super::faces::faces(&scene);
        let longest = shapes.iter().map(Face::longest).fold(0.0, f64::max);
        shapes.iter_mut().for_each(|face| face.divide(longest / 5.0, 0));
        let field = |position: DVec3| 3.0 + position.dot(DVec3::new(0.3, -0.7, 0.4));
        for (index, patch) in mesh.patches.iter().enumerate() {
            let face = &shapes[patch.face as usize];
            let [corner, extent] = [patch.corner, patch.extent].map(|v| glam::Vec2::from(v).as_dvec2());
            for (vertex, c) in mesh.corners[index].iter().zip(corners(&face.shape, corner, extent)) {
                let range = mesh.term_first[*vertex as usize] as usize..mesh.term_first[*vertex as usize + 1] as usize;
                let value: f64 = mesh.terms[range.clone()]
                    .iter()
                    .map(|[patch, weight]| {
                        let of = &mesh.patches[*patch as usize];
                        let [corner, extent] = [of.corner, of.extent].map(|v| glam::Vec2::from(v).as_dvec2());
                        let face = &shapes[of.face as usize];
                        f64::from(f32::from_bits(*weight))
                            * field(face.point(middle(&face.shape, corner, extent)).position)
                    })
                    .sum();
                let expected = field(face.point(c).position);
                assert!((value - expected).abs() < 2e-3, "{value} against {expected}, {} terms", range.len());
            }
        }
        // Two sides of 6 faces of 4 x 4: a fifth of the triangle's longest edge goes 3.003 times into the cube's.
        let cube = mesh.patches.iter().filter(|patch| patch.face < 6).count();
        let quads = mesh.corners.iter().filter(|own| own[3] != NONE).count();
        assert_eq!((cube, quads), (2 * 6 * 16, 2 * 6 * 16));
    }
}
