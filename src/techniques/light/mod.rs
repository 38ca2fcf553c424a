//! Light tracing: its samples reach pixels as splats.

use super::settings::Settings;
use super::splat_planes::SplatPlanes;
use super::state::{Context, FrameLimits, StateBytes, StateKind, TechniqueState};
use super::stream::StateStream;
use crate::error::Result;
use crate::layout::FrameConstants;
use crate::scene::Scene;

/// What light tracing keeps.
pub(super) struct LightTracing;

impl StateKind for LightTracing {
    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        Ok(vec![SplatPlanes::bytes(settings, SplatPlanes::several(settings))])
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let settings = context.settings;
        Ok(Box::new(LightTracingState {
            splats: SplatPlanes::new(context.gpu, settings, SplatPlanes::several(settings))?,
            paths: settings.pixels() as u32,
        }))
    }
}

struct LightTracingState {
    splats: SplatPlanes,
    /// Light paths of a sample.
    paths: u32,
}

impl TechniqueState for LightTracingState {
    fn describe(&self, _: u32, constants: &mut FrameConstants) {
        self.splats.describe(constants);
        constants.light_path_count = self.paths;
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
