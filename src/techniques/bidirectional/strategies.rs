//! The strategies of bidirectional path tracing: a path of k segments can be made of s vertices from the light and t = k + 1 - s
//! from the camera.

use crate::scene::Camera;

/// The longest path, in segments, whose strategies can be told apart in an image: there are 27 up to it, and 5 more with a lens.
pub const LONGEST: u32 = 6;

/// One strategy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strategy {
    /// Vertices from the light.
    pub s: u32,
    /// Vertices from the camera; 0 is a path from the light that runs into the lens.
    pub t: u32,
}

impl Strategy {
    /// Segments of its paths.
    pub fn segments(self) -> u32 {
        self.s + self.t - 1
    }

    /// Its name: `s2t3`.
    pub fn name(self) -> String {
        format!("s{}t{}", self.s, self.t)
    }
}

/// The strategies that an image tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strategies {
    /// Segments of the longest path.
    pub longest: u32,
    /// The camera has a lens, which paths of two segments and more run into; nothing runs into a pinhole or against parallel rays.
    pub lens: bool,
}

impl Strategies {
    /// Those of paths of up to so many segments to a camera.
    pub fn of(longest: u32, camera: &Camera) -> Self {
        Self { longest, lens: camera.has_lens() }
    }

    /// All, by the length of their paths, then by s: the order of the layers on the device.
    pub fn all(self) -> impl Iterator<Item = Strategy> {
        let most = move |k: u32| if self.lens && k > 1 { k + 1 } else { k };
        (1..=self.longest).flat_map(move |k| (0..=most(k)).map(move |s| Strategy { s, t: k + 1 - s }))
    }
}
