//! Instant radiosity: the virtual point lights of one sample, which a job makes before it.

use std::time::Duration;

use super::light_paths::{LightPathSize, LightPathStore};
use super::light_subpath_table;
use super::settings::Settings;
use super::state::{Context, FrameLimits, Job, StateBytes, StateKind, TechniqueState};
use super::stream::StateStream;
use super::table::vpl::{LIGHTS, SUBPATHS};
use crate::error::Result;
use crate::gpu::Buffer;
use crate::layout::LightVertex;
use crate::scene::Scene;

/// Virtual point lights of a light subpath; of a longer one they are a random choice.
const MOST_VERTICES: u32 = 8;

/// What instant radiosity keeps.
pub(super) struct VirtualLights;

fn light_paths(settings: &Settings) -> LightPathSize {
    let subpaths = settings.technique.number(&SUBPATHS) as u64;
    // The segment to the camera and the connection are no vertices.
    let vertices = MOST_VERTICES.min(settings.max_depth.unwrap_or(u32::MAX).saturating_sub(2));
    LightPathSize::of_sample(subpaths, vertices, size_of::<LightVertex>())
}

impl StateKind for VirtualLights {
    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        Ok(vec![light_subpath_table::bytes(), light_paths(settings).bytes()])
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let light_paths = LightPathStore::new(context.gpu, light_paths(context.settings))?;
        let table = light_subpath_table::upload(context.gpu, |table| {
            light_paths.describe(table);
            table.light_path_count = light_paths.size.paths as u32;
        })?;
        Ok(Box::new(VirtualLightsState { table, light_paths, made_for: None }))
    }
}

struct VirtualLightsState {
    table: Buffer,
    light_paths: LightPathStore,
    /// The sample whose virtual point lights are there.
    made_for: Option<u32>,
}

impl TechniqueState for VirtualLightsState {
    fn table(&self) -> u64 {
        self.table.address()
    }

    fn limits(&self) -> FrameLimits {
        FrameLimits { samples: 1, ..FrameLimits::NONE }
    }

    fn next_job(&self, sample: u32, _: u64) -> Option<Job> {
        let count = self.light_paths.size.paths as u32;
        let about = format!("virtual point lights of {count} subpaths, sample {sample}");
        (self.made_for != Some(sample)).then_some(Job {
            pass: LIGHTS,
            first: 0,
            count,
            samples: 1,
            word: sample,
            about,
        })
    }

    fn job_done(&mut self, job: &Job, _: Duration) -> Result<()> {
        self.made_for = Some(job.word);
        Ok(())
    }

    fn restart(&mut self, _: u32) -> Result<()> {
        self.made_for = None;
        Ok(())
    }

    /// Those of the sample under way; before it begins there are none.
    fn exchange(&mut self, stream: &mut StateStream, _: bool) -> Result<()> {
        let (mut is_made, mut sample) = (u32::from(self.made_for.is_some()), self.made_for.unwrap_or_default());
        stream.numbers([&mut is_made, &mut sample])?;
        stream
            .check(is_made <= 1, || format!("{is_made} in place of 0 or 1: whether there are virtual point lights"))?;
        self.made_for = (is_made == 1).then_some(sample);
        self.light_paths.exchange(stream, is_made == 1)
    }
}
