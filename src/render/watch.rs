//! Telling whoever waits how far the building of a scene is.

/// How far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Building {
    /// What is being done.
    pub doing: &'static str,
    /// The share of it that is done, 0 to 1.
    pub share: f64,
}

/// Is told now and then, from any thread, how far the building of a scene is.
pub type Watch<'a> = &'a (dyn Fn(Building) + Sync);

impl Building {
    /// So many primitives have found their place in the acceleration structure.
    pub(super) fn tree(done: usize, of: usize) -> Self {
        Self { doing: "building the acceleration structure", share: done as f64 / of.max(1) as f64 }
    }
}
