//! What a scene is on the device: primitives, surfaces, materials, textures, lights, uniforms.

#[allow(unused_imports)] // named by the documentation
use super::constants::*;
use super::types::{Member, SharedStruct, float, uint, uvec2, uvec3, vec2, vec3, vec4};

shared_structs! {
    /// A triangle, or a sphere where `surface` has [`SPHERE_BIT`]: then `v0` is its centre and `v1[0]` its radius.
    /// Positions are in the space of the group that holds it.
    pub struct Primitive {
        /// First vertex, or the centre of a sphere.
        v0: vec3,
        /// Second vertex, or (radius, 0, 0).
        v1: vec3,
        /// Third vertex.
        v2: vec3,
        /// Index into the surfaces, with [`SPHERE_BIT`] and [`SMOOTH_BIT`] on top.
        surface: uint,
    }

    /// Where a triangle's vertex attributes lie: indices into the vertex normals and texture coordinates.
    pub struct Corners {
        /// The first vertex.
        i0: uint,
        /// The second vertex.
        i1: uint,
        /// The third vertex.
        i2: uint,
    }

    /// What a primitive is made of and what it emits.
    pub struct Surface {
        /// Material of the side that the normal points to, or [`NONE`], which reflects nothing.
        front: uint,
        /// Material of the other side, or [`NONE`]. Its frame is turned round, so it too sees light from above.
        back: uint,
        /// Emitted radiance of the front side, W/(m² sr).
        emission: vec3,
        /// Density with which light selection and sampling pick a point of it: per area (1/m²) on triangles; on a sphere
        /// the probability of picking that sphere, whose points are then picked by solid angle. Where lights are selected
        /// from a tree, times the probability that the tree gives.
        light_density: float,
        /// The way through the light tree to this light: the lowest bit is the turn at the root.
        light_trail: uint,
        /// The same of the light that its other side is, where that emits.
        light_trail_behind: uint,
        /// Density with which light subpaths begin at a point of it, per area (1/m²).
        emission_density: float,
        /// Texture that multiplies the emission, or [`NONE`].
        emission_texture: uint,
        /// Share of light that the surface stops; the rest passes straight through, whatever the material.
        opacity: float,
        /// Texture that multiplies the opacity, or [`NONE`].
        opacity_texture: uint,
        /// Where the opacity varies: above 0, opacities below it count as 0 and others as 1.
        opacity_cutoff: float,
        /// The `SURFACE_*` bits.
        flags: uint,
    }

    /// The parameters of one BSDF; which of them count depends on `kind`.
    pub struct Material {
        /// One of the `MATERIAL_*` constants.
        kind: uint,
        /// The `MASKING_*` and `MATERIAL_HAS_*` bits.
        flags: uint,
        /// Index of what does not fit here: into the blends, plastics, principleds, layereds or compensations, by `kind`.
        detail: uint,
        /// Index into the [`MaterialTextures`], or [`NONE`].
        textures: uint,
        /// GGX roughness along the first tangent.
        alpha_u: float,
        /// GGX roughness along the second tangent.
        alpha_v: float,
        /// Index of refraction of the inside over that of the outside.
        eta: float,
        /// Albedo of a diffuse material; factor on specular reflection elsewhere.
        reflectance: vec3,
        /// Factor on specular transmission.
        transmittance: vec3,
        /// Real part of a conductor's index of refraction, over that of the outside.
        conductor_eta: vec3,
        /// Imaginary part of it.
        conductor_k: vec3,
    }

    /// A texture that multiplies a property of a material.
    pub struct PropertyTexture {
        /// One of the `PROPERTY_*` constants.
        property: uint,
        /// Index of the texture.
        texture: uint,
    }

    /// The textures of a material.
    pub struct MaterialTextures {
        /// The first of its [`PropertyTexture`]s.
        first: uint,
        /// How many it has.
        count: uint,
        /// Tangent-space normals, or [`NONE`].
        normal: uint,
        /// Factor on the first two components of those normals.
        normal_scale: float,
        /// Height that displaces the surface (bump map), or [`NONE`].
        bump: uint,
        /// Factor on that height, in scene units.
        bump_scale: float,
    }

    /// Two materials, one of which a path meets by chance.
    pub struct Blend {
        /// Met with probability 1 - weight.
        first: uint,
        /// Met with probability `weight`.
        second: uint,
        /// The probability of the second.
        weight: float,
        /// Texture of the weight, or [`NONE`].
        weight_texture: uint,
    }

    /// A diffuse base under a smooth or rough dielectric coating.
    pub struct Plastic {
        /// Factor on the coating's reflection.
        specular: vec3,
        /// Diffuse Fresnel reflectance of the coating from inside: what the base's light is thrown back by.
        internal_reflectance: float,
        /// Probability, but for Fresnel, of sampling the coating.
        specular_weight: float,
        /// 1: light that is thrown back takes on the base's colour each time.
        nonlinear: uint,
        /// First of [`PLASTIC_CELLS`] values in the float tables: transmittance of a rough coating by cosine.
        table: uint,
    }

    /// What a rough metal or rough glass loses to multiple scattering, and how it comes back.
    pub struct Compensation {
        /// Cosine-weighted mean of the Fresnel reflectance: of a metal per channel; of glass from outside, then nothing.
        mean_fresnel: vec3,
        /// Where its table begins in the float tables: rows of a mean and [`COMPENSATION_CELLS`] values each, two of them for
        /// glass, outside and inside.
        table: uint,
        /// Rows; more than one where roughness is textured or anisotropic.
        rows: uint,
        /// Textured roughness: geometric mean of both alphas in the last row. 0: rows differ by azimuth.
        alpha: float,
    }

    /// Parameters of the principled BSDF (Burley 2012, 2015).
    pub struct Principled {
        /// 0: dielectric, 1: metal.
        metallic: float,
        /// Stretches the highlight along the tangent.
        anisotropic: float,
        /// Share of a dielectric's light that is refracted rather than scattered diffusely.
        spec_trans: float,
        /// How much the base colour tints the dielectric's reflection.
        spec_tint: float,
        /// Strength of the sheen.
        sheen: float,
        /// How much the base colour tints it.
        sheen_tint: float,
        /// Blends the diffuse lobe towards an approximation of subsurface scattering.
        flatness: float,
        /// Strength of the clear coat.
        clearcoat: float,
        /// Its glossiness.
        clearcoat_gloss: float,
        /// Of a thin sheet: twice the share of its diffuse light that passes through, 0 to 2.
        diff_trans: float,
    }

    /// Parameters of the layered material of glTF 2.0 (metallic-roughness and its extensions).
    pub struct Layered {
        /// 0: dielectric, 1: metal.
        metallic: float,
        /// Strength of the dielectric's reflection.
        specular: float,
        /// Colour of that reflection at normal incidence.
        specular_colour: vec3,
        /// Share of the dielectric's light that passes through rather than scatters diffusely.
        transmission: float,
        /// Strength of the clear coat.
        clearcoat: float,
        /// Its perceptual roughness.
        clearcoat_roughness: float,
        /// Its normal in the shading frame, unit: kernels fill it in where it is not the frame's.
        clearcoat_normal: vec3,
        /// Colour of the sheen.
        sheen_colour: vec3,
        /// Its perceptual roughness.
        sheen_roughness: float,
        /// Absorption inside, 1/m per channel.
        absorption: vec3,
        /// 1: refracts as the boundary of a volume; 0: light passes straight through a thin wall.
        is_volume: uint,
        /// How much wider its highlight is along one direction than across it, 0 to 1.
        anisotropy: float,
        /// That direction in the tangent frame, unit.
        anisotropy_direction: vec2,
        /// Strength of a thin film's interference.
        iridescence: float,
        /// Index of refraction of the film.
        iridescence_eta: float,
        /// Thickness of the film, nm.
        iridescence_thickness: float,
        /// Thickness where the texture of it is 0.
        iridescence_least: float,
        /// Share of the light that is scattered diffusely that comes out on the other side.
        diffuse_transmission: float,
        /// Colour of that light.
        diffuse_transmission_colour: vec3,
        /// How much the index of refraction depends on the wavelength: 20 over the Abbe number.
        dispersion: float,
        /// Map of the clear coat's normals, or [`NONE`].
        clearcoat_normal_texture: uint,
        /// Factor on the first two components of those.
        clearcoat_normal_scale: float,
    }

    /// Values over a surface: texels, a pattern, or what a mesh has at its vertices.
    pub struct Texture {
        /// One of the `TEXTURE_*` kinds.
        kind: uint,
        /// One of the `TEXELS_*` formats.
        format: uint,
        /// Device address of the texels, row by row from the first. Of an attribute: the index of the first vertex's value, then nothing. Of a checkerboard:
        /// the textures that its squares show instead of a colour, or [`NONE`].
        texels: uvec2,
        /// Texels across.
        width: uint,
        /// Texels down.
        height: uint,
        /// Levels of detail that follow each other from `texels` on, each half as wide and high as the one before, but at least
        /// one texel; 1 where there is only the image itself.
        levels: uint,
        /// One of the `WRAP_*` constants for each direction, 8 bits each; then [`FILTER_NEAREST_BIT`] and [`SECOND_UVS_BIT`].
        sampling: uint,
        /// Channel of a scalar: 0 to 3, or 4 for luminance.
        channel: uint,
        /// First row of the map from surface to texture coordinates.
        row_u: vec3,
        /// Second row of it.
        row_v: vec3,
        /// Factor on the values; the first colour of a checkerboard.
        scale: vec4,
        /// Added to the values; the second colour of a checkerboard.
        offset: vec4,
    }

    /// One entry of an alias table over texels.
    pub struct AliasEntry {
        /// Probability of keeping this entry once it is drawn.
        keep: float,
        /// The entry to take where this one is drawn and not kept.
        alias: uint,
        /// Density of this entry over the unit square of texture coordinates.
        density: float,
    }

    /// One entry of the light table; what its members mean depends on `kind`.
    pub struct Light {
        /// One of the `LIGHT_*` constants.
        kind: uint,
        /// Triangle: first vertex. Sphere: centre. Point, spot: position.
        position: vec3,
        /// Triangle: second vertex. Sphere: (radius, 0, 0). Spot, directional: unit direction in which light travels.
        v1: vec3,
        /// Triangle: third vertex. Spot: (cut-off angle, beam width, 1 for the falloff of glTF).
        v2: vec3,
        /// Area lights: radiance, W/(m² sr). Point, spot: intensity, W/sr. Directional: irradiance, W/m².
        radiance: vec3,
        /// Probability of being selected.
        probability: float,
        /// Alias table (Walker 1977) by which lights are selected: probability of keeping this entry once it is drawn.
        keep: float,
        /// The entry to take where this one is drawn and not kept.
        alias: uint,
        /// Area light: its surface. Spot, projector: texture that multiplies the intensity, or [`NONE`].
        source: uint,
        /// Triangle with a texture: the vertices' texture coordinates in the vertex attributes. Spot, projector: the
        /// light's frame, three floats each, in the float tables.
        corners: uvec3,
        /// The way through the light tree to this light, as [`Surface::light_trail`] has it.
        trail: uint,
        /// Probability that a light subpath begins at this light, in proportion to its power.
        emission_probability: float,
        /// Alias table over all lights, by which light subpaths begin: probability of keeping this entry once it is drawn.
        emission_keep: float,
        /// The entry to take where this one is drawn by `emission_keep` and not kept.
        emission_alias: uint,
        /// Absorption of the medium that it shines in, 1/m; of what is infinitely far, nothing.
        absorption: vec3,
    }

    /// A node of the light tree: bounds on the lights below it, in coordinates that the root's radius makes one.
    pub struct LightNode {
        /// Centre of the sphere around the places of the lights.
        centre: vec3,
        /// Its radius.
        radius: float,
        /// Axis of the cone of directions that they face, an octahedron unfolded to 2 x 12 bits; then, in 8 bits, the cosine of
        /// the angle to the direction that a light faces beyond which it sheds nothing.
        axis: uint,
        /// Cosine and sine of that cone's half angle, 16 bits each.
        facing: uint,
        /// Their greatest radiant intensities, as a share of all lights'.
        intensity: float,
        /// The first of two children, or, with [`LIGHT_LEAF_BIT`], the light.
        link: uint,
    }

    /// One placement of a group of primitives: an affine map and where the group's data begins.
    pub struct Instance {
        /// World from object, first row.
        world0: vec4,
        /// World from object, second row.
        world1: vec4,
        /// World from object, third row.
        world2: vec4,
        /// Object from world, first row.
        object0: vec4,
        /// Object from world, second row.
        object1: vec4,
        /// Object from world, third row.
        object2: vec4,
        /// `bvh`: the node at which the group's tree begins.
        root: uint,
        /// `ray-query`: the first primitive of the geometry that this instance places.
        first_primitive: uint,
        /// 0 where both maps are the identity, which rounds nothing.
        moved: uint,
    }
}
