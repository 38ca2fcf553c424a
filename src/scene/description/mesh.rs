//! Triangles with shared vertices, and the solids that scene formats know by name.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};

use crate::error::{Error, Result};

/// Segments that stand for a full turn of a disk or a cylinder.
const SEGMENTS: u32 = 256;

/// Values at the vertices, or of the triangles, of a mesh that a texture may show.
#[derive(Clone, Debug)]
pub struct Attribute {
    /// What textures ask for.
    pub name: String,
    /// One value per vertex or triangle: red, green, blue and alpha, or one number in the first three.
    pub values: Vec<Vec4>,
}

/// Triangles with shared vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// One normal per vertex, or none at all.
    pub normals: Vec<Vec3>,
    /// One texture coordinate per vertex, or none at all: then a triangle's barycentric weights stand in. As in Mitsuba,
    /// (0, 0) is the first texel of the first row of an image, its upper left corner.
    pub uvs: Vec<Vec2>,
    /// A second set of them, for textures that say so: one per vertex, or none at all, which is all 0.
    pub second_uvs: Vec<Vec2>,
    /// One tangent per vertex, with the sign of the bitangent; or none at all: normal maps then go by the texture coordinates.
    pub tangents: Vec<Vec4>,
    /// One colour per vertex, linear red, green, blue and alpha, or none at all.
    pub colours: Vec<Vec4>,
    /// What else it has at its vertices, for textures to show.
    pub attributes: Vec<Attribute>,
    /// What else its triangles have, one value per triangle; the builder makes attributes of vertices of them.
    pub face_attributes: Vec<Attribute>,
    /// Three vertex indices per triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The square from (-1, -1, 0) to (1, 1, 0), facing +z; texture coordinates from (0, 0) to (1, 1).
    pub fn rectangle() -> Self {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        Self {
            positions: corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
            uvs: corners.map(|(x, y)| Vec2::new(0.5 * (x as f32 + 1.0), 0.5 * (y as f32 + 1.0))).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Self::default()
        }
    }

    /// The cube from (-1, -1, -1) to (1, 1, 1), facing outwards; each face has texture coordinates from (0, 0) to (1, 1).
    pub fn cube() -> Self {
        let mut mesh = Self::default();
        // Along u and v on each face, as Mitsuba has them; v x u is the normal.
        let faces = [
            (DVec3::Y, DVec3::NEG_Z),
            (DVec3::NEG_X, DVec3::NEG_Z),
            (DVec3::Y, DVec3::X),
            (DVec3::Y, DVec3::Z),
            (DVec3::Z, DVec3::X),
            (DVec3::NEG_Y, DVec3::X),
        ];
        for (u, v) in faces {
            let first = mesh.positions.len() as u32;
            let corner = |a: f64, b: f64| v.cross(u) + a * u + b * v;
            mesh.positions.extend([corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)]);
            mesh.uvs.extend([Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X]);
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        mesh
    }

    /// The disk of radius 1 around the origin, facing +z; texture coordinates are the distance from the centre and the angle
    /// from the x axis in turns. It is a polygon of the same area, so that as a light it has the same power; its rim is within
    /// 6e-5 of the circle.
    pub fn disk() -> Self {
        let mut mesh = Self::default();
        let turn = TAU / f64::from(SEGMENTS);
        let radius = (turn / turn.sin()).sqrt();
        for segment in 0..=SEGMENTS {
            let share = f64::from(segment) / f64::from(SEGMENTS);
            // The angle is undefined at the centre: each triangle has a centre of its own, with the angle of its middle.
            mesh.positions.extend([circle(segment, radius), DVec3::ZERO]);
            mesh.uvs.extend([Vec2::new(1.0, share as f32), Vec2::new(0.0, (share + 0.5 * turn / TAU) as f32)]);
        }
        mesh.triangles = (0..SEGMENTS).map(|segment| [2 * segment, 2 * segment + 2, 2 * segment + 1]).collect();
        mesh
    }

    /// The cylinder of radius 1 around the z axis from z = 0 to z = 1, without caps, facing outwards; texture coordinates are
    /// the angle from the x axis in turns and the height. It is a prism of the same area with the cylinder's normals; it is
    /// within 6e-5 of the cylinder.
    pub fn cylinder() -> Self {
        let mut mesh = Self::default();
        let half_turn = PI / f64::from(SEGMENTS);
        let radius = half_turn / half_turn.sin();
        for segment in 0..=SEGMENTS {
            let share = segment as f32 / SEGMENTS as f32;
            let foot = circle(segment, radius);
            mesh.positions.extend([foot, foot + DVec3::Z]);
            mesh.normals.extend([circle(segment, 1.0).as_vec3(); 2]);
            mesh.uvs.extend([Vec2::new(share, 0.0), Vec2::new(share, 1.0)]);
        }
        mesh.triangles = (0..2 * SEGMENTS)
            .step_by(2)
            .flat_map(|first| [[first, first + 2, first + 3], [first, first + 3, first + 1]])
            .collect();
        mesh
    }

    /// The mesh with its front on the other side, where `turned` says so.
    #[must_use]
    pub fn turned(mut self, turned: bool) -> Self {
        if turned {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            self.normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
        self
    }

    /// Fails where a triangle refers to a vertex that does not exist; `path` is the file that the mesh came from.
    pub(in crate::scene) fn check_indices(&self, path: &Path) -> Result<()> {
        let count = self.positions.len();
        for (index, triangle) in self.triangles.iter().enumerate() {
            if let Some(bad) = triangle.iter().find(|vertex| **vertex as usize >= count) {
                return Err(Error::scene(
                    path,
                    format!(
                        "triangle {index} refers to vertex {bad}, and there are {count} vertices (0 to {})",
                        count.saturating_sub(1)
                    ),
                ));
            }
        }
        Ok(())
    }

    /// Turns textures upside down, where `flipped` says so: for files whose v runs from the last row of an image to the first.
    #[must_use]
    pub fn with_flipped_v(mut self, flipped: bool) -> Self {
        if flipped {
            self.uvs.iter_mut().for_each(|uv| uv.y = 1.0 - uv.y);
        }
        self
    }

    /// The mesh with vertices that no two triangles share, where something differs from triangle to triangle.
    #[must_use]
    pub(super) fn split(self) -> Self {
        if self.face_attributes.is_empty() {
            return self;
        }
        fn of<T: Copy>(values: &[T], corners: &[u32]) -> Vec<T> {
            corners.iter().filter_map(|corner| values.get(*corner as usize).copied()).collect()
        }
        let corners = self.triangles.as_flattened();
        let of_vertices =
            self.attributes.iter().map(|own| Attribute { name: own.name.clone(), values: of(&own.values, corners) });
        let of_faces = self.face_attributes.iter().map(|own| Attribute {
            name: own.name.clone(),
            values: own.values.iter().flat_map(|value| [*value; 3]).collect(),
        });
        Self {
            positions: of(&self.positions, corners),
            normals: of(&self.normals, corners),
            uvs: of(&self.uvs, corners),
            second_uvs: of(&self.second_uvs, corners),
            tangents: of(&self.tangents, corners),
            colours: of(&self.colours, corners),
            attributes: of_vertices.chain(of_faces).collect(),
            face_attributes: Vec::new(),
            triangles: (0..self.triangles.len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect(),
        }
    }

    /// Vertex normals: the faces' normals weighted by the angle that they have at the vertex (Thuermer and Wuethrich 1998).
    pub fn compute_normals(&mut self) {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let corners = triangle.map(|vertex| self.positions.get(vertex as usize).copied());
            let [Some(a), Some(b), Some(c)] = corners else { continue }; // the builder reports it
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            for (index, (p, q, r)) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
                let angle = (q - p).angle_between(r - p);
                if angle.is_finite() {
                    sums[triangle[index] as usize] += angle * normal;
                }
            }
        }
        self.normals =
            sums.into_iter().map(|sum| sum.try_normalize().unwrap_or(DVec3::X).as_vec3()).collect::<Vec<Vec3>>();
    }

    /// Moves every vertex.
    pub fn transform(&mut self, map: DAffine3) {
        self.positions.iter_mut().for_each(|position| *position = map.transform_point3(*position));
    }
}

/// The point of the circle in the xy plane after so many segments.
fn circle(segment: u32, radius: f64) -> DVec3 {
    // The last point is the first one, to the bit.
    let (sin, cos) = (TAU * f64::from(segment % SEGMENTS) / f64::from(SEGMENTS)).sin_cos();
    radius * DVec3::new(cos, sin, 0.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn area_vector(mesh: &Mesh, triangle: &[u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        (b - a).cross(c - a) / 2.0
    }

    #[test]
    fn round_solids_have_their_area_and_face_outwards() {
        for (mesh, expected) in [(Mesh::disk(), PI), (Mesh::cylinder(), TAU)] {
            let area: f64 = mesh.triangles.iter().map(|triangle| area_vector(&mesh, triangle).length()).sum();
            assert!((area / expected - 1.0).abs() < 1e-12, "{area} against {expected}");
            let reach = mesh.positions.iter().map(|position| position.truncate().length()).fold(0.0, f64::max);
            assert!((reach - 1.0).abs() < 6e-5, "{reach}");
            for triangle in &mesh.triangles {
                let middle = triangle.iter().map(|vertex| mesh.positions[*vertex as usize]).sum::<DVec3>() / 3.0;
                let outwards = if mesh.normals.is_empty() { DVec3::Z } else { middle.with_z(0.0) };
                assert!(area_vector(&mesh, triangle).dot(outwards) > 0.0);
            }
        }
        let cylinder = Mesh::cylinder();
        assert_eq!(cylinder.positions[0], cylinder.positions[2 * SEGMENTS as usize], "the seam is closed");
        for (position, normal) in cylinder.positions.iter().zip(&cylinder.normals) {
            assert!((position.with_z(0.0).as_vec3() - *normal).length() < 6e-5);
        }
    }

    /// The texture coordinates where a ray along -z (disk) or towards the axis (cylinder) meets the mesh.
    fn uv_at(mesh: &Mesh, origin: DVec3, direction: DVec3) -> Vec2 {
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            let normal = (b - a).cross(c - a);
            let distance = (a - origin).dot(normal) / direction.dot(normal);
            let point = origin + distance * direction;
            let weights =
                [(b, c), (c, a), (a, b)].map(|(p, q)| (q - p).cross(point - p).dot(normal) / normal.length_squared());
            if direction.dot(normal) < 0.0 && distance > 0.0 && weights.iter().all(|weight| *weight >= -1e-12) {
                return (0..3).map(|corner| weights[corner] as f32 * mesh.uvs[triangle[corner] as usize]).sum();
            }
        }
        Vec2::NAN
    }

    /// Texture coordinates that Mitsuba 3.9 reports for the same rays.
    #[test]
    fn texture_coordinates_are_those_of_mitsuba() {
        let disk = Mesh::disk();
        for (x, y, expected) in
            [(0.3, 0.4, [0.5, 0.147584]), (0.3, -0.4, [0.5, 0.852416]), (-0.3, -0.4, [0.5, 0.647584])]
        {
            let found = uv_at(&disk, DVec3::new(x, y, 5.0), DVec3::NEG_Z);
            // The angle is constant across half a segment at the centre, and is interpolated from there to the rim.
            assert!((found - Vec2::from(expected)).abs().cmple(Vec2::new(1e-4, 2e-3)).all(), "({x}, {y}): {found}");
        }
        let cylinder = Mesh::cylinder();
        for (angle, expected) in [(30.0f64, 0.083333), (300.0, 0.833333), (179.0, 0.497222)] {
            let out = DVec3::new(angle.to_radians().cos(), angle.to_radians().sin(), 0.0);
            let found = uv_at(&cylinder, 5.0 * out + 0.3 * DVec3::Z, -out);
            assert!((found - Vec2::new(expected, 0.3)).abs().max_element() < 1e-5, "{angle} degrees: {found}");
        }
        // One corner and its neighbour along u for each of Mitsuba's faces, +x, +y, +z, -x, -y and -z.
        let cube = Mesh::cube();
        let edges = [
            ([1.0, -1.0, 1.0], [1.0, 1.0, 1.0]),
            ([1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]),
            ([-1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]),
            ([-1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]),
            ([-1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]),
            ([-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]),
        ];
        for (face, (origin, along_u)) in edges.into_iter().enumerate() {
            let corner = |uv: Vec2| (4 * face..4 * face + 4).find(|vertex| cube.uvs[*vertex] == uv).unwrap();
            assert_eq!(cube.positions[corner(Vec2::ZERO)].to_array(), origin, "face {face}");
            assert_eq!(cube.positions[corner(Vec2::X)].to_array(), along_u, "face {face}");
            let triangle = &cube.triangles[2 * face];
            let middle = (cube.positions[corner(Vec2::ZERO)] + cube.positions[corner(Vec2::ONE)]) / 2.0;
            assert!(area_vector(&cube, triangle).dot(middle) > 0.0, "face {face} faces outwards");
        }
        let flipped = Mesh::cylinder().with_flipped_v(true);
        assert_eq!((flipped.uvs[0], flipped.uvs[1]), (Vec2::new(0.0, 1.0), Vec2::ZERO));
        assert_eq!(Mesh::cylinder().with_flipped_v(false).uvs, cylinder.uvs);
    }
}
