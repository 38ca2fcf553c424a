//! Groups of shapes that are placed together.

use glam::{DAffine3, DMat3, DVec3};

use super::mesh::Mesh;

/// What a group is made of, in double precision.
#[derive(Clone, Debug)]
pub(in crate::scene) enum Shape {
    /// Triangles, and the map from their coordinates to the group's.
    Mesh { mesh: Box<Mesh>, to_group: DAffine3 },
    /// A sphere; a negative radius turns its normal inwards. Texture coordinates go by its axes.
    Sphere { centre: DVec3, radius: f64, axes: DMat3 },
}

/// A group as it was described.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Group {
    /// Its name, for messages.
    pub name: String,
    /// Each shape with the index of its surface and its name.
    pub shapes: Vec<(Shape, usize, String)>,
}

/// The box around two boxes.
pub(in crate::scene) fn union(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> (DVec3, DVec3) {
    (a.0.min(b.0), a.1.max(b.1))
}

impl Group {
    /// The box around its shapes once they are placed; nothing where it has none.
    pub fn extent(&self, to_world: &DAffine3) -> Option<(DVec3, DVec3)> {
        let of = |shape: &Shape| match shape {
            Shape::Mesh { mesh, to_group } => {
                let map = *to_world * *to_group;
                let points = mesh.positions.iter().map(|position| map.transform_point3(*position));
                points.map(|point| (point, point)).reduce(union)
            }
            Shape::Sphere { centre, radius, .. } => {
                let rows = to_world.matrix3.transpose();
                let reach = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length()) * radius.abs();
                let centre = to_world.transform_point3(*centre);
                Some((centre - reach, centre + reach))
            }
        };
        self.shapes.iter().filter_map(|(shape, _, _)| of(shape)).reduce(union)
    }
}
