//! What `vcm` keeps: all light subpaths of a sample, a grid to find their vertices in, the merge radius, and splats.

use super::super::light_paths::{LightPathSize, LightPathStore};
use super::super::light_subpath_table;
use super::super::merging::{Grid, MergeRadius, MergeSchedule, merged_vertices};
use super::super::settings::Settings;
use super::super::splat_planes::SplatPlanes;
use super::super::state::{Context, FrameLimits, StateBytes, StateKind, TechniqueState};
use super::super::stream::StateStream;
use super::super::table::Pass;
use crate::error::Result;
use crate::gpu::Buffer;
use crate::layout::{BIDIRECTIONAL_LENGTH, LightVertex};
use crate::scene::Scene;

/// What vertex connection and merging keeps.
pub(in super::super) struct ConnectingAndMerging;

/// The grid is that of one sample, and so are splats.
const PLANES: u64 = 1;

fn light_paths(settings: &Settings) -> LightPathSize {
    let vertices = merged_vertices(settings, BIDIRECTIONAL_LENGTH - 1);
    LightPathSize::of_sample(settings.pixels(), vertices, size_of::<LightVertex>())
}

impl StateKind for ConnectingAndMerging {
    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        let light_paths = light_paths(settings);
        let [cells, places] = Grid::bytes(light_paths);
        Ok(vec![light_subpath_table::bytes(), SplatPlanes::bytes(settings, PLANES), light_paths.bytes(), cells, places])
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let (gpu, settings, size) = (context.gpu, context.settings, light_paths(context.settings));
        let splats = SplatPlanes::new(gpu, settings, PLANES)?;
        let light_paths = LightPathStore::new(gpu, size)?;
        let grid = Grid::new(gpu, size)?;
        let table = light_subpath_table::upload(gpu, |table| {
            splats.describe(table);
            light_paths.describe(table);
            grid.describe(table);
            table.light_path_count = size.paths as u32;
        })?;
        let radius = MergeRadius::of(&settings.technique, context.scene, size.paths as u32);
        Ok(Box::new(ConnectingAndMergingState { table, splats, light_paths, grid, radius }))
    }
}

struct ConnectingAndMergingState {
    table: Buffer,
    splats: SplatPlanes,
    light_paths: LightPathStore,
    grid: Grid,
    radius: MergeRadius,
}

impl TechniqueState for ConnectingAndMergingState {
    fn table(&self) -> u64 {
        self.table.address()
    }

    /// The bits of the merge radius.
    fn word(&self, sample: u32) -> u32 {
        self.radius.at(sample).to_bits()
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
