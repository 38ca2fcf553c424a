//! The pieces of a scene's surfaces that have one value each.

#[allow(unused_imports)] // named by the documentation
use super::constants::*;
use super::types::{Member, SharedStruct, float, uint, vec2};

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
}
