//! Tangents where a file has none, by MikkTSpace (Mikkelsen 2008), which glTF prescribes.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use crate::scene::Mesh;

/// The corners of a mesh's triangles, each with a tangent of its own.
struct Corners<'a> {
    mesh: &'a Mesh,
    uvs: &'a [Vec2],
    tangents: Vec<[f32; 4]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let normal = match self.mesh.normals.get(self.vertex(face, corner)) {
            Some(normal) => *normal,
            None => {
                let [a, b, c] = [0, 1, 2].map(|corner| self.mesh.positions[self.vertex(face, corner)]);
                (b - a).cross(c - a).normalize_or(glam::DVec3::Z).as_vec3()
            }
        };
        normal.normalize_or(Vec3::Z).to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        // A normal map's second axis points up in the image, against v.
        let uv = self.uvs[self.vertex(face, corner)];
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(tangent) = tangent.map(|space| space.tangent_encoded()).filter(|t| t.iter().all(|v| v.is_finite()))
        {
            self.tangents[3 * face + corner] = tangent;
        }
    }
}

/// The mesh with tangents along its texture coordinates, the first or the second set. A vertex whose triangles disagree about its tangent
/// becomes several. The mesh must have the set, and indices that exist.
pub(super) fn with_tangents(mesh: Mesh, by_second_uvs: bool) -> Mesh {
    let uvs = if by_second_uvs { &mesh.second_uvs } else { &mesh.uvs };
    // All zero stands for none: the shading frame then follows the texture coordinates.
    let mut corners = Corners { mesh: &mesh, uvs, tangents: vec![[0.0; 4]; 3 * mesh.triangles.len()] };
    if generate_tangents(&mut corners).is_err() {
        return mesh;
    }
    let mut split = Mesh::default();
    let mut known: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    for (triangle, tangents) in mesh.triangles.iter().zip(corners.tangents.chunks_exact(3)) {
        let mut place = [0; 3];
        for (corner, (vertex, tangent)) in triangle.iter().zip(tangents).enumerate() {
            let next = split.positions.len() as u32;
            place[corner] = *known.entry((*vertex, tangent.map(f32::to_bits))).or_insert_with(|| {
                let vertex = *vertex as usize;
                split.positions.push(mesh.positions[vertex]);
                split.normals.extend(mesh.normals.get(vertex));
                split.uvs.extend(mesh.uvs.get(vertex));
                split.second_uvs.extend(mesh.second_uvs.get(vertex));
                split.colours.extend(mesh.colours.get(vertex));
                split.tangents.push(Vec4::from(*tangent));
                next
            });
        }
        split.triangles.push(place);
    }
    split
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// u runs along x and v along y or against it; the tangent is x, and the bitangent points against v.
    #[test]
    fn the_bitangent_points_up_in_the_image() {
        for (down, sign) in [(true, 1.0), (false, -1.0)] {
            let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let mesh = Mesh {
                positions: corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
                uvs: corners.map(|(x, y)| Vec2::new(x as f32, if down { 1.0 - y as f32 } else { y as f32 })).to_vec(),
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                ..Mesh::default()
            };
            let mesh = with_tangents(mesh, false);
            assert_eq!(mesh.positions.len(), 4, "vertices that agree stay shared");
            for tangent in &mesh.tangents {
                assert!((*tangent - Vec4::new(1.0, 0.0, 0.0, sign)).length() < 1e-6, "{tangent}");
            }
        }
    }

    /// Two triangles whose texture is mirrored at their common edge: its vertices must become two each.
    #[test]
    fn vertices_split_where_tangents_differ() {
        let mesh = Mesh {
            positions: vec![DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::NEG_X],
            normals: vec![Vec3::Z; 4],
            uvs: vec![Vec2::ZERO, Vec2::Y, Vec2::X, Vec2::X],
            colours: vec![Vec4::ONE; 4],
            triangles: vec![[0, 2, 1], [0, 1, 3]],
            ..Mesh::default()
        };
        let mesh = with_tangents(mesh, false);
        let counts =
            [mesh.positions.len(), mesh.normals.len(), mesh.uvs.len(), mesh.colours.len(), mesh.tangents.len()];
        assert_eq!(counts, [6; 5]);
        for (triangle, x) in mesh.triangles.iter().zip([1.0, -1.0]) {
            for vertex in triangle {
                assert!((mesh.tangents[*vertex as usize].x - x).abs() < 1e-6, "{:?}", mesh.tangents);
            }
        }
    }

    #[test]
    fn hostile_numbers_do_not_panic() {
        for value in [0.0, 1e-40, 1e18, -1e18, 1.0] {
            let mesh = Mesh {
                positions: vec![DVec3::splat(value), DVec3::new(value, 0.0, 1.0), DVec3::new(0.0, value, -value)],
                uvs: vec![Vec2::splat(value as f32), Vec2::ZERO, Vec2::new(value as f32, 1.0)],
                triangles: vec![[0, 1, 2], [0, 0, 0], [2, 1, 0], [0, 2, 2]],
                ..Mesh::default()
            };
            assert_eq!(with_tangents(mesh, false).triangles.len(), 4);
        }
    }
}
