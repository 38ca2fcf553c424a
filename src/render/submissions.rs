//! The submissions of a [`Renderer`]: which passes run over what, and what the device counted meanwhile.

use std::time::{Duration, Instant};

use super::film::BadSample;
use super::frames::Frame;
use super::records::Recorder;
use super::watch::{Building, Watch};
use super::{Counted, Renderer, spent};
use crate::error::{Error, Result};
use crate::gpu::Buffer;
use crate::layout::{BAD_SAMPLES, FrameConstants, RAY_COUNTERS, WORKGROUP, address};
use crate::techniques::{Context, Over, Trial, nothing};

/// A pass over a run of what it runs over.
pub(super) struct Run {
    /// Its index.
    pass: usize,
    first: u32,
    count: u32,
}

impl Renderer {
    /// What all passes of a frame are given.
    pub(super) fn constants(&self, frame: Frame) -> FrameConstants {
        FrameConstants {
            film: address(self.film.address()),
            layers: address(self.layers.address()),
            tally: address(self.tally.address()),
            technique: address(self.state.table()),
            records: address(self.recorder.as_ref().map_or(0, Recorder::address)),
            first_slot: frame.first_slot,
            slot_count: frame.slots,
            first_sample: frame.first_sample,
            sample_count: frame.samples,
            seed: self.settings.random_seed(),
            word: self.state.word(frame.first_sample),
        }
    }

    /// Runs stages for a part of the image, and where that ends them what runs over all there is; takes in what was counted. The
    /// time is the device's.
    pub(super) fn dispatch(&mut self, frame: Frame, ends_stages: bool) -> Result<Duration> {
        let Frame { first_slot, slots, first_sample, samples, .. } = frame;
        let work =
            format!("{slots} pixels from slot {first_slot}, samples {first_sample} to {}", first_sample + samples);
        // A frame of nothing makes CPU devices compile.
        let whole = |count: u32| (0, if samples > 0 { count } else { 0 });
        let all = self.settings.slots() as u32;
        let mut runs = Vec::new();
        for (index, ((pass, _), stage)) in self.passes.iter().zip(&self.stages).enumerate() {
            if !frame.has_stage(*stage) || !(ends_stages || pass.over == Over::Pixels) {
                continue;
            }
            let (first, count) = match pass.over {
                Over::Pixels => (first_slot, slots),
                Over::Image => whole(all),
                Over::Elements => whole(self.state.elements(pass)),
                Over::Jobs if samples > 0 => continue, // they have submissions of their own
                Over::Jobs => (0, 0),
            };
            runs.push(Run { pass: index, first, count });
        }
        let ends_block = self.plan.ends_block(frame);
        self.submit(&work, self.constants(frame), &runs, ends_block.then_some(all))
    }

    /// Runs one job of the technique's state, if the sample of that index needs any before it.
    pub(super) fn run_job(&mut self, sample: u32) -> Result<bool> {
        let Some(job) = self.state.next_job(sample, self.plan.bound_of_frames()) else { return Ok(false) };
        let Some(pass) = self.passes.iter().position(|(pass, _)| *pass == job.pass) else {
            return Err(Error::Device(format!(
                "{}: its state asks for the pass '{}', which is not among the kernels of this rendering",
                self.settings.technique.describe(),
                job.pass.name
            )));
        };
        let started = Instant::now();
        let constants = FrameConstants { sample_count: job.samples, word: job.word, ..self.constants(Frame::NOTHING) };
        let device = self.submit(&job.about, constants, &[Run { pass, first: job.first, count: job.count }], None)?;
        self.state.job_done(&job, started.elapsed())?;
        // What the state makes of a job on the host is part of the rendering as well.
        let wall = started.elapsed();
        spent::rendered(wall.as_secs_f64(), 0);
        self.took(wall, device);
        Ok(true)
    }

    /// Runs trials for as long as the state is one: what they took counts as building.
    pub(super) fn finish_trials(&mut self, context: &Context, watch: Watch) -> Result<()> {
        let Some(trial) = self.state.trial() else { return Ok(()) };
        let started = Instant::now();
        watch(Building { doing: trial.doing(), share: Some(0.0) });
        while self.state.trial().is_some() {
            while self.run_job(0)? {}
            let Some(make) = self.state.trial().map(Trial::next).transpose()? else { break };
            self.state = nothing(); // before there are two
            self.state = make(context)?;
        }
        self.counted = Counted::default();
        self.seconds.build += started.elapsed().as_secs_f64();
        Ok(())
    }

    /// Dispatches passes one after the other in one submission, which `work` describes, and takes in what was counted. `block`: the slots over
    /// which a block of samples ends after that.
    pub(super) fn submit(
        &mut self,
        work: &str,
        constants: FrameConstants,
        runs: &[Run],
        block: Option<u32>,
    ) -> Result<Duration> {
        let name = format!("{} on {}", self.settings.technique.row.name, self.settings.backend.name());
        let (passes, tally, room) = (&self.passes, &self.tally, self.plan.most_slots());
        let of_run = |run: &Run| (&passes[run.pass].1, run.first, run.count, constants);
        let of_plane =
            |(word, plane): (u32, &Buffer)| FrameConstants { technique: address(plane.address()), word, ..constants };
        let planes = (0..).zip(&self.blocks.planes).map(of_plane);
        let block = block.zip(self.blocks.kernel());
        let of_block =
            block.into_iter().flat_map(|(slots, kernel)| planes.clone().map(move |own| (kernel, 0, slots, own)));
        let took = self.gpu.run(&name, work, |commands| {
            commands.clear(tally);
            for (kernel, first, count, constants) in runs.iter().map(of_run).chain(of_block) {
                let mut start = first;
                loop {
                    let part = (first + count - start).min(room);
                    let constants = FrameConstants { first_slot: start, slot_count: part, ..constants };
                    let workgroups = part.div_ceil(WORKGROUP).max(1);
                    commands.dispatch(&kernel.pipeline, &kernel.bindings, bytemuck::bytes_of(&constants), workgroups);
                    start += part;
                    if start >= first + count {
                        break;
                    }
                }
                commands.barrier();
            }
        })?;
        self.take_in_tally()?;
        Ok(took.device)
    }

    /// Takes in what a submission has counted.
    fn take_in_tally(&mut self) -> Result<()> {
        let counted: Vec<u32> = self.tally.read((1 + 2 * BAD_SAMPLES + RAY_COUNTERS) as usize)?;
        let (bad, rays) = counted.split_at((1 + 2 * BAD_SAMPLES) as usize);
        self.counted.rays += rays.iter().map(|count| u64::from(*count)).sum::<u64>();
        self.counted.nonfinite += u64::from(bad[0]);
        let listed = bad[1..].chunks_exact(2).take((bad[0] as usize).min(BAD_SAMPLES as usize));
        let mut located: Vec<BadSample> = listed
            .map(|entry| BadSample {
                x: entry[0] % self.settings.width,
                y: entry[0] / self.settings.width,
                sample: entry[1],
            })
            .collect();
        located.sort_unstable();
        self.counted.locate(located);
        Ok(())
    }
}
