//! The table of ray backends: the only place where a new one is announced.
//!
//! A backend is one row here and one file in `shaders/trace/` with the function `trace`;
//! `gpu/` says which devices have what it needs.

/// A way to find what a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// The driver's acceleration structures, through `VK_KHR_ray_query`.
    RayQuery,
    /// A compressed wide BVH traversed in a compute shader.
    Bvh,
}

/// One backend's row.
#[derive(Clone, Copy, Debug)]
pub struct BackendRow {
    /// The backend that the row describes.
    pub backend: Backend,
    /// The backend's name on the command line (`--backend`).
    pub name: &'static str,
    /// The backend's file in `shaders/trace/`.
    pub file: &'static str,
    /// Whether the backend's traversal can count what it tests, where `COUNT_TRAVERSAL` is defined.
    pub counts: bool,
}

/// Every backend.
pub const BACKENDS: &[BackendRow] = &[
    BackendRow { backend: Backend::RayQuery, name: "ray-query", file: "ray_query.glsl", counts: false },
    BackendRow { backend: Backend::Bvh, name: "bvh", file: "bvh.glsl", counts: true },
];

impl Backend {
    /// Whether the backend's traversal can count what it tests.
    pub fn counts(self) -> bool {
        BACKENDS.iter().any(|row| row.backend == self && row.counts)
    }

    /// The backend's name on the command line.
    pub fn name(self) -> &'static str {
        BACKENDS.iter().find(|row| row.backend == self).map_or("", |row| row.name)
    }
}
