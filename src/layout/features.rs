//! What kernels may leave out for a scene, each feature declared once.
//!
//! A row is a member of [`super::Needs`], a specialisation constant, a word of `lumbre info`, how a scene shows it, and
//! what it is where kernels are not specialised. Materials and lights have theirs by kind, in tables of their own.

/// Calls `$callback! { ROWS }`. A row is `MEMBER CONSTANT: TYPE WORD, of CLOSURE, unspecialised CLOSURE;`: its name on the
/// host, that of the specialisation constant, `bool` or `uint`, its word in reports (none where it is no feature to speak
/// of), what it is for a `&Scene` and the `&Census` of what its surfaces show, and what it is, given that, where kernels
/// model everything.
///
/// The closures are compiled where the macro's caller puts them: in `scene/needs.rs`, and not in the build script, which
/// knows no scenes. They may name all of `layout`. A feature that follows from which materials surfaces have asks the
/// `Census`; where that lacks what it asks for, `scene/needs.rs` must count it first.
macro_rules! features {
    ($callback:ident) => {
        $callback! {
            /// Some group is placed by an affine map, so traversal has two levels.
            instances HAS_INSTANCES: bool "instances",
                of |scene, _| scene.instances.len() > 1 || scene.instances.iter().any(|placed| placed.to_world != DAffine3::IDENTITY),
                unspecialised |_| true;
            /// Some primitive is a sphere.
            spheres HAS_SPHERES: bool "spheres",
                of |scene, _| scene.primitives.iter().any(|primitive| primitive.surface & SPHERE_BIT != 0),
                unspecialised |_| true;
            /// Some mesh has vertex normals.
            normals HAS_NORMALS: bool "vertex normals",
                of |scene, _| !scene.normals.is_empty(),
                unspecialised |_| true;
            /// Something reads texture coordinates.
            uvs HAS_UVS: bool "texture coordinates",
                of |scene, census| reads_uvs(scene, census),
                unspecialised |_| true;
            /// Some texture is looked up by a second set of them.
            second_uvs HAS_SECOND_UVS: bool "second texture coordinates",
                of |scene, _| !scene.second_uvs.is_empty() && scene.textures.iter().any(|texture| texture.sampling & SECOND_UVS_BIT != 0),
                unspecialised |own| own;
            /// Some shading basis follows the texture coordinates.
            tangents HAS_TANGENTS: bool "tangent frames",
                of |_, census| census.flags & MATERIAL_HAS_TANGENTS != 0,
                unspecialised |_| true;
            /// Some mesh has vertex colours, and some material shows them.
            colours HAS_COLOURS: bool "vertex colours",
                of |scene, census| shows_colours(scene, census),
                unspecialised |_| true;
            /// Some texture shows an attribute of a mesh.
            attributes HAS_ATTRIBUTES: bool "vertex attributes",
                of |scene, _| !scene.attributes.is_empty(),
                unspecialised |_| true;
            /// Some surface has a material on its back.
            back_materials HAS_BACK_MATERIALS: bool "two-sided surfaces",
                of |scene, _| scene.surfaces.iter().any(|surface| surface.back != NONE),
                unspecialised |_| true;
            /// Some surface lets light pass straight through.
            masks HAS_MASKS: bool "masks",
                of |scene, _| scene.surfaces.iter().any(is_masked),
                unspecialised |_| true;
            /// Some material has textures.
            material_textures HAS_MATERIAL_TEXTURES: bool "textured materials",
                of |_, census| census.textured,
                unspecialised |_| true;
            /// The properties of materials that are textured: bit `PROPERTY_*`.
            textured_properties TEXTURED_PROPERTIES: uint,
                of |_, census| census.textured_properties,
                unspecialised |_| u32::MAX;
            /// Some material has a map of normals.
            normal_maps HAS_NORMAL_MAPS: bool "normal maps",
                of |_, census| census.normal_maps,
                unspecialised |_| true;
            /// Some material has a bump map.
            bump_maps HAS_BUMP_MAPS: bool "bump maps",
                of |_, census| census.bump_maps,
                unspecialised |_| true;
            /// The camera looks through emitters and does not see the background.
            hidden_emitters HIDES_EMITTERS: bool "hidden emitters",
                of |scene, _| scene.technique.hide_emitters,
                unspecialised |own| own;
            /// Some mapped normal is mirrored where the camera is below it.
            flipped_normals HAS_FLIPPED_NORMALS: bool "flipped normals",
                of |_, census| census.flags & MATERIAL_FLIPS_NORMALS != 0,
                unspecialised |_| true;
            /// Some mapped surface shadows itself.
            shadowed_normals HAS_SHADOWED_NORMALS: bool "shadowed slopes",
                of |_, census| census.flags & MATERIAL_SHADOWS_NORMALS != 0,
                unspecialised |_| true;
            /// Some surface has a textured opacity.
            textured_masks HAS_TEXTURED_MASKS: bool "textured masks",
                of |scene, _| scene.surfaces.iter().any(|surface| surface.opacity_texture != NONE),
                unspecialised |_| true;
            /// Some surface's opacity goes by vertex colours.
            alpha_colours HAS_ALPHA_COLOURS: bool "vertex alpha",
                of |scene, _| scene.surfaces.iter().any(has_alpha_colours),
                unspecialised |_| true;
            /// Some texture is a checkerboard.
            checkerboards HAS_CHECKERBOARDS: bool "checkerboards",
                of |scene, _| scene.textures.iter().any(|texture| texture.kind == TEXTURE_CHECKERBOARD),
                unspecialised |_| true;
            /// Some texture shows others.
            nested_textures HAS_NESTED_TEXTURES: bool "nested textures",
                of |scene, _| scene.textures.iter().any(|texture| texture.kind == TEXTURE_CHECKERBOARD && texture.texels != [NONE; 2]),
                unspecialised |_| true;
            /// Some image has smaller levels of detail, which materials are filtered with: a choice for the scene rather than a need.
            mip_maps HAS_MIP_MAPS: bool "mip maps",
                of |scene, _| scene.textures.iter().any(|texture| texture.levels > 1),
                unspecialised |own| own;
            /// Some layered material has a sheen.
            layered_sheen HAS_LAYERED_SHEEN: bool "sheen",
                of |_, census| census.layered.iter().any(|layers| layers.sheen_colour != [0.0; 3]),
                unspecialised |_| true;
            /// Some layered material has a clear coat.
            layered_clearcoat HAS_LAYERED_CLEARCOAT: bool "clear coats",
                of |_, census| census.layered.iter().any(|layers| layers.clearcoat != 0.0),
                unspecialised |_| true;
            /// Some clear coat has normals that are not those of what it covers.
            coat_normals HAS_COAT_NORMALS: bool "normals of clear coats",
                of |_, census| has_coat_normals(census),
                unspecialised |_| true;
            /// Some layered material lets light through.
            layered_transmission HAS_LAYERED_TRANSMISSION: bool "transmission",
                of |_, census| census.layered.iter().any(|layers| layers.transmission != 0.0),
                unspecialised |_| true;
            /// Some layered material bounds a volume.
            layered_volume HAS_LAYERED_VOLUME: bool "volumes",
                of |_, census| census.layered.iter().any(|layers| layers.is_volume != 0),
                unspecialised |_| true;
            /// Some layered material has a highlight that is wider along one direction.
            layered_anisotropy HAS_LAYERED_ANISOTROPY: bool "anisotropic layers",
                of |_, census| census.layered.iter().any(|layers| layers.anisotropy != 0.0),
                unspecialised |_| true;
            /// Some layered material has a thin film.
            layered_iridescence HAS_LAYERED_IRIDESCENCE: bool "iridescence",
                of |_, census| census.layered.iter().any(|layers| layers.iridescence != 0.0),
                unspecialised |_| true;
            /// Some layered material scatters light to its other side.
            layered_diffuse_transmission HAS_LAYERED_DIFFUSE_TRANSMISSION: bool "diffuse transmission",
                of |_, census| census.layered.iter().any(|layers| layers.diffuse_transmission != 0.0),
                unspecialised |_| true;
            /// Some layered material's index of refraction depends on the wavelength.
            layered_dispersion HAS_LAYERED_DISPERSION: bool "dispersion",
                of |_, census| census.layered.iter().any(|layers| layers.dispersion != 0.0),
                unspecialised |_| true;
            /// Some microfacets are Beckmann's.
            beckmann HAS_BECKMANN: bool "Beckmann microfacets",
                of |_, census| census.flags & MICROFACET_BECKMANN != 0,
                unspecialised |_| true;
            /// Some lobe is as narrow as a mirror's, and is none.
            narrow_lobes HAS_NARROW_LOBES: bool "narrow lobes",
                of |scene, _| scene.has_narrow(),
                unspecialised |_| true;
            /// Some material absorbs light inside.
            absorption HAS_ABSORPTION: bool "absorption",
                of |_, census| census.flags & MATERIAL_HAS_ABSORPTION != 0,
                unspecialised |_| true;
            /// Some rough metal or rough glass gets back what it loses to multiple scattering.
            energy_compensation HAS_ENERGY_COMPENSATION: bool "energy compensation",
                of |_, census| census.flags & MATERIAL_IS_COMPENSATED != 0,
                unspecialised |_| true;
            /// Some emitting triangle is large beside the scene: triangles are sampled by solid angle where that is large. A choice for
            /// the scene rather than a need.
            large_lights HAS_LARGE_LIGHTS: bool "large lights",
                of |scene, _| scene.lights.iter().any(|light| is_large(light, scene)),
                unspecialised |own| own;
            /// Lights are selected from a tree: a choice for the scene rather than a need.
            light_tree HAS_LIGHT_TREE: bool "light tree",
                of |scene, _| !scene.light_tree.is_empty(),
                unspecialised |own| own;
            /// Some emission is textured or masked.
            textured_lights HAS_TEXTURED_LIGHTS: bool "textured lights",
                of |scene, _| scene.surfaces.iter().any(emits_by_texture),
                unspecialised |_| true;
            /// Some surface emits from both sides.
            lights_behind HAS_LIGHTS_BEHIND: bool "two-sided lights",
                of |scene, _| scene.surfaces.iter().any(|surface| surface.flags & SURFACE_EMITS_BEHIND != 0),
                unspecialised |_| true;
            /// The background emits.
            background HAS_BACKGROUND: bool "background",
                of |scene, _| scene.background.is_some(),
                unspecialised |_| true;
            /// The background is an image.
            environment HAS_ENVIRONMENT: bool "environment image",
                of |scene, _| scene.environment.is_some(),
                unspecialised |_| true;
            /// Some spot light shines through a texture.
            textured_spots HAS_TEXTURED_SPOTS: bool,
                of |scene, _| scene.lights.iter().any(|light| light.kind == LIGHT_SPOT && light.source != NONE),
                unspecialised |_| true;
            /// The formats of texels that there are: bit `TEXELS_*`.
            texel_formats TEXEL_FORMATS: uint,
                of |scene, _| texture_bits(scene, |texture| 1 << texture.format),
                unspecialised |_| u32::MAX;
            /// The ways that textures go on outside of themselves: bit `WRAP_*`.
            wraps WRAPS: uint,
                of |scene, _| texture_bits(scene, |texture| 1 << (texture.sampling & 0xff) | 1 << (texture.sampling >> 8 & 0xff)),
                unspecialised |_| u32::MAX;
            /// Entries of the light table; `NONE` leaves their number to be read.
            light_count LIGHT_COUNT: uint,
                of |scene, _| scene.lights.len() as u32,
                unspecialised |_| NONE;
            /// Surfaces of the scene; `NONE` leaves their number to be read.
            surface_count SURFACE_COUNT: uint,
                of |scene, _| scene.surfaces.len() as u32,
                unspecialised |_| NONE;
            /// Materials of the scene; `NONE` leaves their number to be read.
            material_count MATERIAL_COUNT: uint,
                of |scene, _| scene.materials.len() as u32,
                unspecialised |_| NONE;
        }
    };
}
pub(crate) use features;
