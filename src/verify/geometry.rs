//! Random numbers of the host, and shapes that rows put into scenes.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3};

use crate::error::Result;
use crate::scene::{Camera, Mesh, SceneBuilder, SurfaceDescription, material};

/// A small generator of reproducible numbers (Steele, Lea and Flood 2014, SplitMix64).
pub(super) struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// An index below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    /// In the cube of this half side around the origin.
    pub fn in_cube(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5) * 2.0 * half
    }

    /// A direction, any as likely as any other.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube(1.0);
            if (1e-3..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}

/// An icosahedron, each face cut into four `levels` times, on a sphere of radius 1.
pub(super) fn icosphere(levels: u32) -> Mesh {
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

/// The cube from (-1, -1, -1) to (1, 1, 1) with shared vertices, facing outwards.
pub(super) fn closed_cube() -> Mesh {
    let side = |corner: u32, bit: u32| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let positions = (0..8).map(|corner| DVec3::new(side(corner, 2), side(corner, 1), side(corner, 0))).collect();
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A mesh with its inside out.
pub(super) fn inside_out(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    mesh
}

/// A surface whose front is matte and emits; its back is black.
pub(super) fn glowing(builder: &mut SceneBuilder, albedo: [f32; 3], emission: [f64; 3]) -> usize {
    let front = Some(builder.material(material::diffuse(albedo)));
    builder.surface(SurfaceDescription { front, emission, ..SurfaceDescription::default() })
}

/// A surface whose front emits and is black.
pub(super) fn lamp(builder: &mut SceneBuilder, emission: [f64; 3]) -> usize {
    builder.surface(SurfaceDescription { emission, ..SurfaceDescription::default() })
}

/// A polygon whose front faces the origin, as a fan.
pub(super) fn polygon(builder: &mut SceneBuilder, corners: &[DVec3], surface: usize) {
    let mut triangles: Vec<_> = (1..corners.len() as u32 - 1).map(|index| [0, index, index + 1]).collect();
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if normal.dot(corners[0]) > 0.0 {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    let mesh = Mesh { positions: corners.to_vec(), triangles, ..Mesh::default() };
    builder.mesh(0, "polygon", mesh, DAffine3::IDENTITY, surface);
}

/// Sets the image's size and the only camera.
pub(super) fn look(builder: &mut SceneBuilder, size: u32, from: DVec3, at: DVec3, fov: f64) -> Result<()> {
    (builder.film.width, builder.film.height) = (size, size);
    let up = if (at - from).normalize().y.abs() > 0.99 { DVec3::Z } else { DVec3::Y };
    builder.cameras.push(Camera::look_at(from, at, up, fov)?);
    Ok(())
}
