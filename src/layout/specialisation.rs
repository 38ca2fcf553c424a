//! Constants that are chosen when a pipeline is made: what a kernel models.

use super::{float, uint};

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
    /// Layers by path length, 0 for none; the last one also takes every longer path. With strategies, two for each of them.
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
    /// Loops that take one thing after the other so that their body stands in a kernel once may be unrolled. Drivers of CPUs, which are slow to
    /// compile, are not told how many turns there are.
    73 unroll UNROLL: bool;
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
    /// Lights are selected from a tree.
    61 light_tree HAS_LIGHT_TREE: bool;
    /// Some image has smaller levels of detail, which materials are filtered with.
    62 mip_maps HAS_MIP_MAPS: bool;
    /// Some rough metal or rough glass gets back what it loses to multiple scattering.
    70 energy_compensation HAS_ENERGY_COMPENSATION: bool;
    /// Uniform numbers come in scrambled Sobol pairs instead of independently.
    71 sobol HAS_SOBOL: bool;
    /// Layers are those of strategies, unweighted and weighted, instead of path lengths.
    72 strategies HAS_STRATEGIES: bool;
    /// Some layered material has a sheen.
    50 layered_sheen HAS_LAYERED_SHEEN: bool;
    /// Some layered material has a clear coat.
    51 layered_clearcoat HAS_LAYERED_CLEARCOAT: bool;
    /// Some layered material lets light through.
    52 layered_transmission HAS_LAYERED_TRANSMISSION: bool;
    /// Some layered material bounds a volume.
    53 layered_volume HAS_LAYERED_VOLUME: bool;
    /// Some material has a map of normals.
    54 normal_maps HAS_NORMAL_MAPS: bool;
    /// Some material has a bump map.
    55 bump_maps HAS_BUMP_MAPS: bool;
    /// Some surface has a textured opacity.
    56 textured_masks HAS_TEXTURED_MASKS: bool;
    /// Some texture is a checkerboard.
    57 checkerboards HAS_CHECKERBOARDS: bool;
    /// The formats of texels that there are: bit `TEXELS_*`.
    58 texel_formats TEXEL_FORMATS: uint;
    /// The ways that textures go on outside of themselves: bit `WRAP_*`.
    59 wraps WRAPS: uint;
    /// First parameter of the technique.
    24 param0 PARAM0: uint;
    /// Second parameter of the technique.
    25 param1 PARAM1: uint;
    /// Third parameter of the technique.
    26 param2 PARAM2: uint;
    /// Fourth parameter of the technique.
    27 param3 PARAM3: uint;
}
