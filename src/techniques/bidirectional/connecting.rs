//! What `bdpt` keeps: the light subpath of each camera subpath, and splats.

use super::super::light_paths::{LightPathSize, LightPathStore};
use super::super::light_subpath_table;
use super::super::settings::Settings;
use super::super::splat_planes::SplatPlanes;
use super::super::state::{Context, FrameLimits, StateBytes, StateKind, TechniqueState};
use super::super::stream::StateStream;
use crate::error::Result;
use crate::gpu::Buffer;
use crate::layout::{BIDIRECTIONAL_LENGTH, LightVertex};
use crate::scene::Scene;

/// What bidirectional path tracing keeps.
pub(in super::super) struct Connecting;

/// Vertices of a light subpath that a camera subpath may be connected to: the second one onwards, up to one less than the longest path
/// has segments.
fn connected_vertices(settings: &Settings) -> u32 {
    settings.max_depth.unwrap_or(u32::MAX).min(BIDIRECTIONAL_LENGTH).saturating_sub(2)
}

fn light_paths(settings: &Settings) -> LightPathSize {
    let samples = SplatPlanes::several(settings);
    LightPathSize::of_frame(settings, connected_vertices(settings), size_of::<LightVertex>(), samples)
}

impl StateKind for Connecting {
    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        let splats = SplatPlanes::bytes(settings, SplatPlanes::several(settings));
        Ok(vec![light_subpath_table::bytes(), splats, light_paths(settings).bytes()])
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let settings = context.settings;
        let splats = SplatPlanes::new(context.gpu, settings, SplatPlanes::several(settings))?;
        let light_paths = LightPathStore::new(context.gpu, light_paths(settings))?;
        let table = light_subpath_table::upload(context.gpu, |table| {
            splats.describe(table);
            light_paths.describe(table);
            table.light_path_count = settings.pixels() as u32;
        })?;
        Ok(Box::new(ConnectingState { table, splats, light_paths }))
    }
}

struct ConnectingState {
    table: Buffer,
    splats: SplatPlanes,
    light_paths: LightPathStore,
}

impl TechniqueState for ConnectingState {
    fn table(&self) -> u64 {
        self.table.address()
    }

    fn limits(&self) -> FrameLimits {
        self.splats.limits().and(self.light_paths.size.limits())
    }

    fn restart(&mut self, _: u32) -> Result<()> {
        self.splats.restart()
    }

    fn exchange(&mut self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        self.splats.exchange(stream, under_way)?;
        self.light_paths.exchange(stream, under_way)
    }
}
