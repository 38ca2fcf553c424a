//! The structs that the host shares with the shaders of photon mapping alone.

use crate::layout::{Member, SharedStruct, shared_structs, uint, vec3};

shared_structs! {
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
}
