//! The frames in which patches pass light on, between those of the image.

use std::collections::HashSet;
use std::time::Instant;

use super::frames::Frame;
use super::radiosity::{self, Radiosity};
use super::watch::{Building, Watch};
use super::{Renderer, Seconds, spent};
use crate::error::Result;
use crate::layout::{FrameConstants, WORKGROUP};
use crate::scene::Scene;
use crate::scene::patches::Quartered;

impl Renderer {
    /// Quarters patches where irradiance differs from one to the next, and tries again, until it differs nowhere or they are small enough.
    pub(super) fn quarter_patches(&mut self, scene: &Scene, watch: Watch) -> Result<()> {
        let threshold = radiosity::threshold(&self.settings);
        if self.radiosity.is_none() || threshold == 0.0 {
            return Ok(());
        }
        let started = Instant::now();
        watch(Building { doing: "quartering patches", share: Some(0.0) });
        let mut quartered = Quartered::These(HashSet::new());
        for _ in 0..radiosity::LEVELS {
            self.radiosity = self.radiosity.take().map(Radiosity::on_trial);
            while self.pass_light_on(0)? {}
            let uneven =
                self.radiosity.as_ref().map(|patches| patches.uneven(threshold, &quartered)).transpose()?.flatten();
            let (gpu, uploaded) = (self.gpu.clone(), &self.passes[0].1.scene);
            let found = uneven.is_some();
            quartered = uneven.unwrap_or(quartered);
            self.radiosity = None; // before there are two
            self.radiosity = Some(Radiosity::new(&gpu, scene, uploaded, &self.settings, &quartered)?);
            if !found {
                break;
            }
        }
        (self.rays, self.nonfinite) = (0, 0);
        self.bad_samples.clear();
        self.seconds = Seconds {
            build: self.seconds.build + started.elapsed().as_secs_f64(),
            render: 0.0,
            device: 0.0,
            ..self.seconds
        };
        Ok(())
    }

    /// Runs one frame of the patches, if the sample of that index is not ready to be shown yet.
    pub(super) fn pass_light_on(&mut self, sample: u32) -> Result<bool> {
        let room = self.plan.room().slots;
        let Some(radiosity) = &self.radiosity else { return Ok(false) };
        let Some(frame) = radiosity.next(sample, room, self.plan.bound_of_frames()) else { return Ok(false) };
        let started = Instant::now();
        let constants = FrameConstants {
            first_slot: frame.first,
            slot_count: frame.count,
            sample_count: frame.rays,
            round: frame.round,
            ..self.constants(Frame::NOTHING)
        };
        let pass = self.passes.iter().find(|(pass, _)| *pass == frame.task.pass());
        let (Some((_, kernel)), tally) = (pass, &self.tally) else { return Ok(false) };
        let name = format!("{} on {}", self.settings.technique.row.name, self.settings.backend.name());
        let work = format!("{} patches from {}, round {}", frame.count, frame.first, frame.round);
        let took = self.gpu.run(&name, &work, |commands| {
            commands.clear(tally);
            let workgroups = frame.count.div_ceil(WORKGROUP);
            commands.dispatch(&kernel.pipeline, &kernel.bindings, bytemuck::bytes_of(&constants), workgroups);
            commands.barrier();
        })?;
        self.take_in_tally()?;
        let wall = started.elapsed();
        if let Some(radiosity) = &mut self.radiosity {
            radiosity.done(frame, wall)?;
        }
        spent::rendered(wall.as_secs_f64(), 0);
        self.seconds.render += wall.as_secs_f64();
        self.seconds.device += took.device.as_secs_f64();
        Ok(true)
    }
}
