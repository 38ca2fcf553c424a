//! What fills the space around points: the camera, and the lights.

use glam::{DAffine3, DVec3};

use super::compile::light::unreachable_kind;
use super::{Instance, Scene};
use crate::layout::{
    LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, Light,
    MATERIAL_DIELECTRIC, MATERIAL_HAS_ABSORPTION, Material, NONE, Primitive, SPHERE_BIT, SURFACE_MASK,
};

/// Direction in which surfaces are looked for: along no axis, so that few edges lie on the way.
const LOOK: DVec3 = DVec3::new(0.534_522_483_824_848_8, 0.267_261_241_912_424_4, 0.801_783_725_737_273_2);

/// How far before an area light its medium is looked for, as a share of its size.
const OFF: f64 = 1e-4;

impl Scene {
    /// Absorption (1/m) of the medium around a point, which is relative to [`Scene::origin`]: that of the nearest surface with a volume,
    /// looking one way, if its back is seen.
    pub fn absorption_at(&self, point: DVec3) -> [f32; 3] {
        around(&self.absorbing(), point).unwrap_or_default()
    }

    /// Whether a point, which is relative to [`Scene::origin`], lies behind the nearest surface of smooth glass, looking one way.
    pub fn is_within_smooth_glass(&self, point: DVec3) -> bool {
        around(&self.volumes(|material| (material.kind == MATERIAL_DIELECTRIC).then_some(())), point).is_some()
    }

    /// Fills in the media around the lights: an area light's is the one before its front.
    pub(in crate::scene) fn immerse_lights(&mut self) {
        let volumes = self.absorbing();
        if volumes.iter().all(|volume| volume.surface.is_empty()) {
            return;
        }
        let media: Vec<_> =
            self.lights.iter().map(|light| around(&volumes, before(light)).unwrap_or_default()).collect();
        self.lights.iter_mut().zip(media).for_each(|(light, absorption)| light.absorption = absorption);
    }

    /// What absorbs, with how much.
    fn absorbing(&self) -> Vec<Volume<[f32; 3]>> {
        self.volumes(|material| {
            let absorbs = material.flags & MATERIAL_HAS_ABSORPTION != 0;
            absorbs.then(|| self.layereds[material.detail as usize].absorption)
        })
    }

    /// The surfaces whose fronts are of such a material, by instance, with what is behind them. Looks at every primitive of a scene that has
    /// one, at none of others.
    fn volumes<T: Copy>(&self, behind: impl Fn(&Material) -> Option<T>) -> Vec<Volume<T>> {
        if !self.materials.iter().any(|material| behind(material).is_some()) {
            return Vec::new();
        }
        let of_primitive = |primitive: &Primitive| {
            let front = self.surfaces[(primitive.surface & SURFACE_MASK) as usize].front;
            let material = (front != NONE).then(|| &self.materials[front as usize])?;
            behind(material).map(|what| (*primitive, what))
        };
        let of_instance = |instance: &Instance| Volume {
            to_object: instance.to_world.inverse(),
            surface: self.primitives[self.groups[instance.group].primitives()]
                .iter()
                .filter_map(of_primitive)
                .collect(),
        };
        self.instances.iter().map(of_instance).collect()
    }
}

/// The surfaces of an instance that have a volume behind them, with what fills it.
struct Volume<T> {
    to_object: DAffine3,
    surface: Vec<(Primitive, T)>,
}

/// What fills the space around a point, if it is in one of the volumes.
fn around<T: Copy>(volumes: &[Volume<T>], point: DVec3) -> Option<T> {
    let mut nearest = (f64::INFINITY, None);
    for volume in volumes {
        let (origin, direction) = (volume.to_object.transform_point3(point), volume.to_object.transform_vector3(LOOK));
        for (primitive, what) in &volume.surface {
            if let Some((t, is_back)) = crossing(primitive, origin, direction).filter(|(t, _)| *t < nearest.0) {
                nearest = (t, is_back.then_some(*what));
            }
        }
    }
    nearest.1
}

/// A point in the medium that a light shines in. What is infinitely far is nowhere, and has none around it.
fn before(light: &Light) -> DVec3 {
    let [a, b, c] = [light.position, light.v1, light.v2].map(|v| glam::Vec3::from(v).as_dvec3());
    match light.kind {
        LIGHT_TRIANGLE => (a + b + c) / 3.0 + OFF * (b - a).cross(c - a) / (b - a).length().max((c - a).length()),
        LIGHT_DIRECTIONAL => DVec3::INFINITY,
        LIGHT_SPHERE | LIGHT_POINT | LIGHT_SPOT | LIGHT_PROJECTOR => a,
        kind => unreachable_kind(kind, a),
    }
}

/// Where a ray first crosses a primitive, in lengths of its direction, and whether it comes from the back.
fn crossing(primitive: &Primitive, origin: DVec3, direction: DVec3) -> Option<(f64, bool)> {
    let [v0, v1, v2] = [primitive.v0, primitive.v1, primitive.v2].map(|v| glam::Vec3::from(v).as_dvec3());
    if primitive.surface & SPHERE_BIT != 0 {
        let (from_centre, radius) = (origin - v0, v1.x);
        let (a, b) = (direction.length_squared(), from_centre.dot(direction));
        let root = (b * b - a * (from_centre.length_squared() - radius * radius)).sqrt();
        let t = [(-b - root) / a, (-b + root) / a].into_iter().find(|t| *t > 0.0)?;
        // The normal of a sphere of negative radius points inward.
        return Some((t, (from_centre + t * direction).dot(direction) * radius > 0.0));
    }
    // Moller and Trumbore 1997.
    let (e1, e2, s) = (v1 - v0, v2 - v0, origin - v0);
    let p = direction.cross(e2);
    let determinant = e1.dot(p);
    let q = s.cross(e1);
    let (u, v, t) = (s.dot(p) / determinant, direction.dot(q) / determinant, e2.dot(q) / determinant);
    // The determinant is that of a normal against the direction: above 0 from the front. Along the plane all of this is no number.
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, determinant < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn primitive(v: [[f32; 3]; 3], surface: u32) -> Primitive {
        Primitive { v0: v[0], v1: v[1], v2: v[2], surface }
    }

    #[test]
    fn a_ray_crosses_a_sphere_from_inside_and_out() {
        let look = DVec3::new(0.0, 0.0, 2.0);
        let sphere = |radius: f32| primitive([[1.0, 2.0, 3.0], [radius, 0.0, 0.0], [0.0; 3]], SPHERE_BIT);
        assert_eq!(crossing(&sphere(0.5), DVec3::new(1.0, 2.0, 3.0), look), Some((0.25, true)));
        assert_eq!(crossing(&sphere(-0.5), DVec3::new(1.0, 2.0, 3.0), look), Some((0.25, false)));
        assert_eq!(crossing(&sphere(0.5), DVec3::new(1.0, 2.0, 0.0), look), Some((1.25, false)));
        assert_eq!(crossing(&sphere(0.5), DVec3::new(1.0, 2.0, 4.0), look), None);
        assert_eq!(crossing(&sphere(0.5), DVec3::new(1.6, 2.0, 0.0), look), None);
    }

    #[test]
    fn a_ray_crosses_a_triangle_from_both_sides() {
        let triangle = primitive([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0); // its normal is +z
        let at = |x: f64, y: f64, z: f64, dz: f64| crossing(&triangle, DVec3::new(x, y, z), DVec3::new(0.0, 0.0, dz));
        assert_eq!(at(0.25, 0.25, 1.0, -2.0), Some((0.5, false)));
        assert_eq!(at(0.25, 0.25, -1.0, 1.0), Some((1.0, true)));
        assert_eq!(at(0.25, 0.25, -1.0, -1.0), None);
        assert_eq!(at(0.75, 0.75, -1.0, 1.0), None);
        assert_eq!(crossing(&triangle, DVec3::new(0.25, 0.25, 0.0), DVec3::new(1.0, 0.0, 0.0)), None);
    }
}
