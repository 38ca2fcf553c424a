//! What is the most that a scene may hold, whatever its files claim.

/// Vertices and triangles of a scene, those of a mesh that is placed once for each group that it is in.
pub(in crate::scene) const ELEMENTS: u64 = 1 << 27;
/// Materials of a scene, copies for bump and normal maps counted.
pub(in crate::scene) const MATERIALS: usize = 1 << 20;
/// Bytes of all images of a scene, decoded.
pub(in crate::scene) const IMAGE_BYTES: u64 = 4 << 30;
