//! What a scene uses, so that a kernel models only that.

use super::Scene;
use crate::layout::{
    CAMERA_PINHOLE, LIGHT_DIRECTIONAL, LIGHT_KINDS, LIGHT_POINT, LIGHT_PROJECTOR, LIGHT_SPHERE, LIGHT_SPOT,
    LIGHT_TRIANGLE, Layered, Light, MATERIAL_BLEND, MATERIAL_CONDUCTOR, MATERIAL_DIELECTRIC, MATERIAL_DIFFUSE,
    MATERIAL_HAS_ABSORPTION, MATERIAL_HAS_COLOURS, MATERIAL_HAS_TANGENTS, MATERIAL_IS_COMPENSATED, MATERIAL_KINDS,
    MATERIAL_LAYERED, MATERIAL_PLASTIC, MATERIAL_PRINCIPLED, MATERIAL_ROUGH_CONDUCTOR, MATERIAL_ROUGH_DIELECTRIC,
    MATERIAL_ROUGH_PLASTIC, MATERIAL_THIN_DIELECTRIC, MICROFACET_BECKMANN, NONE, SPHERE_BIT, Specialisation,
    TEXTURE_CHECKERBOARD, TEXTURE_IMAGE, Texture,
};

/// The kinds of material by `MATERIAL_*`.
const MATERIALS: [&str; MATERIAL_KINDS as usize] = [
    "diffuse",
    "conductor",
    "rough conductor",
    "dielectric",
    "rough dielectric",
    "thin dielectric",
    "plastic",
    "rough plastic",
    "principled",
    "layered (glTF)",
    "blends",
];

/// What a kind of material is called.
pub(super) fn material_kind(kind: u32) -> &'static str {
    MATERIALS[kind as usize]
}

/// The kinds of light by `LIGHT_*`.
const LIGHTS: [&str; LIGHT_KINDS as usize] =
    ["triangle lights", "sphere lights", "point lights", "spot lights", "directional lights", "projectors"];

/// Whether a light is a triangle at least this long beside the radius of the scene. Smaller ones are seen from close by few
/// points, which is not worth what sampling by solid angle costs all the others.
const LARGE: f32 = 0.5;

fn is_large(light: &Light, scene: &Scene) -> bool {
    let radius = 0.5 * (scene.bounds.max - scene.bounds.min).length();
    let [a, b, c] = [light.position, light.v1, light.v2].map(glam::Vec3::from);
    light.kind == LIGHT_TRIANGLE && b.distance(c).max(c.distance(a)).max(a.distance(b)) > LARGE * radius
}

/// The bits of all textures that hold texels.
fn texture_bits(scene: &Scene, bits: impl Fn(&Texture) -> u32) -> u32 {
    scene.textures.iter().filter(|texture| texture.kind == TEXTURE_IMAGE).fold(0, |all, texture| all | bits(texture))
}

/// What a scene uses. Each `false` is code that is not compiled in and memory that is not allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Groups placed by affine maps.
    pub instances: bool,
    /// Spheres.
    pub spheres: bool,
    /// Vertex normals.
    pub normals: bool,
    /// Texture coordinates.
    pub uvs: bool,
    /// Shading frames that follow them.
    pub tangents: bool,
    /// Vertex colours.
    pub colours: bool,
    /// Materials on the back of surfaces.
    pub back_materials: bool,
    /// Surfaces that let light pass straight through.
    pub masks: bool,
    /// Per kind of material, whether any surface has it, by `MATERIAL_*`.
    pub materials: [bool; MATERIAL_KINDS as usize],
    /// Textures of materials.
    pub material_textures: bool,
    /// Images with smaller levels of detail.
    pub mip_maps: bool,
    /// Sheen of layered materials.
    pub layered_sheen: bool,
    /// Clear coats of layered materials.
    pub layered_clearcoat: bool,
    /// Layered materials that let light through.
    pub layered_transmission: bool,
    /// Layered materials that bound a volume.
    pub layered_volume: bool,
    /// Maps of normals.
    pub normal_maps: bool,
    /// Bump maps.
    pub bump_maps: bool,
    /// Textures of surfaces' opacity.
    pub textured_masks: bool,
    /// Textures of two colours in squares.
    pub checkerboards: bool,
    /// Formats of texels, by bit `TEXELS_*`.
    pub texel_formats: u32,
    /// How textures go on outside of themselves, by bit `WRAP_*`.
    pub wraps: u32,
    /// Beckmann's microfacets.
    pub beckmann: bool,
    /// Light that is absorbed inside of materials.
    pub absorption: bool,
    /// Rough metals or rough glass that get back what they lose to multiple scattering.
    pub energy_compensation: bool,
    /// Per kind of light, whether there is one, by `LIGHT_*`.
    pub lights: [bool; LIGHT_KINDS as usize],
    /// Emitting triangles that are large beside the scene, so that some of it is close to them.
    pub large_lights: bool,
    /// Lights that are selected from a tree.
    pub light_tree: bool,
    /// Textures or masks on what emits.
    pub textured_lights: bool,
    /// Point-like lights that shine through a texture.
    pub projectors: bool,
    /// A background that emits.
    pub background: bool,
    /// A background that is an image.
    pub environment: bool,
    /// Entries of the light table; `NONE` leaves it to be read.
    pub light_count: u32,
    /// Surfaces; `NONE` leaves them to be read.
    pub surface_count: u32,
    /// Materials; `NONE` leaves them to be read.
    pub material_count: u32,
}

impl Needs {
    /// What this scene uses.
    pub fn of(scene: &Scene) -> Self {
        let mut materials = [false; MATERIAL_KINDS as usize];
        let mut flags = 0;
        let mut textured = false;
        let (mut normal_maps, mut bump_maps) = (false, false);
        let mut layered: Vec<&Layered> = Vec::new();
        // Blends refer to materials that no surface names.
        let mut pending: Vec<u32> = scene.surfaces.iter().flat_map(|surface| [surface.front, surface.back]).collect();
        let mut seen = vec![false; scene.materials.len()];
        while let Some(index) = pending.pop() {
            if index == NONE || std::mem::replace(&mut seen[index as usize], true) {
                continue;
            }
            let material = &scene.materials[index as usize];
            materials[material.kind as usize] = true;
            flags |= material.flags;
            if material.textures != NONE {
                let textures = &scene.material_textures[material.textures as usize];
                normal_maps |= textures.normal != NONE;
                bump_maps |= textures.bump != NONE;
                textured = true;
            }
            if material.kind == MATERIAL_LAYERED {
                layered.push(&scene.layereds[material.detail as usize]);
            }
            if material.kind == MATERIAL_BLEND {
                let blend = &scene.blends[material.detail as usize];
                pending.extend([blend.first, blend.second]);
                textured |= blend.weight_texture != NONE;
            }
        }
        let mut lights = [false; LIGHT_KINDS as usize];
        let mut projectors = false;
        for light in &scene.lights {
            lights[light.kind as usize] = true;
            let is_lamp = matches!(light.kind, LIGHT_SPOT | LIGHT_PROJECTOR);
            projectors |= is_lamp && light.source != NONE;
        }
        let masks = scene.surfaces.iter().any(|surface| surface.opacity < 1.0 || surface.opacity_texture != NONE);
        let textured_lights = scene.surfaces.iter().any(|surface| {
            let masked = surface.opacity < 1.0 || surface.opacity_texture != NONE;
            surface.emission != [0.0; 3] && (surface.emission_texture != NONE || masked)
        });
        let textured_masks = scene.surfaces.iter().any(|surface| surface.opacity_texture != NONE);
        let tangents = flags & MATERIAL_HAS_TANGENTS != 0;
        let colours = flags & MATERIAL_HAS_COLOURS != 0 && !scene.colours.is_empty();
        Self {
            instances: scene.instances.iter().any(|instance| instance.to_world != glam::DAffine3::IDENTITY)
                || scene.instances.len() > 1,
            spheres: scene.primitives.iter().any(|primitive| primitive.surface & SPHERE_BIT != 0),
            normals: !scene.normals.is_empty(),
            uvs: textured || tangents || textured_masks || textured_lights || colours,
            tangents,
            colours,
            back_materials: scene.surfaces.iter().any(|surface| surface.back != NONE),
            masks,
            materials,
            material_textures: textured,
            mip_maps: scene.textures.iter().any(|texture| texture.levels > 1),
            layered_sheen: layered.iter().any(|layers| layers.sheen_colour != [0.0; 3]),
            layered_clearcoat: layered.iter().any(|layers| layers.clearcoat != 0.0),
            layered_transmission: layered.iter().any(|layers| layers.transmission != 0.0),
            layered_volume: layered.iter().any(|layers| layers.is_volume != 0),
            normal_maps,
            bump_maps,
            textured_masks,
            checkerboards: scene.textures.iter().any(|texture| texture.kind == TEXTURE_CHECKERBOARD),
            texel_formats: texture_bits(scene, |texture| 1 << texture.format),
            wraps: texture_bits(scene, |texture| 1 << (texture.sampling & 0xff) | 1 << (texture.sampling >> 8 & 0xff)),
            beckmann: flags & MICROFACET_BECKMANN != 0,
            absorption: flags & MATERIAL_HAS_ABSORPTION != 0,
            energy_compensation: flags & MATERIAL_IS_COMPENSATED != 0,
            lights,
            large_lights: scene.lights.iter().any(|light| is_large(light, scene)),
            light_tree: !scene.light_tree.is_empty(),
            textured_lights,
            projectors,
            background: scene.background.is_some(),
            environment: scene.environment.is_some(),
            light_count: scene.lights.len() as u32,
            surface_count: scene.surfaces.len() as u32,
            material_count: scene.materials.len() as u32,
        }
    }

    /// Everything that there is, whatever the scene uses: what specialisation is measured against. How lights are sampled
    /// and textures filtered are choices for the scene rather than needs, and stay.
    pub fn everything(scene: &Scene) -> Self {
        let own = Self::of(scene);
        Self {
            instances: true,
            spheres: true,
            normals: true,
            uvs: true,
            tangents: true,
            colours: true,
            back_materials: true,
            masks: true,
            materials: [true; MATERIAL_KINDS as usize],
            material_textures: true,
            mip_maps: own.mip_maps,
            layered_sheen: true,
            layered_clearcoat: true,
            layered_transmission: true,
            layered_volume: true,
            normal_maps: true,
            bump_maps: true,
            textured_masks: true,
            checkerboards: true,
            texel_formats: u32::MAX,
            wraps: u32::MAX,
            beckmann: true,
            absorption: true,
            energy_compensation: true,
            lights: [true; LIGHT_KINDS as usize],
            large_lights: own.large_lights,
            light_tree: own.light_tree,
            textured_lights: true,
            projectors: true,
            background: true,
            environment: true,
            light_count: NONE,
            surface_count: NONE,
            material_count: NONE,
        }
    }

    /// Writes what it knows into a specialisation.
    pub fn specialise(&self, special: &mut Specialisation) {
        let material = |kind: u32| self.materials[kind as usize];
        let light = |kind: u32| self.lights[kind as usize];
        special.instances = self.instances;
        special.spheres = self.spheres;
        special.normals = self.normals;
        special.uvs = self.uvs;
        special.tangents = self.tangents;
        special.colours = self.colours;
        special.back_materials = self.back_materials;
        special.masks = self.masks;
        special.diffuse = material(MATERIAL_DIFFUSE);
        special.conductor = material(MATERIAL_CONDUCTOR);
        special.rough_conductor = material(MATERIAL_ROUGH_CONDUCTOR);
        special.dielectric = material(MATERIAL_DIELECTRIC);
        special.rough_dielectric = material(MATERIAL_ROUGH_DIELECTRIC);
        special.thin_dielectric = material(MATERIAL_THIN_DIELECTRIC);
        special.plastic = material(MATERIAL_PLASTIC);
        special.rough_plastic = material(MATERIAL_ROUGH_PLASTIC);
        special.principled = material(MATERIAL_PRINCIPLED);
        special.layered = material(MATERIAL_LAYERED);
        special.blends = material(MATERIAL_BLEND);
        special.material_textures = self.material_textures;
        special.mip_maps = self.mip_maps;
        special.layered_sheen = self.layered_sheen;
        special.layered_clearcoat = self.layered_clearcoat;
        special.layered_transmission = self.layered_transmission;
        special.layered_volume = self.layered_volume;
        special.normal_maps = self.normal_maps;
        special.bump_maps = self.bump_maps;
        special.textured_masks = self.textured_masks;
        special.checkerboards = self.checkerboards;
        special.texel_formats = self.texel_formats;
        special.wraps = self.wraps;
        special.beckmann = self.beckmann;
        special.absorption = self.absorption;
        special.energy_compensation = self.energy_compensation;
        special.triangle_lights = light(LIGHT_TRIANGLE);
        special.sphere_lights = light(LIGHT_SPHERE);
        special.point_lights = light(LIGHT_POINT);
        special.spot_lights = light(LIGHT_SPOT);
        special.directional_lights = light(LIGHT_DIRECTIONAL);
        special.large_lights = self.large_lights;
        special.light_tree = self.light_tree;
        special.textured_lights = self.textured_lights;
        special.projectors = self.projectors || light(LIGHT_PROJECTOR);
        special.background = self.background;
        special.environment = self.environment;
        special.light_count = self.light_count;
        special.surface_count = self.surface_count;
        special.material_count = self.material_count;
        special.camera = CAMERA_PINHOLE;
    }

    /// What it uses and what it does without, in words.
    pub fn describe(&self) -> (Vec<&'static str>, Vec<&'static str>) {
        let rest = [
            (self.instances, "instances"),
            (self.spheres, "spheres"),
            (self.normals, "vertex normals"),
            (self.uvs, "texture coordinates"),
            (self.tangents, "tangent frames"),
            (self.colours, "vertex colours"),
            (self.back_materials, "two-sided surfaces"),
            (self.masks, "masks"),
            (self.material_textures, "textured materials"),
            (self.normal_maps, "normal maps"),
            (self.bump_maps, "bump maps"),
            (self.textured_masks, "textured masks"),
            (self.checkerboards, "checkerboards"),
            (self.mip_maps, "mip maps"),
            (self.layered_sheen, "sheen"),
            (self.layered_clearcoat, "clear coats"),
            (self.layered_transmission, "transmission"),
            (self.layered_volume, "volumes"),
            (self.beckmann, "Beckmann microfacets"),
            (self.absorption, "absorption"),
            (self.energy_compensation, "energy compensation"),
            (self.large_lights, "large lights"),
            (self.light_tree, "light tree"),
            (self.textured_lights, "textured lights"),
            (self.background, "background"),
            (self.environment, "environment image"),
        ];
        let materials = self.materials.into_iter().zip(MATERIALS);
        let lights = self.lights.into_iter().zip(LIGHTS);
        let all: Vec<_> = rest.into_iter().chain(materials).chain(lights).collect();
        let those = |wanted: bool| all.iter().filter(|(used, _)| *used == wanted).map(|(_, name)| *name).collect();
        (those(true), those(false))
    }
}
