//! Every struct, constant and binding that the host and the shaders share, from one source.
//!
//! `build.rs` includes this file, writes [`glsl`] to `generated/layout.glsl`, and each shader includes that; so a field
//! that is added here exists on both sides or on neither. `tests/layout.rs` reads the compiled SPIR-V back and compares
//! each member's offset with the host's.
//!
//! Rules: scalar block layout; each shared struct has alignment 4, so that it has no padding on either side; a device
//! address is a [`uvec2`] (low word, high word); lengths in scene units, angles in radians, radiance in W/(m² sr) per
//! colour channel (linear sRGB primaries).

#![allow(non_camel_case_types)]

/// A GLSL `float`.
pub type float = f32;
/// A GLSL `uint`.
pub type uint = u32;
/// A GLSL `vec2`.
pub type vec2 = [f32; 2];
/// A GLSL `vec3`, 12 bytes under scalar layout.
pub type vec3 = [f32; 3];
/// A GLSL `vec4`.
pub type vec4 = [f32; 4];
/// A GLSL `uvec3`.
pub type uvec3 = [u32; 3];
/// A GLSL `uvec2`; also a 64-bit device address, low word first.
pub type uvec2 = [u32; 2];

/// A 64-bit device address as the shared structs hold it.
pub const fn address(value: u64) -> uvec2 {
    [value as u32, (value >> 32) as u32]
}

/// One member of a shared struct, as the host lays it out.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    /// The member's name, the same on both sides.
    pub name: &'static str,
    /// Bytes from the start of the struct.
    pub offset: usize,
}

/// One shared struct: its GLSL text and the host's layout of it.
#[derive(Clone, Copy, Debug)]
pub struct SharedStruct {
    /// The struct's name, the same on both sides.
    pub name: &'static str,
    /// Bytes of one element of an array of it.
    pub size: usize,
    /// Its members in order.
    pub members: &'static [Member],
    /// Its declaration in GLSL.
    pub glsl: &'static str,
}

macro_rules! shared_structs {
    ($(
        $(#[doc = $doc:literal])*
        pub struct $name:ident { $( $(#[doc = $member_doc:literal])* $member:ident : $kind:ident ),* $(,)? }
    )*) => {
        $(
            $(#[doc = $doc])*
            #[repr(C)]
            #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
            pub struct $name { $( $(#[doc = $member_doc])* pub $member: $kind ),* }
            const _: () = assert!(align_of::<$name>() == 4, "a shared struct has alignment 4");
        )*

        /// Every shared struct, in the order of declaration.
        pub const STRUCTS: &[SharedStruct] = &[$(
            SharedStruct {
                name: stringify!($name),
                size: size_of::<$name>(),
                members: &[$( Member { name: stringify!($member), offset: std::mem::offset_of!($name, $member) } ),*],
                glsl: concat!(
                    "struct ", stringify!($name), " {\n",
                    $( "    ", stringify!($kind), " ", stringify!($member), ";\n", )*
                    "};\n"
                ),
            },
        )*];
    };
}

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
        /// the probability of picking that sphere, whose points are then picked by solid angle.
        light_density: float,
        /// Texture that multiplies the emission, or [`NONE`].
        emission_texture: uint,
        /// Share of light that the surface stops; the rest passes straight through, whatever the material.
        opacity: float,
        /// Texture that multiplies the opacity, or [`NONE`].
        opacity_texture: uint,
        /// With an opacity texture: where above 0, opacities below it count as 0 and others as 1.
        opacity_cutoff: float,
    }

    /// The parameters of one BSDF; which of them count depends on `kind`.
    pub struct Material {
        /// One of the `MATERIAL_*` constants.
        kind: uint,
        /// The `MASKING_*` and `MATERIAL_HAS_*` bits.
        flags: uint,
        /// Index of what does not fit here: into the blends, plastics, principleds or layereds, by `kind`.
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

    /// The textures of a material. Each multiplies (colours, weights) or replaces (roughness) what the material says.
    pub struct MaterialTextures {
        /// Of the reflectance or base colour, or [`NONE`].
        reflectance: uint,
        /// Of the transmittance, or of a plastic's specular reflectance.
        transmittance: uint,
        /// Of the roughness along both tangents: alpha, or perceptual roughness of principled and layered materials.
        roughness: uint,
        /// Of the metalness.
        metallic: uint,
        /// Tangent-space normals.
        normal: uint,
        /// Factor on the first two components of those normals.
        normal_scale: float,
        /// Height that displaces the surface (bump map).
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
        /// Colour of the sheen.
        sheen_colour: vec3,
        /// Its perceptual roughness.
        sheen_roughness: float,
        /// Absorption inside, 1/m per channel.
        absorption: vec3,
        /// 1: refracts as the boundary of a volume; 0: light passes straight through a thin wall.
        is_volume: uint,
        /// Texture whose alpha multiplies `specular`, or [`NONE`].
        specular_texture: uint,
        /// Texture of the specular colour.
        specular_colour_texture: uint,
        /// Texture whose red multiplies the transmission.
        transmission_texture: uint,
        /// Texture whose red multiplies the clear coat.
        clearcoat_texture: uint,
        /// Texture whose green multiplies the clear coat's roughness.
        clearcoat_roughness_texture: uint,
        /// Texture of the sheen's colour.
        sheen_colour_texture: uint,
        /// Texture whose alpha multiplies the sheen's roughness.
        sheen_roughness_texture: uint,
    }

    /// Values over texture coordinates: texels, or a pattern.
    pub struct Texture {
        /// One of the `TEXTURE_*` kinds.
        kind: uint,
        /// One of the `TEXELS_*` formats.
        format: uint,
        /// Device address of the texels, row by row from the first.
        texels: uvec2,
        /// Texels across.
        width: uint,
        /// Texels down.
        height: uint,
        /// One of the `WRAP_*` constants for each direction, 8 bits each; then [`FILTER_NEAREST_BIT`].
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
        /// Probability of keeping this entry once it is drawn ...
        keep: float,
        /// ... and the entry to take instead.
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
        /// Alias table (Walker 1977): probability of keeping this entry once it is drawn ...
        keep: float,
        /// ... and the entry to take instead.
        alias: uint,
        /// Area light: its surface. Spot, projector: texture that multiplies the intensity, or [`NONE`].
        source: uint,
        /// Triangle with a texture: the vertices' texture coordinates in the vertex attributes. Spot, projector: the
        /// light's frame, three floats each, in the float tables.
        corners: uvec3,
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

    /// What stays the same through one rendering: the beginning of the uniform buffer at [`BINDING_SCENE`]. After it come
    /// [`UNIFORM_SURFACES`] surfaces, [`UNIFORM_MATERIALS`] materials and [`UNIFORM_LIGHTS`] lights, for scenes that have
    /// no more than that of a kind.
    pub struct SceneUniforms {
        /// Camera position.
        camera_origin: vec3,
        /// Direction through the corner (0, 0) of the image; not of unit length.
        camera_corner: vec3,
        /// Change of that direction per pixel to the right.
        camera_dx: vec3,
        /// Change of it per pixel down.
        camera_dy: vec3,
        /// Change of the ray's origin per unit of lens, along the image; zero for a pinhole. For an orthographic camera,
        /// change of the origin per pixel to the right.
        lens_x: vec3,
        /// The same down the image.
        lens_y: vec3,
        /// Distance along the viewing direction at which a thin lens is in focus, in lengths of it.
        focus: float,
        /// Radiance of the background, or the factor on its texture.
        background: vec3,
        /// Texture of the background, or [`NONE`].
        background_texture: uint,
        /// World to background space, first row.
        background_x: vec3,
        /// World to background space, second row.
        background_y: vec3,
        /// World to background space, third row.
        background_z: vec3,
        /// Cells of the background's alias table, across and down.
        background_cells: uvec2,
        /// Device address of that table: one [`AliasEntry`] per cell, row by row.
        background_table: uvec2,
        /// Probability of selecting the background as the light to sample.
        background_probability: float,
        /// Device address of the `bvh` nodes (80 bytes each; instances first, then each group).
        nodes: uvec2,
        /// Device address of the [`Primitive`]s.
        primitives: uvec2,
        /// Device address of the [`Corners`], one per primitive; 0 where no mesh has vertex attributes.
        corners: uvec2,
        /// Device address of the vertex normals, three floats each.
        normals: uvec2,
        /// Device address of the texture coordinates, two floats each.
        uvs: uvec2,
        /// Device address of the tangents, four floats each: direction, and the sign of the bitangent.
        tangents: uvec2,
        /// Device address of the vertex colours, four floats each.
        colours: uvec2,
        /// Device address of the [`Surface`]s.
        surfaces: uvec2,
        /// Device address of the [`Material`]s.
        materials: uvec2,
        /// Device address of the [`MaterialTextures`].
        material_textures: uvec2,
        /// Device address of the [`Blend`]s.
        blends: uvec2,
        /// Device address of the [`Plastic`]s.
        plastics: uvec2,
        /// Device address of the [`Principled`]s.
        principleds: uvec2,
        /// Device address of the [`Layered`]s.
        layereds: uvec2,
        /// Device address of the [`Texture`]s.
        textures: uvec2,
        /// Device address of tables of floats; the first 256 decode 8-bit sRGB.
        tables: uvec2,
        /// Entries of the light table.
        light_count: uint,
        /// Device address of the [`Light`]s.
        lights: uvec2,
        /// Device address of the [`Instance`]s.
        instances: uvec2,
        /// Parameters of the pixel filter: tent (radius, 0); Gaussian (standard deviation, radius); Mitchell (B, C).
        filter_parameters: vec2,
        /// One over the filter's integral.
        filter_scale: float,
        /// Device address of the positions that divide the integral of the filter's absolute value into
        /// [`FILTER_CELLS`] equal parts.
        filter_table: uvec2,
    }

    /// What changes from one dispatch to the next: the push constants.
    pub struct FrameConstants {
        /// Device address of the [`FilmPixel`]s.
        film: uvec2,
        /// Device address of the per-length layers: for each pixel, `LENGTH_LAYERS` times six floats (sum, its low part).
        lengths: uvec2,
        /// Device address of the one [`Tally`].
        tally: uvec2,
        /// First slot of this dispatch: pixels in tiles of 8 x 8, row by row.
        first_slot: uint,
        /// Slots of this dispatch.
        slot_count: uint,
        /// First sample of each pixel in this dispatch.
        first_sample: uint,
        /// Samples of each pixel in this dispatch.
        sample_count: uint,
        /// Width of the image in pixels.
        width: uint,
        /// Height of the image in pixels.
        height: uint,
        /// Seed of the random numbers.
        seed: uint,
    }

    /// Sums over the samples of one pixel: a value is the sum of a float and its low part (Knuth's two-sum).
    pub struct FilmPixel {
        /// Sum of the samples.
        sum: vec3,
        /// Its low part.
        sum_low: vec3,
        /// Sum of their squares.
        squares: vec3,
        /// Its low part.
        squares_low: vec3,
    }

    /// A sample that was not finite: where it was.
    pub struct BadSample {
        /// Pixel index, y * width + x.
        pixel: uint,
        /// Sample index within the pixel.
        sample_index: uint,
    }

    /// Counters that the host reads and clears after every frame.
    pub struct Tally {
        /// Samples that were dropped because they were not finite; the first [`BAD_SAMPLES`] are listed after it.
        bad_samples: uint,
    }

    /// A ray and what to report of it, for the kernels that tests and `lumbre rays` run.
    pub struct RayRecord {
        /// Origin.
        origin: vec3,
        /// Direction; distances are in units of its length.
        direction: vec3,
        /// Largest distance that counts.
        t_max: float,
    }

    /// The answer to a [`RayRecord`].
    pub struct HitRecord {
        /// Distance in units of the direction's length, negative where nothing was hit.
        t: float,
        /// Primitive index, in the order of the uploaded primitives.
        primitive: uint,
        /// Instance index.
        instance: uint,
        /// Barycentric weight of the second vertex.
        u: float,
        /// Barycentric weight of the third vertex.
        v: float,
        /// 1 where `trace_any` found the ray blocked.
        blocked: uint,
    }

    /// Directions and uniform numbers to ask a BSDF about.
    pub struct BsdfQuery {
        /// Index of the material.
        material: uint,
        /// Outgoing direction, local.
        wo: vec3,
        /// Incident direction to evaluate, local.
        wi: vec3,
        /// Numbers to sample another one with.
        u: vec3,
    }

    /// The answer to a [`BsdfQuery`].
    pub struct BsdfAnswer {
        /// f |cos| of the query's directions.
        value: vec3,
        /// Density of the query's incident direction.
        pdf_w: float,
        /// The sampled incident direction.
        sampled: vec3,
        /// f |cos| / density of the sampled direction.
        weight: vec3,
        /// Density of the sampled direction.
        sampled_pdf_w: float,
        /// f |cos| of the sampled direction, evaluated.
        sampled_value: vec3,
        /// Density of the sampled direction, evaluated.
        evaluated_pdf_w: float,
        /// 1 where the sampled lobe is a delta.
        delta: uint,
    }

    /// A point that light is sampled at, and a direction to look in from there.
    pub struct LightQuery {
        /// The point, in coordinates of the scene's arrays.
        point: vec3,
        /// The direction, unit.
        direction: vec3,
        /// Numbers to sample a light with.
        u: vec4,
    }

    /// The answer to a [`LightQuery`].
    pub struct LightAnswer {
        /// The sampled direction.
        wi: vec3,
        /// Radiance / density of the sample; of a delta light, irradiance on a facing surface / probability.
        weight: vec3,
        /// Density of the sample over solid angle; 0 where there is none.
        pdf_w: float,
        /// 1 where no direction hits the sampled light by chance.
        delta: uint,
        /// 1 where nothing stands between the point and the sample.
        visible: uint,
        /// Emission that a ray in the sampled direction finds.
        found: vec3,
        /// Density of choosing what it finds.
        found_pdf_w: float,
        /// Emission in the query's direction.
        asked: vec3,
        /// Density of choosing what lies there.
        asked_pdf_w: float,
    }

    /// A coordinate of the random numbers.
    pub struct RandomQuery {
        /// Pixel index.
        pixel: uint,
        /// Sample index.
        sample_index: uint,
        /// Block of four dimensions.
        dimension: uint,
        /// Seed.
        seed: uint,
    }
}

/// A constant with the same name and value on both sides.
#[derive(Clone, Copy, Debug)]
pub struct SharedConstant {
    /// The constant's name.
    pub name: &'static str,
    /// Its value.
    pub value: u32,
}

macro_rules! shared_constants {
    ($( $(#[doc = $doc:literal])* pub const $name:ident = $value:expr; )*) => {
        $( $(#[doc = $doc])* pub const $name: u32 = $value; )*
        /// Every shared constant.
        pub const CONSTANTS: &[SharedConstant] = &[$( SharedConstant { name: stringify!($name), value: $name } ),*];
    };
}

shared_constants! {
    /// No index.
    pub const NONE = u32::MAX;
    /// Flag on [`Primitive::surface`]: the primitive is a sphere.
    pub const SPHERE_BIT = 0x8000_0000;
    /// Flag on [`Primitive::surface`]: the triangle has vertex normals.
    pub const SMOOTH_BIT = 0x4000_0000;
    /// The bits of [`Primitive::surface`] that index the surfaces.
    pub const SURFACE_MASK = 0x0fff_ffff;
    /// Flag on [`Primitive::surface`]: the triangle has texture coordinates.
    pub const UV_BIT = 0x2000_0000;
    /// Flag on [`Primitive::surface`]: the triangle has tangents.
    pub const TANGENT_BIT = 0x1000_0000;

    /// Lambertian reflection.
    pub const MATERIAL_DIFFUSE = 0;
    /// A mirror of metal.
    pub const MATERIAL_CONDUCTOR = 1;
    /// A rough metal (GGX).
    pub const MATERIAL_ROUGH_CONDUCTOR = 2;
    /// Smooth glass.
    pub const MATERIAL_DIELECTRIC = 3;
    /// Rough glass (GGX).
    pub const MATERIAL_ROUGH_DIELECTRIC = 4;

    /// A thin sheet of glass, met once.
    pub const MATERIAL_THIN_DIELECTRIC = 5;
    /// A diffuse base under a smooth coating.
    pub const MATERIAL_PLASTIC = 6;
    /// A diffuse base under a rough coating (GGX).
    pub const MATERIAL_ROUGH_PLASTIC = 7;
    /// Burley's principled BSDF.
    pub const MATERIAL_PRINCIPLED = 8;
    /// The layered material of glTF.
    pub const MATERIAL_LAYERED = 9;
    /// One of two materials, by chance.
    pub const MATERIAL_BLEND = 10;
    /// Kinds of material.
    pub const MATERIAL_KINDS = 11;

    /// Flag on [`Material::flags`]: microfacets mask each other with correlated heights.
    pub const MASKING_CORRELATED = 1;
    /// Flag on [`Material::flags`]: microfacet slopes are Beckmann's instead of GGX's.
    pub const MICROFACET_BECKMANN = 2;
    /// Flag on [`Material::flags`]: light passes through, so the material is the same from both sides.
    pub const MATERIAL_HAS_TRANSMISSION = 4;
    /// Flag on [`Material::flags`]: the shading frame must follow the texture coordinates.
    pub const MATERIAL_HAS_TANGENTS = 8;
    /// Flag on [`Material::flags`]: light that crosses it is weighted by what it absorbs inside.
    pub const MATERIAL_HAS_ABSORPTION = 16;
    /// Flag on [`Material::flags`]: vertex colours multiply the reflectance.
    pub const MATERIAL_HAS_COLOURS = 32;

    /// A texture of texels.
    pub const TEXTURE_IMAGE = 0;
    /// A texture of two colours in squares.
    pub const TEXTURE_CHECKERBOARD = 1;
    /// Texels of four bytes: sRGB red, green and blue, linear alpha.
    pub const TEXELS_SRGB8 = 0;
    /// Texels of four bytes, linear.
    pub const TEXELS_LINEAR8 = 1;
    /// Texels of four floats.
    pub const TEXELS_FLOAT = 2;
    /// Coordinates outside of the texture repeat it.
    pub const WRAP_REPEAT = 0;
    /// They repeat it mirrored.
    pub const WRAP_MIRROR = 1;
    /// They see its edge.
    pub const WRAP_CLAMP = 2;
    /// Flag on [`Texture::sampling`]: the nearest texel instead of bilinear interpolation.
    pub const FILTER_NEAREST_BIT = 0x10000;
    /// Cells of a rough plastic's table of transmittance.
    pub const PLASTIC_CELLS = 64;

    /// A triangle that emits from its front.
    pub const LIGHT_TRIANGLE = 0;
    /// A sphere that emits outwards.
    pub const LIGHT_SPHERE = 1;
    /// An isotropic point.
    pub const LIGHT_POINT = 2;
    /// A point with a cone.
    pub const LIGHT_SPOT = 3;
    /// Parallel light from infinitely far.
    pub const LIGHT_DIRECTIONAL = 4;
    /// A point that projects a texture.
    pub const LIGHT_PROJECTOR = 5;
    /// Kinds of light.
    pub const LIGHT_KINDS = 6;

    /// All rays begin in one point.
    pub const CAMERA_PINHOLE = 0;
    /// Rays begin on a lens and meet in the plane of focus.
    pub const CAMERA_THIN_LENS = 1;
    /// All rays are parallel.
    pub const CAMERA_ORTHOGRAPHIC = 2;

    /// Constant over the pixel.
    pub const FILTER_BOX = 0;
    /// Falls linearly.
    pub const FILTER_TENT = 1;
    /// A Gaussian cut off and lowered to zero there.
    pub const FILTER_GAUSSIAN = 2;
    /// The cubic of Mitchell and Netravali.
    pub const FILTER_MITCHELL = 3;

    /// Descriptor binding of [`SceneUniforms`].
    pub const BINDING_SCENE = 0;
    /// Descriptor binding of the top-level acceleration structure (`ray-query` only).
    pub const BINDING_TLAS = 1;

    /// Surfaces that the uniform buffer has room for.
    pub const UNIFORM_SURFACES = 16;
    /// Materials that the uniform buffer has room for.
    pub const UNIFORM_MATERIALS = 16;
    /// Lights that the uniform buffer has room for.
    pub const UNIFORM_LIGHTS = 8;

    /// Threads of a workgroup; pixels go to it in tiles of 8 x 8.
    pub const WORKGROUP = 64;
    /// Cells that the pixel filter's table divides it into.
    pub const FILTER_CELLS = 64;
    /// Non-finite samples that are located; more are only counted.
    pub const BAD_SAMPLES = 16;
    /// Counters over which the rays of a dispatch are spread, so that threads seldom meet.
    pub const RAY_COUNTERS = 64;
    /// The largest number of triangles that a kernel can hold as constants.
    pub const INLINE_MAX = 48;
    /// Bounces that `lumbre rays` follows its paths for.
    pub const RAY_BOUNCES = 3;
    /// Bytes of one node of the compressed wide BVH.
    pub const NODE_BYTES = 80;
}

/// One specialisation constant: chosen when a pipeline is made, a compile-time constant to the driver.
#[derive(Clone, Copy, Debug)]
pub struct SpecialisationConstant {
    /// The constant's name in GLSL.
    pub name: &'static str,
    /// Its `constant_id`.
    pub id: u32,
    /// `bool`, `uint` or `float`.
    pub kind: &'static str,
}

macro_rules! specialisation {
    ($( $(#[doc = $doc:literal])* $id:literal $field:ident $name:ident : $kind:ident; )*) => {
        /// The values of all specialisation constants except the inline geometry.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Specialisation { $( $(#[doc = $doc])* pub $field: $kind ),* }

        /// Every specialisation constant except the inline geometry.
        pub const SPECIALISATION: &[SpecialisationConstant] = &[$(
            SpecialisationConstant { name: stringify!($name), id: $id, kind: stringify!($kind) }
        ),*];

        impl Specialisation {
            /// The constants as (id, 32-bit pattern), which is what a pipeline takes.
            pub fn words(&self) -> Vec<(u32, u32)> {
                vec![$( ($id, self.$field.word()) ),*]
            }

            /// Whether it does without everything that a lean module lacks.
            pub fn is_lean(&self) -> bool {
                let all = [$( (stringify!($name), self.$field.word()) ),*];
                all.iter().all(|(name, word)| *word == 0 || !RARE.contains(name))
            }
        }
    };
}

/// The 32-bit pattern of a specialisation constant.
trait Word {
    fn word(self) -> u32;
}
impl Word for bool {
    fn word(self) -> u32 {
        u32::from(self)
    }
}
impl Word for uint {
    fn word(self) -> u32 {
        self
    }
}
impl Word for float {
    fn word(self) -> u32 {
        self.to_bits()
    }
}

specialisation! {
    /// Some group is placed by an affine map, so traversal has two levels.
    0 instances HAS_INSTANCES: bool;
    /// Some primitive is a sphere.
    1 spheres HAS_SPHERES: bool;
    /// Some mesh has vertex normals.
    2 normals HAS_NORMALS: bool;
    /// Some surface has a material on its back.
    3 back_materials HAS_BACK_MATERIALS: bool;
    /// Some material is diffuse.
    4 diffuse HAS_DIFFUSE: bool;
    /// Some material is a smooth conductor.
    5 conductor HAS_CONDUCTOR: bool;
    /// Some material is a rough conductor.
    6 rough_conductor HAS_ROUGH_CONDUCTOR: bool;
    /// Some material is a smooth dielectric.
    7 dielectric HAS_DIELECTRIC: bool;
    /// Some material is a rough dielectric.
    8 rough_dielectric HAS_ROUGH_DIELECTRIC: bool;
    /// Some triangle emits.
    9 triangle_lights HAS_TRIANGLE_LIGHTS: bool;
    /// Some sphere emits.
    10 sphere_lights HAS_SPHERE_LIGHTS: bool;
    /// There is a point light.
    11 point_lights HAS_POINT_LIGHTS: bool;
    /// There is a spot light.
    12 spot_lights HAS_SPOT_LIGHTS: bool;
    /// There is a directional light.
    13 directional_lights HAS_DIRECTIONAL_LIGHTS: bool;
    /// The background emits.
    14 background HAS_BACKGROUND: bool;
    /// Entries of the light table.
    15 light_count LIGHT_COUNT: uint;
    /// The pixel filter, one of the `FILTER_*` constants.
    16 filter FILTER: uint;
    /// Layers by path length, 0 for none; the last one also takes every longer path.
    17 length_layers LENGTH_LAYERS: uint;
    /// Longest path in segments; `NONE` is no limit.
    18 max_depth MAX_DEPTH: uint;
    /// Segments after which Russian roulette may end a path.
    19 rr_depth RR_DEPTH: uint;
    /// Entries of the traversal stack.
    20 stack_size STACK_SIZE: uint;
    /// Read nodes and primitives in 64-bit words (faster on CPU devices) rather than in vectors of 32-bit words.
    21 wide_loads WIDE_LOADS: bool;
    /// Find the traversal stack's top by comparison (faster on CPU devices) rather than by address.
    23 select_stack SELECT_STACK: bool;
    /// Triangles that the kernel holds as constants; 0 reads them from memory through the BVH.
    22 inline_count INLINE_COUNT: uint;
    /// Surfaces of the scene.
    28 surface_count SURFACE_COUNT: uint;
    /// Materials of the scene.
    29 material_count MATERIAL_COUNT: uint;
    /// Some material is a thin dielectric.
    30 thin_dielectric HAS_THIN_DIELECTRIC: bool;
    /// Some material is smooth plastic.
    31 plastic HAS_PLASTIC: bool;
    /// Some material is rough plastic.
    32 rough_plastic HAS_ROUGH_PLASTIC: bool;
    /// Some material is principled.
    33 principled HAS_PRINCIPLED: bool;
    /// Some material is layered.
    34 layered HAS_LAYERED: bool;
    /// Some material is a blend.
    35 blends HAS_BLENDS: bool;
    /// Some material has textures.
    36 material_textures HAS_MATERIAL_TEXTURES: bool;
    /// Something reads texture coordinates.
    37 uvs HAS_UVS: bool;
    /// Some shading frame follows the texture coordinates.
    38 tangents HAS_TANGENTS: bool;
    /// Some surface lets light pass straight through.
    39 masks HAS_MASKS: bool;
    /// Some emission is textured.
    40 textured_lights HAS_TEXTURED_LIGHTS: bool;
    /// Some light projects a texture.
    41 projectors HAS_PROJECTORS: bool;
    /// The background is an image.
    42 environment HAS_ENVIRONMENT: bool;
    /// Some microfacets are Beckmann's.
    43 beckmann HAS_BECKMANN: bool;
    /// Some material absorbs light inside.
    44 absorption HAS_ABSORPTION: bool;
    /// Some mesh has vertex colours.
    45 colours HAS_COLOURS: bool;
    /// The camera, one of the `CAMERA_*` constants.
    46 camera CAMERA: uint;
    /// Some emitting triangle is large beside the scene: triangles are sampled by solid angle where that is large.
    60 large_lights HAS_LARGE_LIGHTS: bool;
    /// First parameter of the technique.
    24 param0 PARAM0: uint;
    /// Second parameter of the technique.
    25 param1 PARAM1: uint;
    /// Third parameter of the technique.
    26 param2 PARAM2: uint;
    /// Fourth parameter of the technique.
    27 param3 PARAM3: uint;
}

/// What many scenes do without: in a lean module these are false already, because a driver takes its time to read and drop
/// what a specialisation leaves out.
pub const RARE: &[&str] = &[
    "HAS_THIN_DIELECTRIC",
    "HAS_PLASTIC",
    "HAS_ROUGH_PLASTIC",
    "HAS_PRINCIPLED",
    "HAS_LAYERED",
    "HAS_BLENDS",
    "HAS_MATERIAL_TEXTURES",
    "HAS_UVS",
    "HAS_TANGENTS",
    "HAS_MASKS",
    "HAS_TEXTURED_LIGHTS",
    "HAS_PROJECTORS",
    "HAS_ENVIRONMENT",
    "HAS_BECKMANN",
    "HAS_ABSORPTION",
    "HAS_COLOURS",
];

/// `constant_id` of the first coordinate of the inline geometry: triangle i has the nine from `INLINE_FIRST_ID + 9 i`.
pub const INLINE_FIRST_ID: u32 = 100;

/// The text of `generated/layout.glsl`.
pub fn glsl() -> String {
    let mut text = String::from("// Generated from src/layout.rs.\n\n");
    for constant in CONSTANTS {
        text += &format!("const uint {} = {}u;\n", constant.name, constant.value);
    }
    text.push('\n');
    for constant in SPECIALISATION {
        let default = if constant.kind == "bool" { "false" } else { "1" }; // 1: some are sizes of arrays
        let special =
            format!("layout(constant_id = {}) const {} {} = {default};\n", constant.id, constant.kind, constant.name);
        if RARE.contains(&constant.name) {
            text += &format!("#ifdef LEAN\nconst bool {} = false;\n#else\n{special}#endif\n", constant.name);
        } else {
            text += &special;
        }
    }
    text.push('\n');
    for shared in STRUCTS {
        text += shared.glsl;
        text.push('\n');
    }
    text
}

/// The text of `generated/inline.glsl`: `INLINE_TRIANGLES(visit)` calls `visit(index, v0, v1, v2)` for each triangle that
/// the kernel holds as constants. Straight-line on purpose: a loop over constants is a loop over memory.
pub fn inline_glsl() -> String {
    let mut text = String::from("// Generated from src/layout.rs.\n\n");
    for coordinate in 0..9 * INLINE_MAX {
        text +=
            &format!("layout(constant_id = {}) const float INLINE_{coordinate} = 0;\n", INLINE_FIRST_ID + coordinate);
    }
    text += "\n#define INLINE_TRIANGLES(visit)";
    for triangle in 0..INLINE_MAX {
        let vertex = |k: u32| {
            let first = 9 * triangle + 3 * k;
            format!("vec3(INLINE_{}, INLINE_{}, INLINE_{})", first, first + 1, first + 2)
        };
        text += &format!(
            " \\\n    if (INLINE_COUNT > {triangle}u) visit({triangle}u, {}, {}, {})",
            vertex(0),
            vertex(1),
            vertex(2)
        );
    }
    text.push('\n');
    text
}
