//! Cutting a rendering into frames of about a tenth of a second.

use std::time::Duration;

use crate::layout::WORKGROUP;

/// What one submission should take.
const FRAME: Duration = Duration::from_millis(100);
/// Pixel samples of the first frame, before anything is known of the speed.
const FIRST: u64 = 1 << 14;

/// One dispatch: a run of slots (pixels in tiles of 8 x 8) and a run of samples for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    pub first_slot: u32,
    pub slots: u32,
    pub first_sample: u32,
    pub samples: u32,
}

/// How far a rendering is, and how large its next frame is. A pass gives all slots the same number of samples; a slow
/// device takes several frames over one pass, a fast one several samples per pass.
#[derive(Clone, Debug)]
pub(super) struct FramePlan {
    width: u32,
    height: u32,
    slots: u32,
    max_slots: u32,
    /// Samples that all slots have.
    done: u32,
    /// Slots that have the current pass already, and the samples of that pass.
    cursor: u32,
    pass: u32,
    /// Pixel samples that fit into a frame, by the last one's speed.
    capacity: u64,
}

impl FramePlan {
    pub fn new(width: u32, height: u32, max_workgroups: u32) -> Self {
        let slots = width.div_ceil(8) * height.div_ceil(8) * 64;
        let max_slots = max_workgroups.saturating_mul(WORKGROUP).max(WORKGROUP);
        Self { width, height, slots, max_slots, done: 0, cursor: 0, pass: 0, capacity: FIRST }
    }

    /// The same plan at its beginning; what it knows of the speed stays.
    pub fn restarted(&self) -> Self {
        Self { done: 0, cursor: 0, pass: 0, ..self.clone() }
    }

    /// The next frame, or nothing once all slots have `target` samples.
    pub fn next(&self, target: u32) -> Option<Frame> {
        if self.cursor == 0 && self.done >= target {
            return None;
        }
        let samples = if self.cursor > 0 {
            self.pass
        } else {
            let fit = (self.capacity / u64::from(self.slots)).max(1);
            u32::try_from(fit).unwrap_or(u32::MAX).min(target - self.done)
        };
        let fit = (self.capacity / u64::from(samples)).next_multiple_of(u64::from(WORKGROUP));
        let slots = u32::try_from(fit).unwrap_or(u32::MAX).min(self.max_slots).min(self.slots - self.cursor);
        Some(Frame { first_slot: self.cursor, slots, first_sample: self.done, samples })
    }

    /// Takes note of a frame that has been run.
    pub fn done(&mut self, frame: Frame, took: Duration) {
        let work = u64::from(frame.slots) * u64::from(frame.samples);
        let fit = work as f64 * FRAME.as_secs_f64() / took.as_secs_f64().max(1e-6);
        // Speed differs across an image: follow it, but not in one leap.
        self.capacity =
            (fit as u64).clamp(self.capacity / 4, self.capacity.saturating_mul(4)).max(u64::from(WORKGROUP));
        self.pass = frame.samples;
        self.cursor += frame.slots;
        if self.cursor >= self.slots {
            self.done += self.pass;
            self.cursor = 0;
        }
    }

    pub fn spp(&self) -> u32 {
        self.done
    }

    pub fn progress(&self) -> f64 {
        f64::from(self.done) + f64::from(self.pass) * f64::from(self.cursor) / f64::from(self.slots)
    }

    /// Samples of each pixel, row by row.
    pub fn counts(&self) -> Vec<u64> {
        let tiles_across = self.width.div_ceil(8);
        let count = |x: u32, y: u32| {
            let slot = (y / 8 * tiles_across + x / 8) * 64 + y % 8 * 8 + x % 8;
            u64::from(self.done) + if slot < self.cursor { u64::from(self.pass) } else { 0 }
        };
        (0..self.height).flat_map(|y| (0..self.width).map(move |x| count(x, y))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the speed, every slot gets every sample exactly once and in order.
    #[test]
    fn every_sample_is_taken_once() {
        for microseconds in [1, 900, 130_000, 7_000_000] {
            let mut plan = FramePlan::new(37, 21, 1 << 16);
            let slots = plan.slots as usize;
            let mut next_sample = vec![0; slots];
            while let Some(frame) = plan.next(50) {
                for slot in frame.first_slot..frame.first_slot + frame.slots {
                    assert_eq!(next_sample[slot as usize], frame.first_sample);
                    next_sample[slot as usize] += frame.samples;
                }
                plan.done(frame, Duration::from_micros(microseconds * u64::from(frame.slots * frame.samples) / 100));
            }
            assert!(next_sample.iter().all(|samples| *samples == 50));
            assert!(plan.counts().iter().all(|count| *count == 50));
        }
    }

    #[test]
    fn counts_tell_an_unfinished_pass() {
        let mut plan = FramePlan::new(16, 8, 1 << 16);
        plan.capacity = 64;
        let frame = plan.next(1).unwrap();
        assert_eq!((frame.slots, frame.samples), (64, 1));
        plan.done(frame, Duration::from_millis(100));
        let counts = plan.counts();
        assert_eq!(counts[0..8], [1; 8]);
        assert_eq!(counts[8..16], [0; 8]);
    }
}
