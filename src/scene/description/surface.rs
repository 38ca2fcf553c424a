//! What surfaces are made of, what they emit and what they stop.

/// What one side of a surface is made of.
pub type Side = Option<usize>;

/// What a surface stops of the light that falls on it; the rest goes straight on.
#[derive(Clone, Copy, Debug)]
pub struct Mask {
    /// The share that it stops.
    pub opacity: f64,
    /// A texture that multiplies it.
    pub texture: Option<u32>,
    /// Where above 0, and what it stops is not the same everywhere, opacities below it count as 0 and others as 1.
    pub cutoff: f64,
}

/// A surface: the materials of its two sides (indices from [`SceneBuilder::material`](super::SceneBuilder::material)) and what its front emits.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceDescription {
    /// The side that normals point to.
    pub front: Side,
    /// The other side.
    pub back: Side,
    /// Radiance of the front, W/(m² sr).
    pub emission: [f64; 3],
    /// A texture that multiplies it.
    pub emission_texture: Option<u32>,
    /// The other side emits the same. Only of meshes.
    pub emits_behind: bool,
    /// What it stops; nothing stops all.
    pub mask: Option<Mask>,
    /// The alpha of vertex colours multiplies what it stops.
    pub has_alpha_colours: bool,
}
