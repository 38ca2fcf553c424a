//! Constants that are chosen when a pipeline is made: what a kernel models. No number is written down: a constant's `constant_id` is its
//! place among all of them.

use super::features::features;
use super::types::{float, uint};
use super::{LIGHT_KINDS, LIGHTS, MATERIAL_KINDS, MATERIALS};

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

macro_rules! needs {
    ($(
        $(#[$doc:meta])*
        $member:ident $constant:ident: $kind:ident $($word:literal)?, of $of:expr, unspecialised $unspecialised:expr;
    )*) => {
        /// What a scene uses. Each `false` is code that is not compiled in and memory that is not allocated.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Needs {
            /// Whether any surface has a material of the kind, by `MATERIAL_*`.
            pub materials: [bool; MATERIAL_KINDS],
            /// Whether there is a light of the kind, by `LIGHT_*`.
            pub lights: [bool; LIGHT_KINDS],
            $( $(#[$doc])* pub $member: $kind ),*
        }

        /// Names and types of the constants of features.
        const FEATURES: &[(&str, &str)] = &[$( (stringify!($constant), stringify!($kind)) ),*];

        impl Needs {
            /// The values of the constants of features, of materials and of lights, in the order of their identifiers.
            fn words(&self) -> impl Iterator<Item = u32> {
                let features = [$( self.$member.word() ),*];
                features.into_iter().chain(self.materials.map(Word::word)).chain(self.lights.map(Word::word))
            }
        }
    };
}
features!(needs);

macro_rules! settings {
    ($( $(#[$doc:meta])* $member:ident $constant:ident: $kind:ident; )*) => {
        /// The values of all specialisation constants except the inline geometry.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Specialisation {
            /// What the scene uses.
            pub needs: Needs,
            $( $(#[$doc])* pub $member: $kind ),*
        }

        /// Names and types of the constants that settings and devices decide.
        const SETTINGS: &[(&str, &str)] = &[$( (stringify!($constant), stringify!($kind)) ),*];

        impl Specialisation {
            /// The constants as (id, 32-bit pattern), which is what a pipeline takes.
            pub fn words(&self) -> Vec<(u32, u32)> {
                (0..).zip(self.needs.words().chain([$( self.$member.word() ),*])).collect()
            }
        }
    };
}

settings! {
    /// The camera, one of the `CAMERA_*` constants.
    camera CAMERA: uint;
    /// The pixel filter, one of the `FILTER_*` constants.
    filter FILTER: uint;
    /// Layers by path length, 0 for none; the last one also takes every longer path. With strategies, two for each of them.
    length_layers LENGTH_LAYERS: uint;
    /// Layers are those of strategies, unweighted and weighted, instead of path lengths.
    strategies HAS_STRATEGIES: bool;
    /// Longest path in segments; `NONE` is no limit.
    max_depth MAX_DEPTH: uint;
    /// Segments after which Russian roulette may end a path.
    rr_depth RR_DEPTH: uint;
    /// Uniform numbers come in scrambled Sobol pairs instead of independently.
    sobol HAS_SOBOL: bool;
    /// Entries of the traversal stack.
    stack_size STACK_SIZE: uint;
    /// Leaves of the tree hold pairs of triangles.
    has_pairs HAS_PAIRS: bool;
    /// Primitives that the kernel holds as constants; 0 reads them from memory through the BVH.
    inline_count INLINE_COUNT: uint;
    /// Bit i: the i-th of them is a sphere, whose centre and radius are its first coordinates.
    inline_spheres INLINE_SPHERES: uint;
    /// Bit i: that is so of the one 32 places later.
    inline_spheres_high INLINE_SPHERES_HIGH: uint;
    /// Read nodes and primitives in 64-bit words (faster on CPU devices) rather than in vectors of 32-bit words.
    wide_loads WIDE_LOADS: bool;
    /// Find the traversal stack's top by comparison (faster on CPU devices) rather than by address.
    select_stack SELECT_STACK: bool;
    /// Loops that take one thing after the other so that their body stands in a kernel once may be unrolled. Drivers of
    /// CPUs, which are slow to compile, are not told how many turns there are.
    unroll UNROLL: bool;
    /// Kernels record the paths of a sample.
    records RECORDS: bool;
    /// First parameter of the technique.
    param0 PARAM0: uint;
    /// Second parameter of the technique.
    param1 PARAM1: uint;
    /// Third parameter of the technique.
    param2 PARAM2: uint;
    /// Fourth parameter of the technique.
    param3 PARAM3: uint;
}

/// Every specialisation constant except the inline geometry.
pub fn specialisation() -> impl Iterator<Item = SpecialisationConstant> {
    let features = FEATURES.iter().copied();
    let materials = MATERIALS.iter().map(|kind| (kind.feature, "bool"));
    let lights = LIGHTS.iter().map(|kind| (kind.feature, "bool"));
    let all = features.chain(materials).chain(lights).chain(SETTINGS.iter().copied());
    (0..).zip(all).map(|(id, (name, kind))| SpecialisationConstant { name, id, kind })
}

/// `constant_id` of the first coordinate of the inline geometry: primitive i has the nine from `INLINE_FIRST_ID + 9 i`.
pub const INLINE_FIRST_ID: u32 = (FEATURES.len() + MATERIAL_KINDS + LIGHT_KINDS + SETTINGS.len()) as u32;
