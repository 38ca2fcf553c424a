//! Cutting a rendering into frames of about a tenth of a second.

use std::time::Duration;

use crate::error::Result;
use crate::layout::WORKGROUP;
use crate::techniques::{BLOCK_SAMPLES, FrameLimits, Pace, StateStream, slots};

/// One dispatch: a run of slots (pixels in tiles of 8 x 8) and a run of samples for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    pub first_slot: u32,
    pub slots: u32,
    pub first_sample: u32,
    pub samples: u32,
    /// Stages that it goes through.
    pub first_stage: u32,
    pub stages: u32,
}

impl Frame {
    /// Nothing to do, in every stage.
    pub const NOTHING: Self =
        Self { first_slot: 0, slots: 0, first_sample: 0, samples: 0, first_stage: 0, stages: u32::MAX };

    /// Whether it goes through that stage.
    pub fn has_stage(&self, stage: u32) -> bool {
        stage >= self.first_stage && stage - self.first_stage < self.stages
    }
}

/// How far a rendering is, and how large its next frame is. A pass gives all slots the same number of samples; a slow
/// device takes several frames over one pass, a fast one several samples per pass. Where a pass has stages, all slots go
/// through one before any begins the next: in frames of its own, or, where one frame has all slots, in that. No pass has samples of two
/// blocks ([`BLOCK_SAMPLES`]).
#[derive(Clone, Debug)]
pub(super) struct FramePlan {
    width: u32,
    height: u32,
    slots: u32,
    stages: u32,
    /// The most slots of a dispatch.
    most_slots: u32,
    limits: FrameLimits,
    /// The index of the first sample.
    first: u32,
    /// The index of the next sample of all slots.
    done: u32,
    /// Stage of the current pass, slots that are through it already, and the samples of that pass.
    stage: u32,
    cursor: u32,
    pass: u32,
    /// Pixel samples of a stage that fit into a frame.
    pace: Pace,
    /// The most of them that a frame may have, whatever the speed.
    bound: u64,
}

impl FramePlan {
    /// For an image of this size, in frames of up to `most_slots`.
    pub fn new(width: u32, height: u32, stages: u32, most_slots: u32, limits: FrameLimits) -> Self {
        Self {
            width,
            height,
            slots: slots(width, height) as u32, // checked before anything is allocated
            stages,
            most_slots,
            limits,
            first: 0,
            done: 0,
            stage: 0,
            cursor: 0,
            pass: 0,
            pace: Pace::new(),
            bound: u64::MAX,
        }
    }

    /// The plan at its beginning; what it knows of the speed stays.
    pub fn restarted(&self) -> Self {
        Self { done: self.first, stage: 0, cursor: 0, pass: 0, ..self.clone() }
    }

    /// The plan of samples from this index on.
    pub fn starting_at(self, first: u32) -> Self {
        Self { first, done: first, ..self }
    }

    /// Bounds the pixel samples of a frame's stage, whatever the speed.
    pub fn bound(&mut self, most: u64) {
        self.bound = most;
    }

    /// What bounds them.
    pub fn bound_of_frames(&self) -> u64 {
        self.bound
    }

    /// The next frame, or nothing once all slots have `target` samples.
    pub fn next(&self, target: u32) -> Option<Frame> {
        let begins = self.is_between_passes();
        let target = self.first.saturating_add(target);
        if begins && self.done >= target {
            return None;
        }
        let capacity = self.pace.fits().min(self.bound).min(self.limits.pixel_samples);
        let through_all = capacity / u64::from(self.stages);
        let samples = if begins {
            let fit = (through_all / u64::from(self.slots)).max(1);
            let of_block = BLOCK_SAMPLES - self.done % BLOCK_SAMPLES;
            u32::try_from(fit).unwrap_or(u32::MAX).min(self.limits.samples).min(of_block).min(target - self.done)
        } else {
            self.pass
        };
        // Whole workgroups; as many as there is room for, and one at least.
        let wanted = (capacity / u64::from(samples)).next_multiple_of(u64::from(WORKGROUP));
        let fit =
            wanted.min(self.limits.pixel_samples / u64::from(samples) / u64::from(WORKGROUP) * u64::from(WORKGROUP));
        let slots =
            u32::try_from(fit).unwrap_or(u32::MAX).clamp(WORKGROUP, self.most_slots).min(self.slots - self.cursor);
        let fits = slots == self.slots && u64::from(slots) * u64::from(samples) <= through_all;
        let (first_stage, stages) = if begins && fits { (0, self.stages) } else { (self.stage, 1) };
        Some(Frame { first_slot: self.cursor, slots, first_sample: self.done, samples, first_stage, stages })
    }

    /// Takes note of a frame that has been run.
    pub fn done(&mut self, frame: Frame, took: Duration) {
        let work = u64::from(frame.slots) * u64::from(frame.samples) * u64::from(frame.stages);
        self.pace.took(work, took);
        self.pass = frame.samples;
        self.cursor += frame.slots;
        if self.cursor >= self.slots {
            self.cursor = 0;
            self.stage += frame.stages;
        }
        if self.stage >= self.stages {
            self.stage = 0;
            self.done += self.pass;
        }
    }

    /// Whether all slots have the same samples: nothing of a pass is under way.
    pub fn is_between_passes(&self) -> bool {
        self.stage == 0 && self.cursor == 0
    }

    /// How far it is; not what it knows of the speed, which is that of another process.
    pub fn exchange(&mut self, stream: &mut StateStream) -> Result<()> {
        stream.numbers([&mut self.done, &mut self.stage, &mut self.cursor, &mut self.pass])?;
        let is_whole = self.is_between_passes() || self.pass > 0;
        let (stage, stages, cursor, slots) = (self.stage, self.stages, self.cursor, self.slots);
        let (done, first) = (self.done, self.first);
        stream.check(done >= first, || format!("{done} as the next sample: valid are those from {first} on"))?;
        stream.check(is_whole && stage < stages && cursor < slots, || {
            format!("slot {cursor} of stage {stage}: valid are slots below {slots}, stages below {stages}, and a pass of some samples")
        })
    }

    /// The most slots of a dispatch.
    pub fn most_slots(&self) -> u32 {
        self.most_slots
    }

    /// Whether this frame ends its stages: all slots are through them then.
    pub fn ends_stages(&self, frame: Frame) -> bool {
        frame.first_slot + frame.slots >= self.slots
    }

    /// Whether all slots have a whole block of samples once this frame is done.
    pub fn ends_block(&self, frame: Frame) -> bool {
        let ends_pass = self.ends_stages(frame) && frame.first_stage.saturating_add(frame.stages) >= self.stages;
        ends_pass && frame.samples > 0 && (frame.first_sample + frame.samples).is_multiple_of(BLOCK_SAMPLES)
    }

    /// Samples that all slots have.
    pub fn spp(&self) -> u32 {
        self.done - self.first
    }

    pub fn progress(&self) -> f64 {
        let stages = f64::from(self.stage) + f64::from(self.cursor) / f64::from(self.slots);
        f64::from(self.spp()) + f64::from(self.pass) * stages / f64::from(self.stages)
    }

    /// Samples of each pixel, row by row.
    pub fn counts(&self) -> Vec<u64> {
        let tiles_across = self.width.div_ceil(8);
        if self.limits.whole_passes {
            return vec![u64::from(self.spp()); self.width as usize * self.height as usize];
        }
        let count = |x: u32, y: u32| {
            let slot = (y / 8 * tiles_across + x / 8) * 64 + y % 8 * 8 + x % 8;
            let has_pass = self.stage + 1 == self.stages && slot < self.cursor;
            u64::from(self.spp()) + if has_pass { u64::from(self.pass) } else { 0 }
        };
        (0..self.height).flat_map(|y| (0..self.width).map(move |x| count(x, y))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: u32 = 1 << 22;

    /// Whatever the speed, every slot gets every sample exactly once and in order.
    #[test]
    fn every_sample_is_taken_once() {
        for microseconds in [1, 900, 130_000, 7_000_000] {
            let mut plan = FramePlan::new(37, 21, 1, FREE, FrameLimits::NONE);
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
    fn frames_keep_to_their_limits() {
        let limits = FrameLimits { samples: 3, pixel_samples: 640, whole_passes: true };
        let mut plan = FramePlan::new(24, 24, 1, 256, limits);
        let (mut passes, mut taken) = (0, 0);
        while let Some(frame) = plan.next(7) {
            assert!(frame.slots <= 256 && frame.samples <= 3 && frame.slots * frame.samples <= 640, "{frame:?}");
            taken += frame.slots * frame.samples;
            passes += u32::from(plan.ends_stages(frame));
            plan.done(frame, Duration::from_micros(1));
            assert_eq!(plan.counts(), vec![u64::from(plan.done); 24 * 24]);
        }
        assert_eq!((taken, plan.spp()), (7 * 576, 7));
        assert!(passes >= 3);
    }

    /// Whatever the speed, all slots are through a stage before any begins the next, and each is in it once.
    #[test]
    fn stages_follow_each_other() {
        for microseconds in [1, 900, 130_000, 7_000_000] {
            let mut plan = FramePlan::new(37, 21, 3, FREE, FrameLimits::NONE);
            let slots = plan.slots as usize;
            let mut reached = vec![(0, 0); slots];
            while let Some(frame) = plan.next(20) {
                for stage in (0..3).filter(|stage| frame.has_stage(*stage)) {
                    for slot in frame.first_slot..frame.first_slot + frame.slots {
                        assert_eq!(reached[slot as usize], (frame.first_sample, stage));
                        reached[slot as usize] = if stage < 2 {
                            (frame.first_sample, stage + 1)
                        } else {
                            (frame.first_sample + frame.samples, 0)
                        };
                    }
                    if plan.ends_stages(frame) {
                        assert!(reached.iter().all(|at| *at == reached[0]));
                    }
                }
                let work = u64::from(frame.slots * frame.samples * frame.stages);
                plan.done(frame, Duration::from_micros(microseconds * work / 100));
                assert!(plan.counts().iter().zip(plan.counts().iter().skip(1)).all(|(a, b)| a.abs_diff(*b) <= 20));
            }
            assert_eq!(reached, vec![(20, 0); slots]);
            assert!((plan.progress() - 20.0).abs() < 1e-9);
        }
    }

    #[test]
    fn counts_tell_an_unfinished_pass() {
        let mut plan = FramePlan::new(16, 8, 1, FREE, FrameLimits::NONE);
        plan.pace = Pace::of(64);
        let frame = plan.next(1).unwrap();
        assert_eq!((frame.slots, frame.samples), (64, 1));
        plan.done(frame, Duration::from_millis(100));
        let counts = plan.counts();
        assert_eq!(counts[0..8], [1; 8]);
        assert_eq!(counts[8..16], [0; 8]);
    }
}
