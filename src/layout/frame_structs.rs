//! What a dispatch is given and what it leaves: push constants, the film, and the records of the kernels that tests run.

use super::types::{Member, SharedStruct, float, uint, uvec2, uvec3, vec2, vec3, vec4};
#[allow(unused_imports)] // named by the documentation
use super::{constants::*, scene_structs::*};

shared_structs! {
    /// What changes from one dispatch to the next: the push constants. What belongs to one technique lies in its table.
    pub struct FrameConstants {
        /// Device address of the [`FilmPixel`]s; for kernels over arrays, of what they write.
        film: uvec2,
        /// Device address of the film's layers: for each pixel, `LENGTH_LAYERS` times six floats (sum, its low part); for kernels over
        /// arrays, of what they read.
        layers: uvec2,
        /// Device address of the one [`Tally`].
        tally: uvec2,
        /// Device address of the technique's table: [`LightTable`], [`ChainTable`] or [`PatchTable`]; 0 where it has none.
        technique: uvec2,
        /// First slot of this dispatch: pixels in tiles of 8 x 8, row by row.
        first_slot: uint,
        /// Slots of this dispatch.
        slot_count: uint,
        /// First sample of each pixel in this dispatch.
        first_sample: uint,
        /// Samples of each pixel in this dispatch.
        sample_count: uint,
        /// Seed of the random numbers.
        seed: uint,
        /// The technique's own: the bits of the merge radius, or the rounds in which patches have passed light on before this one, with
        /// [`PREPARING_BIT`] while each adds light of one more segment.
        word: uint,
    }

    /// What techniques with light subpaths or splats keep. Their tables begin with it.
    pub struct LightTable {
        /// Device address of the splats: for each sample of a dispatch, pixel and layer three 64-bit integers in units of
        /// [`SceneUniforms::splat_unit`](super::SceneUniforms::splat_unit); layers are those by path length, or the one that is the image.
        splats: uvec2,
        /// Device address of the light subpaths: for each slot and sample of a dispatch, or for each of a sample, the number of its
        /// vertices, then room for `light_vertices` of them.
        light_paths: uvec2,
        /// Vertices that a light subpath has room for.
        light_vertices: uint,
        /// Light subpaths in each sample of the image.
        light_path_count: uint,
        /// Device address of the grid that holds the vertices of light subpaths: the number of places taken, then [`GridCell`]s.
        grid_cells: uvec2,
        /// Device address of those places: indices of vertices, subpath by subpath, `light_vertices` for each.
        grid_places: uvec2,
        /// Cells of the grid, a power of two; 0 where there is none.
        grid_cell_count: uint,
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

    /// A vertex of a light path, for paths from the camera to be connected to it.
    pub struct LightVertex {
        /// Its position.
        position: vec3,
        /// Unit direction in which light came.
        direction: vec3,
        /// Unit geometric normal of the surface.
        normal: vec3,
        /// Primitive that was hit.
        primitive: uint,
        /// Its instance.
        instance: uint,
        /// Barycentric weights of its second and third vertex.
        uv: vec2,
        /// Power that arrives there, W, over the density of the path.
        power: vec3,
        /// Partial sums of multiple importance sampling, see `shaders/techniques/bidirectional/mis.glsl`.
        d_vcm: float,
        /// The same.
        d_vc: float,
        /// Random dimension with which its material was chosen.
        dimension: uint,
        /// Segments from the light to it.
        segments: uint,
        /// Absorption of the medium that light came through, 1/m.
        absorption: vec3,
    }

    /// Power that has arrived at a surface.
    pub struct Photon {
        /// Where.
        position: vec3,
        /// Unit direction in which it came.
        direction: vec3,
        /// Unit geometric normal of the surface.
        normal: vec3,
        /// Power over the density of the path, W.
        power: vec3,
        /// Segments from the light to it.
        segments: uint,
    }

    /// The patches of a scene: where their arrays lie, and how many there are.
    pub struct PatchTable {
        /// Device address of the [`PatchFace`]s.
        faces: uvec2,
        /// Device address of the [`Patch`]es.
        patches: uvec2,
        /// Device address of a face for each primitive of each group, or [`NONE`] ...
        face_of: uvec2,
        /// ... and of what is to be added to a primitive's index there, for each instance.
        face_base: uvec2,
        /// Device address of a patch for each cell of the faces.
        cells: uvec2,
        /// Device address of the corners of each patch: four vertices, or three and [`NONE`].
        corners: uvec2,
        /// Device address of the first term of each vertex, and of the end of the last one.
        term_first: uvec2,
        /// Device address of the terms of which a vertex is the sum: a patch, and the bits of its weight.
        terms: uvec2,
        /// Device address of the albedo of each patch.
        albedo: uvec2,
        /// Device address of the irradiance of each patch, W/m²: twice as many layers, one half to read and one to write.
        received: uvec2,
        /// Device address of the part of it that came in the last round while preparing: one layer, likewise twice.
        newest: uvec2,
        /// Device address of the irradiance of each vertex, in layers.
        vertices: uvec2,
        /// Device address of the power that rays bring to patches, for `solver=shoot`: three sums over all patches of what they send
        /// out (two that take turns, then that of the rounds that prepare), and three integers for each layer and patch.
        arriving: uvec2,
        /// Device address of how many of a patch's rays met what: for each patch `columns` counts.
        met: uvec2,
        /// Patches.
        patch_count: uint,
        /// Vertices.
        vertex_count: uint,
        /// Layers of irradiance: by the number of segments from the light, from one on.
        layers: uint,
        /// 1 where the last layer takes all light from farther away as well; 0 where it ends there.
        open_ended: uint,
        /// 1 where emission is left to the patches' rays alone, which find it everywhere.
        found: uint,
        /// Counts of a patch: rays that met nothing, a surface without a patch, patches on backs, and then on the front of each surface.
        columns: uint,
    }

    /// A surface that is divided into patches: a triangle, two that are a parallelogram, or a sphere.
    pub struct PatchFace {
        /// Its triangle or sphere.
        primitive: uint,
        /// The other triangle of a parallelogram, or [`NONE`].
        second: uint,
        /// Which corner of the triangle is the face's first one; times 4 of the second one.
        turn: uint,
        /// Its instance.
        instance: uint,
        /// Cells along its first edge.
        across: uint,
        /// Cells along its second edge; of a triangle as many.
        down: uint,
        /// First cell of its front, or [`NONE`].
        front: uint,
        /// First cell of its back, or [`NONE`].
        back: uint,
    }

    /// A piece of a face that has one value.
    pub struct Patch {
        /// Its face.
        face: uint,
        /// 1 on the face's back.
        back: uint,
        /// Where it begins, in the face's coordinates.
        corner: vec2,
        /// How far it goes; of a triangle that stands on its head, below 0.
        extent: vec2,
        /// Its area, m².
        area: float,
        /// Its column among the counts.
        column: uint,
    }

    /// A cell of the grid that holds the vertices of light paths.
    pub struct GridCell {
        /// Its first place.
        first: uint,
        /// How many there are.
        count: uint,
    }

    /// The Markov chains of a rendering: how many there are, and where they lie.
    pub struct ChainTable {
        /// Where chains splat, and the number of pixels, those of the border included, that their positions are uniform over.
        light: LightTable,
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
        /// The bootstrap sample that it begins with.
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
        /// Density of going on away from the camera, over solid angle; of the light's vertex: of a light path beginning there. This
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

    /// What traversal tested for a [`RayRecord`]: see `shaders/kernels/rays/count.glsl`.
    pub struct TraversalCount {
        /// Nodes that were read until the nearest hit was known.
        closest_nodes: uint,
        /// Triangles and spheres that were tested for it.
        closest_primitives: uint,
        /// Nodes that were read until any hit was known.
        any_nodes: uint,
        /// Triangles and spheres that were tested for that.
        any_primitives: uint,
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
        /// Unit normal of the surface that receives the light there, or zero where it may come from anywhere.
        normal: vec3,
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

// Every device has 128 bytes of push constants; half of them is enough.
const _: () = assert!(size_of::<FrameConstants>() < 64);
