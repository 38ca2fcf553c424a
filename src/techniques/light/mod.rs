//! Light tracing: its samples reach pixels as splats.

use super::light_subpath_table;
use super::settings::Settings;
use super::splat_planes::SplatPlanes;
use super::state::{Context, FrameLimits, StateBytes, StateKind, TechniqueState};
use super::stream::StateStream;
use crate::error::Result;
use crate::gpu::Buffer;
use crate::scene::Scene;

/// What light tracing keeps.
pub(super) struct LightTracing;

impl StateKind for LightTracing {
    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        Ok(vec![light_subpath_table::bytes(), SplatPlanes::bytes(settings, SplatPlanes::several(settings))])
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let settings = context.settings;
        let splats = SplatPlanes::new(context.gpu, settings, SplatPlanes::several(settings))?;
        let table = light_subpath_table::upload(context.gpu, |table| {
            splats.describe(table);
            table.light_path_count = settings.pixels() as u32;
        })?;
        Ok(Box::new(LightTracingState { table, splats }))
    }
}

struct LightTracingState {
    table: Buffer,
    splats: SplatPlanes,
}

impl TechniqueState for LightTracingState {
    fn table(&self) -> u64 {
        self.table.address()
    }

    fn limits(&self) -> FrameLimits {
        self.splats.limits()
    }

    fn restart(&mut self, _: u32) -> Result<()> {
        self.splats.restart()
    }

    fn exchange(&mut self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        self.splats.exchange(stream, under_way)
    }
}
