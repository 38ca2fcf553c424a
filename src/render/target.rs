//! Stopping at an error: the rendering ends once its own estimate of its relMSE is small enough.

use super::Renderer;
use crate::error::Result;

/// Samples per pixel before the estimate is worth a look: below it is too low by more than a few per cent.
const FIRST: u32 = 64;

/// What an estimate that a few pixels decide must be, beside the error that is asked for.
const FEW_DECIDE: f64 = 0.5;

/// Watches a rendering's own estimate of its relMSE, [`crate::render::film::Film::error_estimate`].
///
/// The estimate is the samples' variance, so it sees noise and no bias; and noise only as far as it has shown: where rare paths
/// carry much of the light, it is too small until one of them was found. So one that a few pixels decide must be half as
/// large. Looking again and again and stopping at the first good look is biased as well; looks are a seventh of the samples apart, which
/// keeps that below the spread of the estimate.
#[derive(Clone, Copy, Debug)]
pub struct ErrorTarget {
    relmse: f64,
    next: u32,
}

impl ErrorTarget {
    /// Stops at this relMSE.
    pub fn new(relmse: f64) -> Self {
        Self { relmse, next: FIRST }
    }

    /// Looks next at so many samples per pixel: where it stopped before.
    pub fn at(self, next: u32) -> Self {
        Self { next, ..self }
    }

    /// Samples per pixel at which it looks next: what to advance to.
    pub fn next(&self) -> u32 {
        self.next
    }

    /// Whether the rendering is there. Reads the film back now and then only.
    pub fn is_reached(&mut self, renderer: &Renderer) -> Result<bool> {
        let spp = renderer.spp();
        if spp < self.next {
            return Ok(false);
        }
        let is_reached = renderer.film()?.error_estimate().is_some_and(|estimate| {
            let enough = if estimate.is_at_least() { FEW_DECIDE * self.relmse } else { self.relmse };
            estimate.relmse <= enough
        });
        // Where it is, that stays where to look: what goes on from here ends here.
        if !is_reached {
            self.next = spp.saturating_add((spp / 7).max(1));
        }
        Ok(is_reached)
    }
}
