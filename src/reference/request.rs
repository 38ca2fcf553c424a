//! What a reference is to be, how long it may take, and what is told meanwhile.

use std::path::Path;

use crate::error::Result;
use crate::gpu::Gpu;
use crate::render::Settings;
use crate::scene::Scene;
use crate::techniques::Solves;

/// How long it may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So many seconds in all.
    Seconds(f64),
    /// As long as so many samples per pixel of the first technique that can make it.
    Samples(f64),
}

/// A reference that is to be made or checked.
pub struct Request<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The scene.
    pub scene: &'a Scene,
    /// Size, backend and everything else but technique and seed.
    pub settings: &'a Settings,
    /// The light that it is to have.
    pub solves: Solves,
    /// How long it may take.
    pub budget: Budget,
    /// Which of several independent references it is, 0 to 63.
    pub seed: u32,
    /// Where what was rendered is kept, if it is to be, with a number for all that it depends on.
    pub parts: Option<(&'a Path, u64)>,
}

/// What is told while a reference is made.
pub enum Step<'a> {
    /// A technique is tried for a moment.
    Tries(&'a str),
    /// One makes the reference, for about so many seconds.
    Makes(&'a str, f64),
    /// One checks it.
    Checks(&'a str, f64),
    /// Another one is asked, since they differ; the text says where.
    Asks(&'a str, String),
    /// The share of the time that has passed, again and again.
    Share(f64),
}

/// Who is told; an error ends the work.
pub(super) type Hear<'a> = &'a mut dyn FnMut(Step) -> Result<()>;

impl Budget {
    /// So many seconds, if they are known.
    pub(super) fn seconds(self) -> Option<f64> {
        match self {
            Self::Seconds(seconds) => Some(seconds),
            Self::Samples(_) => None,
        }
    }
}
