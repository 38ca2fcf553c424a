//! Progressive photon mapping: the photons of one sample, and a grid to find them in.

use super::light_paths::{LightPathSize, LightPathStore};
use super::light_subpath_table;
use super::merging::{Grid, MergeRadius, MergeSchedule, merged_vertices};
use super::settings::Settings;
use super::state::{Context, FrameLimits, StateBytes, StateKind, TechniqueState};
use super::stream::StateStream;
use super::table::Pass;
use crate::error::Result;
use crate::gpu::Buffer;
use crate::layout::PHOTONS_OF_PATH;
use crate::scene::Scene;
use crate::techniques::table::photon::structs::Photon;

/// What photon mapping keeps.
pub(super) struct PhotonMapping;

fn light_paths(settings: &Settings) -> LightPathSize {
    LightPathSize::of_sample(settings.pixels(), merged_vertices(settings, PHOTONS_OF_PATH), size_of::<Photon>())
}

impl StateKind for PhotonMapping {
    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        let light_paths = light_paths(settings);
        let [cells, places] = Grid::bytes(light_paths);
        Ok(vec![light_subpath_table::bytes(), light_paths.bytes(), cells, places])
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let size = light_paths(context.settings);
        let light_paths = LightPathStore::new(context.gpu, size)?;
        let grid = Grid::new(context.gpu, size)?;
        let table = light_subpath_table::upload(context.gpu, |table| {
            light_paths.describe(table);
            grid.describe(table);
            table.light_path_count = size.paths as u32;
        })?;
        let radius = MergeRadius::of(&context.settings.technique, context.scene, size.paths as u32);
        Ok(Box::new(PhotonMappingState { table, light_paths, grid, radius }))
    }
}

struct PhotonMappingState {
    table: Buffer,
    light_paths: LightPathStore,
    grid: Grid,
    radius: MergeRadius,
}

impl TechniqueState for PhotonMappingState {
    fn table(&self) -> u64 {
        self.table.address()
    }

    /// The bits of the merge radius.
    fn word(&self, sample: u32) -> u32 {
        self.radius.at(sample).to_bits()
    }

    fn limits(&self) -> FrameLimits {
        self.grid.limits()
    }

    fn elements(&self, pass: &Pass) -> u32 {
        self.grid.elements(pass)
    }

    fn set_merge_schedule(&mut self, schedule: MergeSchedule) {
        self.radius.schedule = schedule;
    }

    fn exchange(&mut self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        self.light_paths.exchange(stream, under_way)?;
        self.grid.exchange(stream, under_way)
    }
}
