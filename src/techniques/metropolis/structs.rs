//! The structs that the host shares with the shaders of Metropolis light transport alone.

use crate::layout::{LightSubpathTable, Member, SharedStruct, float, shared_structs, uint, uvec2, uvec3, vec2, vec3};

shared_structs! {
    /// The Markov chains of a rendering: how many there are, and where they lie.
    pub struct ChainTable {
        /// Where chains splat, and the number of pixels, those of the border included, that their positions are uniform over.
        light: LightSubpathTable,
        /// Device address of the [`BootstrapSample`]s.
        bootstrap: uvec2,
        /// Device address of the [`Chain`]s.
        states: uvec2,
        /// Device address of the contribution of each one's current path, layer by layer (or the image's one): three floats for each chain.
        values: uvec2,
        /// Device address of the numbers: block by block, those of the camera's paths before those of the lights', four for each chain.
        numbers: uvec2,
        /// Device address of the probability that a large step is of the first so many kinds, for each number of them; the last one is 1.
        kinds_shares: uvec2,
        /// Kinds of large steps.
        kind_count: uint,
        /// Chains.
        chains: uint,
        /// Chains that take part in one sample: the first so many in the first sample, the next so many in the second, and round again.
        chains_of_sample: uint,
        /// Mutations of each of these.
        mutations: uint,
        /// Blocks of numbers that a chain has room for, of camera subpaths.
        camera_blocks: uint,
        /// Blocks of numbers that a chain has room for, of light subpaths.
        light_blocks: uint,
        /// Mean of the target over large steps, estimated from the bootstrap samples.
        normalisation: float,
        /// K of the target compression f / (1 + f / K).
        bound: float,
    }

    /// A path that a chain may begin with.
    pub struct BootstrapSample {
        /// Its contribution: the mean of the channels, over the density of bootstrap samples.
        contribution: float,
        /// Its kind, eight bits; above them that of large steps which made it; above these, how much of their density is the last kind's.
        kind: uint,
    }

    /// A Markov chain.
    pub struct Chain {
        /// The bootstrap sample that it begins with. Where paths are recorded, once it has begun: the mutation that proposed its current path, 0 of
        /// that bootstrap sample.
        begins_at: uint,
        /// The kind of its current path; before it has begun, that of large steps which made its bootstrap
        /// sample.
        kind: uint,
        /// Blocks of numbers that this one used: of the camera's in the lower half, of the light's in the upper one; `NONE` before it
        /// has begun.
        known: uint,
        /// Contribution of the current path: the mean of the channels, over the density of large steps.
        contribution: float,
        /// Where the path ends in the image, in pixels.
        position: vec2,
        /// Sum of the target where large steps went, whether they were accepted or not.
        sum: float,
        /// Low part of `sum`.
        sum_low: float,
        /// How many large steps there were.
        large_steps: uint,
    }

    /// A vertex of a path that a chain mutates, from the camera (0) to the light: see `shaders/techniques/metropolis/path_vertices.glsl`.
    pub struct PathVertex {
        /// Its position; where the kind is infinitely far, the unit direction there.
        position: vec3,
        /// One of the `VERTEX_*` kinds.
        kind: uint,
        /// Bits of floats, of an area light: its normal. Of a surface: the instance, and bits of where on the primitive.
        detail: uvec3,
        /// Primitive, or light.
        index: uint,
        /// Bits of floats, of an area light: its radiance. Of a surface: the key of its random numbers.
        own: uvec3,
        /// Density of going on away from the camera, over solid angle; of the light's vertex: of a light subpath beginning there. This
        /// and the following members are filled in by `path_value`. The density of a delta lobe is 1 times the delta, which
        /// cancels wherever it stands.
        pdf: float,
        /// Density of going on towards the camera, over solid angle; of parallel rays: over area across.
        reverse_pdf: float,
        /// |cos| at the normal towards the vertex before, 1 of lights without one; of a light times its opacity.
        arriving: float,
        /// |cos| at the normal towards the next vertex; of an area light: how far off the surface rays begin.
        leaving: float,
        /// 1 over the squared distance from the vertex before (1 of parallel rays) times what is let through in between; of the
        /// camera's vertex: the path's contribution, as `path_value` has it.
        nearness: float,
    }
}
