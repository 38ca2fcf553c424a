//! What a scene uses, so that a kernel models only that.

use super::Scene;
use crate::layout::{
    LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, MATERIAL_CONDUCTOR, MATERIAL_DIELECTRIC,
    MATERIAL_DIFFUSE, MATERIAL_ROUGH_CONDUCTOR, MATERIAL_ROUGH_DIELECTRIC, NONE, SPHERE_BIT, Specialisation,
};

/// What a scene uses. Each `false` is code that is not compiled in and memory that is not allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Groups placed by affine maps.
    pub instances: bool,
    /// Spheres.
    pub spheres: bool,
    /// Vertex normals.
    pub normals: bool,
    /// Materials on the back of surfaces.
    pub back_materials: bool,
    /// Per kind of material, whether any surface has it, by `MATERIAL_*`.
    pub materials: [bool; 5],
    /// Per kind of light, whether there is one, by `LIGHT_*`.
    pub lights: [bool; 5],
    /// A background that emits.
    pub background: bool,
    /// Entries of the light table.
    pub light_count: u32,
    /// Surfaces.
    pub surface_count: u32,
    /// Materials.
    pub material_count: u32,
}

impl Needs {
    /// What this scene uses.
    pub fn of(scene: &Scene) -> Self {
        let mut materials = [false; 5];
        for surface in &scene.surfaces {
            for material in [surface.front, surface.back].into_iter().filter(|material| *material != NONE) {
                materials[scene.materials[material as usize].kind as usize] = true;
            }
        }
        let mut lights = [false; 5];
        for light in &scene.lights {
            lights[light.kind as usize] = true;
        }
        Self {
            instances: scene.instances.iter().any(|instance| instance.to_world != glam::DAffine3::IDENTITY)
                || scene.instances.len() > 1,
            spheres: scene.primitives.iter().any(|primitive| primitive.surface & SPHERE_BIT != 0),
            normals: !scene.corners.is_empty(),
            back_materials: scene.surfaces.iter().any(|surface| surface.back != NONE),
            materials,
            lights,
            background: scene.background.is_some(),
            light_count: scene.lights.len() as u32,
            surface_count: scene.surfaces.len() as u32,
            material_count: scene.materials.len() as u32,
        }
    }

    /// Writes what it knows into a specialisation.
    pub fn specialise(&self, special: &mut Specialisation) {
        special.instances = self.instances;
        special.spheres = self.spheres;
        special.normals = self.normals;
        special.back_materials = self.back_materials;
        special.diffuse = self.materials[MATERIAL_DIFFUSE as usize];
        special.conductor = self.materials[MATERIAL_CONDUCTOR as usize];
        special.rough_conductor = self.materials[MATERIAL_ROUGH_CONDUCTOR as usize];
        special.dielectric = self.materials[MATERIAL_DIELECTRIC as usize];
        special.rough_dielectric = self.materials[MATERIAL_ROUGH_DIELECTRIC as usize];
        special.triangle_lights = self.lights[LIGHT_TRIANGLE as usize];
        special.sphere_lights = self.lights[LIGHT_SPHERE as usize];
        special.point_lights = self.lights[LIGHT_POINT as usize];
        special.spot_lights = self.lights[LIGHT_SPOT as usize];
        special.directional_lights = self.lights[LIGHT_DIRECTIONAL as usize];
        special.background = self.background;
        special.light_count = self.light_count;
        special.surface_count = self.surface_count;
        special.material_count = self.material_count;
    }
}

impl Needs {
    /// What it uses, in words.
    pub fn describe(&self) -> Vec<&'static str> {
        let materials = ["diffuse", "conductor", "rough conductor", "dielectric", "rough dielectric"];
        let lights = ["triangle lights", "sphere lights", "point lights", "spot lights", "directional lights"];
        let rest = [
            (self.instances, "instances"),
            (self.spheres, "spheres"),
            (self.normals, "vertex normals"),
            (self.back_materials, "two-sided surfaces"),
            (self.background, "background"),
        ];
        let mut words: Vec<&'static str> = rest.into_iter().filter(|(used, _)| *used).map(|(_, name)| name).collect();
        words.extend(materials.into_iter().zip(self.materials).filter(|(_, used)| *used).map(|(name, _)| name));
        words.extend(lights.into_iter().zip(self.lights).filter(|(_, used)| *used).map(|(name, _)| name));
        words
    }
}
