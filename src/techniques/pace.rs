//! How much work fits into one submission.

use std::time::Duration;

use crate::layout::WORKGROUP;

/// What one submission should take.
const SUBMISSION: Duration = Duration::from_millis(100);
/// Work of the first one, before anything is known of the speed.
const FIRST: u64 = 1 << 14;

/// How much work fits into one submission of about a tenth of a second, by the speed of those before it. The unit of work is the caller's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace(u64);

impl Pace {
    /// Before anything is known.
    pub fn new() -> Self {
        Self(FIRST)
    }

    /// A pace that is known.
    #[cfg(test)]
    pub fn of(work: u64) -> Self {
        Self(work)
    }

    /// The work of the next submission.
    pub fn fits(self) -> u64 {
        self.0
    }

    /// Takes note of a submission. Speed differs across an image: it is followed, but not in one leap.
    pub fn took(&mut self, work: u64, took: Duration) {
        let fit = (work as f64 * SUBMISSION.as_secs_f64() / took.as_secs_f64().max(1e-6)) as u64;
        self.0 = fit.clamp(self.0 / 4, self.0.saturating_mul(4)).max(u64::from(WORKGROUP));
    }
}
