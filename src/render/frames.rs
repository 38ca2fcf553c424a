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

/// What bounds frames besides time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Slots of a dispatch.
    pub slots: u32,
    /// Samples of each slot.
    pub samples: u32,
    /// Pixel samples of a frame.
    pub paths: u64,
    /// Samples count only once all slots have them.
    pub whole_passes: bool,
}

/// How far a rendering is, and how large its next frame is. A pass gives all slots the same number of samples; a slow
/// device takes several frames over one pass, a fast one several samples per pass.
#[derive(Clone, Debug)]
pub(super) struct FramePlan {
    width: u32,
    height: u32,
    slots: u32,
    room: Room,
    /// Samples that all slots have.
    done: u32,
    /// Slots that have the current pass already, and the samples of that pass.
    cursor: u32,
    pass: u32,
    /// Pixel samples that fit into a frame, by the last one's speed.
    capacity: u64,
}

/// Slots of an image: its pixels in whole tiles.
pub(super) fn slots(width: u32, height: u32) -> u64 {
    u64::from(width.div_ceil(8)) * u64::from(height.div_ceil(8)) * 64
}

impl FramePlan {
    pub fn new(width: u32, height: u32, room: Room) -> Self {
        let slots = slots(width, height) as u32; // checked before anything is allocated
        Self { width, height, slots, room, done: 0, cursor: 0, pass: 0, capacity: FIRST }
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
        let capacity = self.capacity.min(self.room.paths);
        let samples = if self.cursor > 0 {
            self.pass
        } else {
            let fit = (capacity / u64::from(self.slots)).max(1);
            u32::try_from(fit).unwrap_or(u32::MAX).min(self.room.samples).min(target - self.done)
        };
        // Whole workgroups; as many as there is room for, and one at least.
        let wanted = (capacity / u64::from(samples)).next_multiple_of(u64::from(WORKGROUP));
        let fit = wanted.min(self.room.paths / u64::from(samples) / u64::from(WORKGROUP) * u64::from(WORKGROUP));
        let slots =
            u32::try_from(fit).unwrap_or(u32::MAX).clamp(WORKGROUP, self.room.slots).min(self.slots - self.cursor);
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

    pub fn room(&self) -> Room {
        self.room
    }

    /// Whether this frame ends a pass: all slots have its samples then.
    pub fn ends_pass(&self, frame: Frame) -> bool {
        frame.first_slot + frame.slots >= self.slots
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
        if self.room.whole_passes {
            return vec![u64::from(self.done); self.width as usize * self.height as usize];
        }
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

    const FREE: Room = Room { slots: 1 << 22, samples: u32::MAX, paths: u64::MAX, whole_passes: false };

    /// Whatever the speed, every slot gets every sample exactly once and in order.
    #[test]
    fn every_sample_is_taken_once() {
        for microseconds in [1, 900, 130_000, 7_000_000] {
            let mut plan = FramePlan::new(37, 21, FREE);
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

    /// No frame has more than there is room for, and what is not whole does not count.
    #[test]
    fn frames_keep_to_their_room() {
        let room = Room { slots: 256, samples: 3, paths: 640, whole_passes: true };
        let mut plan = FramePlan::new(24, 24, room);
        let (mut passes, mut taken) = (0, 0);
        while let Some(frame) = plan.next(7) {
            assert!(frame.slots <= 256 && frame.samples <= 3 && frame.slots * frame.samples <= 640, "{frame:?}");
            taken += frame.slots * frame.samples;
            passes += u32::from(plan.ends_pass(frame));
            plan.done(frame, Duration::from_micros(1));
            assert_eq!(plan.counts(), vec![u64::from(plan.done); 24 * 24]);
        }
        assert_eq!((taken, plan.spp()), (7 * 576, 7));
        assert!(passes >= 3);
    }

    #[test]
    fn counts_tell_an_unfinished_pass() {
        let mut plan = FramePlan::new(16, 8, FREE);
        plan.capacity = 64;
        let frame = plan.next(1).unwrap();
        assert_eq!((frame.slots, frame.samples), (64, 1));
        plan.done(frame, Duration::from_millis(100));
        let counts = plan.counts();
        assert_eq!(counts[0..8], [1; 8]);
        assert_eq!(counts[8..16], [0; 8]);
    }
}
