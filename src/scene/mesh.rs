//! Triangles with shared vertices, and the solids that scene formats know by name.

use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};

/// Triangles with shared vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// One normal per vertex, or none at all.
    pub normals: Vec<Vec3>,
    /// One texture coordinate per vertex, or none at all: then a triangle's barycentric weights stand in.
    pub uvs: Vec<Vec2>,
    /// One tangent per vertex, with the sign of the bitangent; or none at all: normal maps then go by the texture coordinates.
    pub tangents: Vec<Vec4>,
    /// One colour per vertex, linear red, green, blue and alpha, or none at all.
    pub colours: Vec<Vec4>,
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
        let faces = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
        for normal in faces {
            // Two more axes that make a right-handed frame with the normal, so that the face is counter-clockwise from outside.
            let tangent = DVec3::new(normal.z, normal.x, normal.y);
            let bitangent = normal.cross(tangent);
            let first = mesh.positions.len() as u32;
            let corner = |a: f64, b: f64| normal + a * tangent + b * bitangent;
            mesh.positions.extend([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
            mesh.uvs.extend([Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]);
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
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
