//! Axis-aligned boxes, and those of primitives.

use glam::{DAffine3, Vec3};
use obvhs::Boundable;
use obvhs::aabb::Aabb;

use crate::layout::{Primitive, SPHERE_BIT};

/// An axis-aligned box of single-precision corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Radius of the sphere around the box: 0 where that is a point. Of no use where the box contains nothing.
    pub fn radius(self) -> f32 {
        0.5 * (self.max - self.min).length()
    }

    /// A box around what the map makes of it; nothing stays nothing.
    #[must_use]
    pub fn transformed(self, map: &DAffine3) -> Self {
        if self.min.x > self.max.x {
            return Self::EMPTY;
        }
        let corner = |index: usize| {
            let pick = |axis: usize| if index >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            map.transform_point3(Vec3::new(pick(0), pick(1), pick(2)).as_dvec3()).as_vec3()
        };
        (0..8).map(corner).fold(Self::EMPTY, Self::with_point)
    }

    /// The smallest box around it and a point.
    #[must_use]
    pub fn with_point(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }
}

/// The box of a primitive. A sphere's is rounded outwards.
pub fn primitive_bounds(primitive: &Primitive) -> Bounds {
    let v0 = Vec3::from(primitive.v0);
    if primitive.surface & SPHERE_BIT != 0 {
        let radius = primitive.v1[0].abs();
        let reach = Vec3::splat(radius) + (v0.abs() + radius) * 4.0 * f32::EPSILON;
        return Bounds { min: v0 - reach, max: v0 + reach };
    }
    let (v1, v2) = (Vec3::from(primitive.v1), Vec3::from(primitive.v2));
    Bounds { min: v0.min(v1).min(v2), max: v0.max(v1).max(v2) }
}

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        Aabb::new(self.min.into(), self.max.into())
    }
}

/// Trees are built over the primitives as they are: a list of their boxes would take most of the memory that they do.
impl Boundable for Primitive {
    fn aabb(&self) -> Aabb {
        primitive_bounds(self).aabb()
    }
}
