//! The strategies of bidirectional path tracing: a path of k segments can be made of s vertices from the light and t = k + 1 - s
//! from the camera.

/// The longest path, in segments, whose strategies can be told apart in an image: there are 27 up to it.
pub const LONGEST: u32 = 6;

/// One strategy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strategy {
    /// Vertices from the light.
    pub s: u32,
    /// Vertices from the camera, one at least.
    pub t: u32,
}

impl Strategy {
    /// All strategies for paths of up to so many segments, by their length, then by s: the order of the layers on the device.
    pub fn up_to(segments: u32) -> impl Iterator<Item = Self> {
        (1..=segments).flat_map(|k| (0..=k).map(move |s| Self { s, t: k + 1 - s }))
    }

    /// Segments of its paths.
    pub fn segments(self) -> u32 {
        self.s + self.t - 1
    }

    /// Its name: `s2t3`.
    pub fn name(self) -> String {
        format!("s{}t{}", self.s, self.t)
    }
}
