//! What the kernel of the AOVs reads and writes.

use super::types::{Member, SharedStruct, float, uint, uvec2, vec2, vec3};

shared_structs! {
    /// Where the kernel of the AOVs finds what it needs.
    pub struct AovTable {
        /// Device address of the [`AovPixel`]s.
        pixels: uvec2,
        /// Device address of a number for each primitive: that of its shape within its group.
        shapes: uvec2,
        /// Device address of a number for each instance: of the objects in all instances before it.
        objects: uvec2,
        /// 1: mirrors and smooth glass are looked through.
        through_specular: uint,
    }

    /// The AOVs of one pixel: sums over its samples, each times its filter weight; where a sample meets no surface it adds emission alone.
    pub struct AovPixel {
        /// Colour of the surface.
        albedo: vec3,
        /// Unit shading normal in world space, normal and bump maps included.
        normal: vec3,
        /// Unit geometric normal in world space.
        geometric_normal: vec3,
        /// Position relative to the scene's origin.
        position: vec3,
        /// Radiance that the surface or the background emits, W/(m² sr).
        emission: vec3,
        /// Distance along the path from the camera.
        depth: float,
        /// Texture coordinates.
        uv: vec2,
        /// One for each sample that meets a surface.
        coverage: float,
        /// Not a sum: of the sample that meets a surface nearest to the pixel's centre, the material's index and one; 0 for none.
        material_id: uint,
        /// Of the same sample the object's number, from 1.
        object_id: uint,
        /// Falls with the distance of that sample to the centre; 0 where there is none yet.
        nearness: float,
    }
}
