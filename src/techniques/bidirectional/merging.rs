//! What `vcm` keeps: all light subpaths of a sample, a grid to find their vertices in, the merge radius, and splats.

use super::super::light_paths::{LightPathSize, LightPathStore};
use super::super::merging::{Grid, MergeRadius, MergeSchedule, merged_vertices};
use super::super::settings::Settings;
use super::super::splat_planes::SplatPlanes;
use super::super::state::{Context, FrameLimits, StateBytes, StateKind, TechniqueState};
use super::super::stream::StateStream;
use super::super::table::Pass;
use crate::error::Result;
use crate::layout::{BIDIRECTIONAL_LENGTH, FrameConstants, LightVertex};
use crate::scene::Scene;

/// What vertex connection and merging keeps.
pub(in super::super) struct ConnectingAndMerging;

/// The grid is that of one sample, and so are splats.
const PLANES: u64 = 1;

fn light_paths(settings: &Settings) -> LightPathSize {
    let vertices = merged_vertices(settings, BIDIRECTIONAL_LENGTH - 1);
    LightPathSize::of_sample(settings, vertices, size_of::<LightVertex>())
}

impl StateKind for ConnectingAndMerging {
    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        let light_paths = light_paths(settings);
        let [cells, places] = Grid::bytes(light_paths);
        Ok(vec![SplatPlanes::bytes(settings, PLANES), light_paths.bytes(), cells, places])
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let (gpu, settings, size) = (context.gpu, context.settings, light_paths(context.settings));
        Ok(Box::new(ConnectingAndMergingState {
            splats: SplatPlanes::new(gpu, settings, PLANES)?,
            light_paths: LightPathStore::new(gpu, size)?,
            grid: Grid::new(gpu, size)?,
            radius: MergeRadius::of(&settings.technique, context.scene, size.paths as u32),
        }))
    }
}

struct ConnectingAndMergingState {
    splats: SplatPlanes,
    light_paths: LightPathStore,
    grid: Grid,
    radius: MergeRadius,
}

impl TechniqueState for ConnectingAndMergingState {
    fn describe(&self, sample: u32, constants: &mut FrameConstants) {
        self.splats.describe(constants);
        self.light_paths.describe(constants);
        self.grid.describe(constants);
        constants.light_path_count = self.light_paths.size.paths as u32;
        constants.merge_radius = self.radius.at(sample);
    }

    fn limits(&self) -> FrameLimits {
        self.splats.limits().and(self.grid.limits())
    }

    fn elements(&self, pass: &Pass) -> u32 {
        self.grid.elements(pass)
    }

    fn set_merge_schedule(&mut self, schedule: MergeSchedule) {
        self.radius.schedule = schedule;
    }

    fn restart(&mut self, _: u32) -> Result<()> {
        self.splats.restart()
    }

    fn exchange(&mut self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        self.splats.exchange(stream, under_way)?;
        self.light_paths.exchange(stream, under_way)?;
        self.grid.exchange(stream, under_way)
    }
}
