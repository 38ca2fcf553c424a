//! What kernels record of the paths of a sample, for `lumbre trace`: see `shaders/core/record.glsl`.

#[allow(unused_imports)] // named by the documentation
use super::constants::*;
use super::types::{Member, SharedStruct, float, uint, vec3};

shared_structs! {
    /// What is to be recorded, and how much has been; the [`PathRecord`]s follow it.
    pub struct RecordHeader {
        /// Records that kernels wanted to write; those beyond the capacity are lost.
        count: uint,
        /// Records that there is room for.
        capacity: uint,
        /// Bit `RECORD_*`: the kinds that are recorded.
        kinds: uint,
        /// The pixel, y * width + x; [`NONE`] is all of them.
        pixel: uint,
        /// The sample of each pixel; [`NONE`] is all of them.
        sample_index: uint,
        /// The light subpath that is recorded as well; [`NONE`] is none of them.
        light_path: uint,
        /// The chain of which a path is recorded; [`NONE`] is none of them.
        chain: uint,
        /// The mutation of that chain whose proposal is the path; 0 is the bootstrap sample that the chain begins at.
        mutation: uint,
        /// A finished sample is recorded where its largest channel is above this.
        threshold: float,
    }

    /// One thing that happened to a path. Which members mean something depends on the kind; the others are 0.
    pub struct PathRecord {
        /// What happened: `RECORD_*`.
        kind: uint,
        /// Pixel index, y * width + x; of a light subpath, its own index; of a chain's path, the chain's.
        pixel: uint,
        /// Sample index within the pixel.
        sample_index: uint,
        /// 1 for a light subpath, 0 for a path from the camera.
        from_light: uint,
        /// Vertex along the subpath: 0 is the camera or the light.
        vertex: uint,
        /// Vertices from the light of the strategy; of a chain, its index.
        s: uint,
        /// Vertices from the camera; of a chain, the mutation.
        t: uint,
        /// Index of the material, [`NONE`] where there is none.
        material: uint,
        /// Index of the uploaded primitive; with [`RECORDED_LIGHT`] of the light.
        primitive: uint,
        /// Index of the uploaded instance.
        instance: uint,
        /// Bits `RECORDED_*`.
        flags: uint,
        /// A point, relative to the origin of the scene's arrays.
        position: vec3,
        /// The geometric normal there, unit.
        normal: vec3,
        /// A direction that leaves it, unit; none is 0.
        direction: vec3,
        /// A contribution, f |cos|, or a sample's weight f |cos| / pdf.
        value: vec3,
        /// The path's throughput, or what is multiplied with `value`.
        throughput: vec3,
        /// A density, over solid angle unless the kind says otherwise.
        pdf: float,
        /// The density with which the other strategy has it.
        other_pdf: float,
        /// MIS weight.
        weight: float,
        /// A probability, or the filter's weight.
        probability: float,
    }
}
