//! The scene as the renderer takes it: flat arrays, validated, in single precision around a nearby origin.
//!
//! A file becomes a scene in two steps: [`load`](load()) describes what it holds to a [`SceneBuilder`] in double precision, and
//! [`SceneBuilder::finish`] ([`compile`]) places it, drops what is degenerate, and checks the rest.

mod arrays;
pub mod compile;
mod description;
mod diffuse;
mod fingerprint;
pub mod load;
mod luminance;
mod medium;
pub mod needs;
mod objects;
mod power;
mod single;
mod smoothness;

use std::collections::HashMap;
use std::ops::Range;
use std::path::PathBuf;

use glam::{DAffine3, DVec3, Vec3};

pub use arrays::DeviceArray;
pub use description::{
    Attribute, Camera, FilmSettings, Filter, LightSelection, Mask, Mesh, SceneBuilder, Side, SurfaceDescription,
    TechniqueRequest, camera, filter, light, material, texture,
};
pub use load::{LoadOptions, SceneFormat, load};
pub use needs::Needs;
pub use power::Power;

use crate::bvh::{Bounds, primitive_bounds};
use crate::error::{Error, Result, one_of};
use crate::image::TextureImage;
use crate::layout::{
    LIGHT_SPHERE, LIGHTS, Light, MATERIAL_BLEND, Material, NONE, Primitive, PropertyTexture, SURFACE_MASK, scene_arrays,
};

/// A lamp is small where its area, beside the square of the scene's radius, is below this.
const SMALL: f32 = 0.2;

macro_rules! scene_struct {
    (
        whole { $( $(#[$doc:meta])* $field:ident : $kind:ident in $buffer:ident, $name:literal $(if $need:ident)?; )* }
        changed { $( $(#[$other_doc:meta])* $other:ident : $other_kind:ident $(in $other_buffer:ident)?, $other_name:literal; )* }
        made { $($made:tt)* }
    ) => {
        /// A scene, ready to be uploaded. The arrays that go to a device are those of the list in `layout`.
        #[derive(Clone, Debug)]
        pub struct Scene {
            /// Where it came from, for messages.
            pub source: PathBuf,
            /// Every camera; there is at least one.
            pub cameras: Vec<Camera>,
            /// The image that the file asks for, but through cameras that have one of their own.
            pub film: FilmSettings,
            /// The technique that the file asks for, if any.
            pub technique: TechniqueRequest,
            /// What the materials are called in the file, where they have names.
            pub material_names: Vec<Option<String>>,
            /// Images that textures show.
            pub images: Vec<TextureImage>,
            /// Lights that are selected from the alias table; the others are selected from the tree.
            pub table_lights: u32,
            /// Probability of selecting one from the table, where the background was not selected.
            pub table_probability: f32,
            /// Origin of the coordinates of the light tree's nodes.
            pub light_tree_origin: Vec3,
            /// Factor on coordinates relative to that.
            pub light_tree_scale: f32,
            /// Radiance of the background, if it emits.
            pub background: Option<[f32; 3]>,
            /// The image that the background shows.
            pub environment: Option<Environment>,
            /// Probability of selecting the background as the light to sample.
            pub background_probability: f32,
            /// Runs of primitives that are placed together.
            pub groups: Vec<Group>,
            /// What the groups are made of, group by group in the order of the file.
            pub shapes: Vec<NamedShape>,
            /// Placements of groups, in the rebased world.
            pub instances: Vec<Instance>,
            /// World coordinates of the origin that all positions here are relative to.
            pub origin: DVec3,
            /// The box around everything that is placed, relative to `origin`.
            pub bounds: Bounds,
            /// What the user should know: defaults that stepped in, degenerate faces that were dropped.
            pub warnings: Vec<String>,
            $( $(#[$other_doc])* pub $other: Vec<crate::layout::$other_kind>, )*
            $( $(#[$doc])* pub $field: Vec<crate::layout::$kind>, )*
        }
    };
}
scene_arrays!(scene_struct);

/// A background that is an image, in latitude and longitude.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Its texture; the background's radiance is a factor on it.
    pub texture: u32,
    /// From world to image directions, by rows: the image's up axis is +y, its middle -z... turned by this.
    pub from_world: [[f32; 3]; 3],
    /// Cells of its alias table ([`Scene::background_table`]), across and down.
    pub cells: [u32; 2],
}

/// A run of primitives that are placed together.
#[derive(Clone, Debug)]
pub struct Group {
    /// Its name, for messages.
    pub name: String,
    /// Its triangles.
    pub triangles: Range<u32>,
    /// Its spheres, which follow them.
    pub spheres: Range<u32>,
}

impl Group {
    /// All of its primitives.
    pub fn primitives(&self) -> Range<usize> {
        self.triangles.start as usize..self.spheres.end as usize
    }
}

/// A shape of a group, as the file has it.
#[derive(Clone, Debug)]
pub struct NamedShape {
    /// Its name.
    pub name: String,
    /// Index of its group.
    pub group: usize,
    /// Its primitives.
    pub primitives: Range<u32>,
}

/// One placement of a group.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index of the group.
    pub group: usize,
    /// World (relative to the scene's origin) from group.
    pub to_world: DAffine3,
}

impl Scene {
    /// The camera of that name or number, or the first one.
    pub fn camera(&self, name: Option<&str>) -> Result<&Camera> {
        let Some(name) = name else { return Ok(&self.cameras[0]) };
        let by_index = name.parse::<usize>().ok().and_then(|index| self.cameras.get(index));
        self.cameras.iter().find(|camera| camera.name == name).or(by_index).ok_or_else(|| {
            let valid = self.cameras.iter().enumerate().map(|(index, camera)| format!("{index} ('{}')", camera.name));
            Error::Usage(format!("{} has no camera '{name}'; it has {}", self.source.display(), one_of(valid)))
        })
    }

    /// The image that the file asks for through a camera.
    pub fn film_of(&self, camera: &Camera) -> FilmSettings {
        camera.film.unwrap_or(self.film)
    }

    /// Samples per pixel that the file asks for through a camera, if any.
    pub fn spp_of(&self, camera: &Camera) -> Option<u32> {
        if camera.film.is_some() { camera.spp } else { self.technique.spp }
    }

    /// Which of the materials some surface has, on either side, alone or in a blend: their indices, ascending.
    pub(crate) fn materials_in_use(&self) -> Vec<usize> {
        let mut pending: Vec<u32> = self.surfaces.iter().flat_map(|surface| [surface.front, surface.back]).collect();
        let mut seen = vec![false; self.materials.len()];
        while let Some(index) = pending.pop() {
            if index == NONE || std::mem::replace(&mut seen[index as usize], true) {
                continue;
            }
            // Blends refer to materials that no surface names.
            let material = &self.materials[index as usize];
            if material.kind == MATERIAL_BLEND {
                let blend = &self.blends[material.detail as usize];
                pending.extend([blend.first, blend.second]);
            }
        }
        (0..seen.len()).filter(|index| seen[*index]).collect()
    }

    /// Which textures multiply which properties of a material.
    pub fn textures_of(&self, material: &Material) -> &[PropertyTexture] {
        let own = self.material_textures.get(material.textures as usize);
        own.map_or(&[], |own| &self.property_textures[own.first as usize..][..own.count as usize])
    }

    /// Whether some light is one that no direction hits by chance: a point, a spot, a projector, parallel light.
    pub fn has_delta_lights(&self) -> bool {
        self.lights.iter().any(|light| LIGHTS[light.kind as usize].delta)
    }

    /// Whether light comes from where few directions lead to: from points, from surfaces that are small beside the scene, or from a
    /// background with an image, as that may show a sun.
    pub fn has_small_lights(&self) -> bool {
        // Of a sphere what any direction sees of it, a quarter.
        let area = |light: &Light| {
            let area = compile::light::area(light).unwrap_or_default() as f32;
            if light.kind == LIGHT_SPHERE { 0.25 * area } else { area }
        };
        // A lamp has one surface, and as many lights as triangles.
        let mut lamps: HashMap<u32, f32> = HashMap::new();
        self.lights.iter().for_each(|light| *lamps.entry(light.source).or_default() += area(light));
        let limit = SMALL * self.core().1.powi(2);
        self.has_delta_lights() || self.environment.is_some() || lamps.values().any(|lit| *lit < limit)
    }

    /// Radius of a sphere around everything that is placed; 1 where that is a point or nothing.
    pub fn radius(&self) -> f32 {
        radius_around(self.bounds)
    }

    /// Centre and radius of a sphere around everything that is placed and does not emit, or around everything where all does; 1 where
    /// that is a point. Looks at every primitive.
    pub fn core(&self) -> (Vec3, f32) {
        let bounds = self.core_bounds();
        (0.5 * (bounds.min + bounds.max), radius_around(bounds))
    }

    fn core_bounds(&self) -> Bounds {
        let dark =
            |primitive: &&Primitive| self.surfaces[(primitive.surface & SURFACE_MASK) as usize].emission == [0.0; 3];
        let of_group = |group: &Group| {
            let own = &self.primitives[group.primitives()];
            own.iter().filter(dark).map(primitive_bounds).fold(Bounds::EMPTY, Bounds::union)
        };
        let groups: Vec<Bounds> = self.groups.iter().map(of_group).collect();
        let placed = self.instances.iter().map(|instance| groups[instance.group].transformed(&instance.to_world));
        let all = placed.fold(Bounds::EMPTY, Bounds::union);
        if all.min.x <= all.max.x { all } else { self.bounds }
    }

    /// The box of one group, in its own space.
    pub fn group_bounds(&self, group: &Group) -> Bounds {
        self.primitives[group.primitives()].iter().map(primitive_bounds).fold(Bounds::EMPTY, Bounds::union)
    }
}

/// Radius of a sphere around a box; 1 where that is a point or nothing.
fn radius_around(bounds: Bounds) -> f32 {
    let radius = bounds.radius();
    if radius > 0.0 { radius } else { 1.0 }
}
