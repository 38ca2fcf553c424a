//! Textures: values over texture coordinates, from images or patterns.

/// What coordinates outside of an image show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image mirrored.
    Mirror,
    /// Its edge.
    Clamp,
}

/// What a texture shows.
#[derive(Clone, Copy, Debug)]
pub enum Pattern {
    /// An image, by its index.
    Image(usize),
    /// Squares of two colours: half of the unit square along each axis.
    Checkerboard([f32; 3], [f32; 3]),
    /// What a mesh has at its vertices: an index from [`SceneBuilder::attribute`](super::SceneBuilder::attribute).
    Attribute(usize),
}

/// A texture.
#[derive(Clone, Copy, Debug)]
pub struct TextureDescription {
    /// What it shows.
    pub pattern: Pattern,
    /// Of a checkerboard: textures that its squares show instead of their colour.
    pub squares: [Option<u32>; 2],
    /// What lies outside of an image, across and down.
    pub wrap: [Wrap; 2],
    /// The nearest texel instead of bilinear interpolation.
    pub nearest: bool,
    /// The second set of the surface's coordinates instead of the first.
    pub second_uvs: bool,
    /// What a scalar takes of it: channel 0 to 3, or 4 for luminance.
    pub channel: u32,
    /// Rows of the map from the surface's coordinates to the texture's.
    pub map: [[f32; 3]; 2],
    /// Factor on its values.
    pub scale: [f32; 4],
    /// Added to them.
    pub offset: [f32; 4],
}

impl TextureDescription {
    /// A texture of this pattern: repeated, bilinear, as it is.
    pub fn new(pattern: Pattern) -> Self {
        Self {
            pattern,
            squares: [None; 2],
            wrap: [Wrap::Repeat; 2],
            nearest: false,
            second_uvs: false,
            channel: 4,
            map: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            scale: [1.0; 4],
            offset: [0.0; 4],
        }
    }

    /// The same colour everywhere.
    pub fn constant(colour: [f64; 3]) -> Self {
        let colour = colour.map(|channel| channel as f32);
        Self::new(Pattern::Checkerboard(colour, colour))
    }
}
