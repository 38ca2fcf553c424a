//! What a scene uses, so that a kernel models only that: the list of features, of materials and of lights in `layout`, asked of a scene.

use glam::DAffine3;

use super::Scene;
pub use crate::layout::Needs;
#[allow(clippy::wildcard_imports)] // whatever the closures of the list of features name
use crate::layout::*;

/// Whether a light is a triangle at least this long beside the radius of the scene. Smaller ones are seen from close by few
/// points, which is not worth what sampling by solid angle costs all the others.
const LARGE: f32 = 0.5;

fn is_large(light: &Light, scene: &Scene) -> bool {
    let [a, b, c] = [light.position, light.v1, light.v2].map(glam::Vec3::from);
    light.kind == LIGHT_TRIANGLE && b.distance(c).max(c.distance(a)).max(a.distance(b)) > LARGE * scene.radius()
}

/// The bits of all textures that hold texels.
fn texture_bits(scene: &Scene, bits: impl Fn(&Texture) -> u32) -> u32 {
    scene.textures.iter().filter(|texture| texture.kind == TEXTURE_IMAGE).fold(0, |all, texture| all | bits(texture))
}

/// Whether a surface lets some light pass straight through.
fn is_masked(surface: &Surface) -> bool {
    surface.opacity < 1.0 || surface.opacity_texture != NONE || has_alpha_colours(surface)
}

/// Whether the alpha of vertex colours multiplies a surface's opacity.
fn has_alpha_colours(surface: &Surface) -> bool {
    surface.flags & SURFACE_HAS_ALPHA_COLOURS != 0
}

/// Whether a surface emits, and not the same everywhere.
fn emits_by_texture(surface: &Surface) -> bool {
    surface.emission != [0.0; 3] && (surface.emission_texture != NONE || is_masked(surface))
}

/// Whether some material or some mask shows vertex colours that there are.
fn shows_colours(scene: &Scene, census: &Census) -> bool {
    let are_shown = census.flags & MATERIAL_HAS_COLOURS != 0 || scene.surfaces.iter().any(has_alpha_colours);
    are_shown && !scene.colours.is_empty()
}

/// Whether some clear coat has a map of normals, or covers something that may have one.
fn has_coat_normals(census: &Census) -> bool {
    let mut coated = census.layered.iter().filter(|layers| layers.clearcoat != 0.0);
    coated.any(|layers| census.normal_maps || layers.clearcoat_normal_texture != NONE)
}

/// Whether anything looks at the attributes of vertices that texture coordinates come with.
fn reads_uvs(scene: &Scene, census: &Census) -> bool {
    census.textured
        || census.flags & MATERIAL_HAS_TANGENTS != 0
        || scene.surfaces.iter().any(|surface| surface.opacity_texture != NONE || emits_by_texture(surface))
        || shows_colours(scene, census)
        || !scene.attributes.is_empty()
}

/// What the materials are that surfaces have, alone or in blends.
#[derive(Default)]
struct Census<'a> {
    /// The kinds that there are.
    kinds: [bool; MATERIAL_KINDS],
    /// The bits of [`crate::layout::Material::flags`] that any has.
    flags: u32,
    /// Whether any has a texture, a map of normals, a bump map.
    textured: bool,
    normal_maps: bool,
    bump_maps: bool,
    /// The properties that are textured: bit `PROPERTY_*`.
    textured_properties: u32,
    /// The layered ones.
    layered: Vec<&'a Layered>,
}

impl<'a> Census<'a> {
    fn of(scene: &'a Scene) -> Self {
        let mut census = Self::default();
        for material in scene.materials_in_use().into_iter().map(|index| &scene.materials[index]) {
            census.kinds[material.kind as usize] = true;
            census.flags |= material.flags;
            if material.textures != NONE {
                let textures = &scene.material_textures[material.textures as usize];
                census.normal_maps |= textures.normal != NONE;
                census.bump_maps |= textures.bump != NONE;
                for own in scene.textures_of(material) {
                    census.textured_properties |= 1 << own.property;
                }
                census.textured = true;
            }
            if material.kind == MATERIAL_LAYERED {
                census.layered.push(&scene.layereds[material.detail as usize]);
            }
            if material.kind == MATERIAL_BLEND {
                census.textured |= scene.blends[material.detail as usize].weight_texture != NONE;
            }
        }
        census
    }
}

macro_rules! needs_of_scenes {
    ($(
        $(#[$doc:meta])*
        $member:ident $constant:ident: $kind:ident $($word:literal)?, of $of:expr, unspecialised $unspecialised:expr;
    )*) => {
        impl Needs {
            /// What this scene uses.
            pub fn of(scene: &Scene) -> Self {
                let census = Census::of(scene);
                let mut lights = [false; LIGHT_KINDS];
                scene.lights.iter().for_each(|light| lights[light.kind as usize] = true);
                $( let $member: fn(&Scene, &Census) -> $kind = $of; )*
                Self { materials: census.kinds, lights, $( $member: $member(scene, &census) ),* }
            }

            /// Everything that there is, whatever the scene uses: what specialisation is measured against. How lights are sampled and
            /// textures filtered are choices for the scene rather than needs, and stay.
            pub fn everything(scene: &Scene) -> Self {
                let own = Self::of(scene);
                $( let $member: fn($kind) -> $kind = $unspecialised; )*
                Self {
                    materials: [true; MATERIAL_KINDS],
                    lights: [true; LIGHT_KINDS],
                    $( $member: $member(own.$member) ),*
                }
            }

            /// The features that have words: whether each is used, and its word.
            fn features(&self) -> impl Iterator<Item = (bool, &'static str)> {
                [$( $( (self.$member, $word), )? )*].into_iter()
            }
        }
    };
}
features!(needs_of_scenes);

impl Needs {
    /// What it uses and what it does without, in words.
    pub fn describe(&self) -> (Vec<&'static str>, Vec<&'static str>) {
        let materials = self.materials.into_iter().zip(MATERIALS.iter().map(|kind| kind.word));
        let lights = self.lights.into_iter().zip(LIGHTS.iter().map(|kind| kind.word));
        let all: Vec<_> = self.features().chain(materials).chain(lights).collect();
        let those = |wanted: bool| all.iter().filter(|(used, _)| *used == wanted).map(|(_, word)| *word).collect();
        (those(true), those(false))
    }
}
