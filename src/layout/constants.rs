//! Constants that both sides name: kinds, flags, bindings, sizes.

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
    /// Flag on [`Primitive::surface`](super::Primitive::surface): the primitive is a sphere.
    pub const SPHERE_BIT = 0x8000_0000;
    /// Flag on [`Primitive::surface`](super::Primitive::surface): the triangle has vertex normals.
    pub const SMOOTH_BIT = 0x4000_0000;
    /// The bits of [`Primitive::surface`](super::Primitive::surface) that index the surfaces.
    pub const SURFACE_MASK = 0x07ff_ffff;
    /// Flag on [`Primitive::surface`](super::Primitive::surface): the triangle has texture coordinates.
    pub const UV_BIT = 0x2000_0000;
    /// Flag on [`Primitive::surface`](super::Primitive::surface): the triangle has tangents.
    pub const TANGENT_BIT = 0x1000_0000;
    /// Flag on [`Primitive::surface`](super::Primitive::surface), on the device alone: the triangle before shares this one's longest edge, and
    /// leaves hold both.
    pub const PAIR_BIT = 0x0800_0000;

    /// Flag on [`Material::flags`](super::Material::flags): microfacets mask each other with correlated heights.
    pub const MASKING_CORRELATED = 1;
    /// Flag on [`Material::flags`](super::Material::flags): microfacet slopes are Beckmann's instead of GGX's.
    pub const MICROFACET_BECKMANN = 2;
    /// Flag on [`Material::flags`](super::Material::flags): light passes through, so the material is the same from both sides.
    pub const MATERIAL_HAS_TRANSMISSION = 4;
    /// Flag on [`Material::flags`](super::Material::flags): the shading basis must follow the texture coordinates.
    pub const MATERIAL_HAS_TANGENTS = 8;
    /// Flag on [`Material::flags`](super::Material::flags): light that crosses it is weighted by what it absorbs inside.
    pub const MATERIAL_HAS_ABSORPTION = 16;
    /// Flag on [`Material::flags`](super::Material::flags): vertex colours multiply the reflectance.
    pub const MATERIAL_HAS_COLOURS = 32;
    /// Flag on [`Material::flags`](super::Material::flags): what a rough metal or rough glass loses to multiple scattering comes back.
    pub const MATERIAL_IS_COMPENSATED = 64;
    /// Flag on [`Material::flags`](super::Material::flags) of a shader's own copy: narrow lobes take no part, see [`NARROW_ALPHA`](super::NARROW_ALPHA).
    pub const WITHOUT_NARROW_LOBES = 128;
    /// Flag on [`Material::flags`](super::Material::flags) of a shader's own copy: broad lobes take no part.
    pub const WITHOUT_BROAD_LOBES = 256;

    /// Flag on [`Material::flags`](super::Material::flags) of a shader's own copy: light comes along `wo`, where a BSDF is not reciprocal.
    pub const MATERIAL_IS_ADJOINT = 2048;
    /// Flag on [`Material::flags`](super::Material::flags): a mapped normal that the camera's side is below of is mirrored at the shading normal.
    pub const MATERIAL_FLIPS_NORMALS = 512;
    /// Flag on [`Material::flags`](super::Material::flags): the slopes of a mapped surface shadow each other.
    pub const MATERIAL_SHADOWS_NORMALS = 1024;

    /// Flag on [`Surface::flags`](super::Surface::flags): the other side emits the same.
    pub const SURFACE_EMITS_BEHIND = 1;
    /// Flag on [`Surface::flags`](super::Surface::flags): the alpha of vertex colours multiplies the opacity.
    pub const SURFACE_HAS_ALPHA_COLOURS = 2;

    /// A texture of texels.
    pub const TEXTURE_IMAGE = 0;
    /// A texture of two colours in squares.
    pub const TEXTURE_CHECKERBOARD = 1;
    /// A texture that shows an attribute of a mesh.
    pub const TEXTURE_ATTRIBUTE = 2;
    /// Texels of four bytes: sRGB red, green and blue, linear alpha.
    pub const TEXELS_SRGB8 = 0;
    /// Texels of four bytes, linear.
    pub const TEXELS_LINEAR8 = 1;
    /// Texels of four floats.
    pub const TEXELS_FLOAT = 2;
    /// Coordinates outside of the texture repeat it.
    pub const WRAP_REPEAT = 0;
    /// Coordinates outside of the texture repeat it mirrored.
    pub const WRAP_MIRROR = 1;
    /// Coordinates outside of the texture see the texel at its edge.
    pub const WRAP_CLAMP = 2;
    /// Flag on [`Texture::sampling`](super::Texture::sampling): the nearest texel instead of bilinear interpolation.
    pub const FILTER_NEAREST_BIT = 0x10000;
    /// Flag on [`Texture::sampling`](super::Texture::sampling): the second set of the surface's texture coordinates instead of the first.
    pub const SECOND_UVS_BIT = 0x20000;
    /// Cells of a rough plastic's table of transmittance.
    pub const PLASTIC_CELLS = 64;
    /// Values of a row of a [`Compensation`](super::Compensation)'s table.
    pub const COMPENSATION_CELLS = 129;

    /// Flag on [`LightNode::link`](super::LightNode::link): the node is one light.
    pub const LIGHT_LEAF_BIT = 0x8000_0000;

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
    /// A sinc, windowed by a wider one.
    pub const FILTER_LANCZOS = 4;

    /// Descriptor binding of [`SceneUniforms`](super::SceneUniforms).
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
    /// Longest path, in segments, that is made of a part from the light and one from the camera; longer ones come from the camera
    /// alone, so that the vertices of a light subpath have bounded room.
    pub const BIDIRECTIONAL_LENGTH = 16;
    /// Photons that are kept of one path; of a longer one they are a random choice.
    pub const PHOTONS_OF_PATH = 8;
    /// Flag on `FrameConstants::word` of radiosity, whose other bits are the rounds in which patches have passed light on before this one:
    /// each round adds light of one more segment.
    pub const PREPARING_BIT = 0x8000_0000;
    /// Sums of the film over blocks of samples are whole numbers of the splats' unit, moved down by so many bits.
    pub const BLOCK_SUM_BITS = 24;
    /// Sums of squares are whole numbers of the square of that unit, moved up by so many bits.
    pub const BLOCK_SQUARE_BITS = 12;
    /// Non-finite samples that are located; more are only counted.
    pub const BAD_SAMPLES = 16;
    /// Counters over which the rays of a dispatch are spread, so that threads seldom meet.
    pub const RAY_COUNTERS = 64;
    /// The largest number of primitives that a kernel can hold as constants.
    pub const INLINE_MAX = 48;
    /// Bounces that `lumbre rays` follows its paths for.
    pub const RAY_BOUNCES = 3;
    /// Bytes of one node of the compressed wide BVH.
    pub const NODE_BYTES = 80;
    /// Bytes of a `vec3`.
    pub const VEC3_BYTES = size_of::<super::vec3>() as u32;
    /// Bytes of a `vec4`.
    pub const VEC4_BYTES = size_of::<super::vec4>() as u32;
    /// Bytes of a 64-bit fixed-point sum for each colour channel, as splats and the power that patches shoot have it.
    pub const FIXED_RGB_BYTES = 3 * size_of::<i64>() as u32;
    /// A [`PathRecord`](super::PathRecord): a path begins, at the camera or at a light. `position`, `direction`; of a light `value` is its power, `pdf` the
    /// density of the place per area.
    pub const RECORD_BEGIN = 0;
    /// A [`PathRecord`](super::PathRecord): the path has arrived at a vertex. `position`, `normal`, `material`, `primitive`, `instance`, and the
    /// `throughput` up to there.
    pub const RECORD_VERTEX = 1;
    /// A [`PathRecord`](super::PathRecord): a light is sampled from the vertex. `direction` to it, `value` f |cos|, `throughput` radiance over density, `pdf` of
    /// the light sample and `other_pdf` of the BSDF over solid angle, `weight`, and `probability`, the share of light that comes through (of the three channels the mean).
    pub const RECORD_LIGHT_SAMPLE = 2;
    /// A [`PathRecord`](super::PathRecord): the path has run into a light. `value` is the emitted radiance, `pdf` of the BSDF, `other_pdf` of a light
    /// sample, `weight`.
    pub const RECORD_EMISSION = 3;
    /// A [`PathRecord`](super::PathRecord): the path goes on. `direction`, `value` f |cos| / pdf, `throughput` after it, `pdf`, of a delta lobe the
    /// probability of choosing it.
    pub const RECORD_SCATTER = 4;
    /// A [`PathRecord`](super::PathRecord): Russian roulette. `probability` to survive; [`RECORDED_ENDS`] where it does not.
    pub const RECORD_ROULETTE = 5;
    /// A [`PathRecord`](super::PathRecord): a strategy (s, t), `value` unweighted, `weight`. With [`RECORDED_MERGED`] the subpaths were merged; with
    /// [`RECORDED_CANDIDATE`] it is one of those that one is chosen of, visibility not tested.
    pub const RECORD_STRATEGY = 6;
    /// A [`PathRecord`](super::PathRecord): what a path of `vertex` segments adds to the sample.
    pub const RECORD_CONTRIBUTION = 7;
    /// A [`PathRecord`](super::PathRecord): what the light subpath or chain `vertex` adds to the pixel from elsewhere: `value`, weighted.
    pub const RECORD_SPLAT = 8;
    /// A [`PathRecord`](super::PathRecord): the sample is finished, its `value` goes to the film.
    pub const RECORD_VALUE = 9;
    /// A [`PathRecord`](super::PathRecord): a chain visits the pixel: `s` chain, `t` mutation, `value` the path's contribution, `vertex` the
    /// mutation that proposed it, `weight` probability of the visit, `probability` with which the proposal is accepted; [`RECORDED_PROPOSAL`] where it is the
    /// proposal.
    pub const RECORD_VISIT = 10;
    /// A [`PathRecord`](super::PathRecord): a mutation has proposed the path of the records around it: `s` chain, `t` mutation (0 is the bootstrap sample that
    /// the chain begins at), `vertex` its sort, one of `MUTATION_*`, and `weight`, what the path's contribution is multiplied by to be one over the density
    /// of large steps.
    pub const RECORD_MUTATION = 11;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): the lobe or the light is a delta.
    pub const RECORDED_DELTA = 1;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): the path ends.
    pub const RECORDED_ENDS = 2;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): subpaths were merged.
    pub const RECORDED_MERGED = 4;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): one of those that one is chosen of.
    pub const RECORDED_CANDIDATE = 8;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): a proposal.
    pub const RECORDED_PROPOSAL = 16;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): the light is infinitely far away.
    pub const RECORDED_DISTANT = 32;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): the lobe is narrow, see [`NARROW_ALPHA`](super::NARROW_ALPHA).
    pub const RECORDED_NARROW = 64;
    /// Flag on [`PathRecord::flags`](super::PathRecord::flags): the vertex is no hit but a sample of a light, and `primitive` is the light's index.
    pub const RECORDED_LIGHT = 128;
    /// A sort of mutation of `mlt`: none, the path is the bootstrap sample that the chain begins at.
    pub const MUTATION_BEGINS = 0;
    /// A sort of mutation of `mlt`: a large step, nothing of the current path is in the proposal.
    pub const MUTATION_LARGE = 1;
    /// A sort of mutation of `mlt`: a large step that follows a path from the camera until it meets a light.
    pub const MUTATION_RUN = 2;
    /// A sort of mutation of `mlt`: a small step, all random numbers of the current path are perturbed.
    pub const MUTATION_SMALL = 3;
    /// A sort of mutation of `mlt`: some vertices in a row are replaced by others.
    pub const MUTATION_BIDIRECTIONAL = 4;
    /// A sort of mutation of `mlt`: a lens perturbation.
    pub const MUTATION_LENS = 5;
    /// A sort of mutation of `mlt`: a multi-chain perturbation.
    pub const MUTATION_MULTI_CHAIN = 6;
    /// A sort of mutation of `mlt`: a caustic perturbation.
    pub const MUTATION_CAUSTIC = 7;

}

/// The weights of linear sRGB's channels in its luminance (ITU-R BT.709).
pub const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];
