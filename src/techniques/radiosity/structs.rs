//! The structs that the host shares with the shaders of radiosity alone.

#[allow(unused_imports)] // named by the documentation
use crate::layout::NONE;
use crate::layout::{Member, SharedStruct, float, shared_structs, uint, uvec2, vec2};

shared_structs! {
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

    /// The patches of a scene: where their arrays lie, and how many there are.
    pub struct PatchTable {
        /// Device address of the [`PatchFace`]s.
        faces: uvec2,
        /// Device address of the [`Patch`]es.
        patches: uvec2,
        /// Device address of a face for each primitive of each group, or [`NONE`].
        face_of: uvec2,
        /// Device address of what is to be added to a primitive's index to find it in `face_of`, for each instance.
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
        /// Device address of the power that rays carry to patches, for `solver=shoot`: three sums over all patches of what they send
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
}
