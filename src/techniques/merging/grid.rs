//! The grid in which camera subpaths find the vertices of light subpaths within a radius.

use super::super::light_paths::LightPathSize;
use super::super::state::{FrameLimits, StateBytes};
use super::super::stream::StateStream;
use super::super::table::Pass;
use super::super::table::merging::{GRID_ALLOT, GRID_CLEAR, GRID_COUNT, GRID_FILL};
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{GridCell, GridPlace, LightSubpathTable, address};

const CELLS: &str = "grid cells";
const PLACES: &str = "grid places";
/// Cells of the grid for each light subpath, at least: where the radius is small, each of its few vertices is alone in a cell.
const CELLS_OF_PATH: u64 = 2;
const PLACE_BYTES: u64 = size_of::<GridPlace>() as u64;

/// A hash grid over the vertices of all light subpaths of one sample.
pub(in super::super) struct Grid {
    cell_count: u32,
    place_count: u32,
    cells: Buffer,
    places: Buffer,
}

/// Cells for so many subpaths, a power of two.
fn cell_count(size: LightPathSize) -> u64 {
    (size.paths * CELLS_OF_PATH).next_power_of_two()
}

/// The number of places taken, and the cells.
fn cell_bytes(size: LightPathSize) -> u64 {
    4 + cell_count(size) * size_of::<GridCell>() as u64
}

impl Grid {
    /// What it takes.
    pub fn bytes(size: LightPathSize) -> [StateBytes; 2] {
        [StateBytes::exact(CELLS, cell_bytes(size)), StateBytes::exact(PLACES, size.places() * PLACE_BYTES)]
    }

    /// Makes it; what it holds is undefined.
    pub fn new(gpu: &Gpu, size: LightPathSize) -> Result<Self> {
        Ok(Self {
            cell_count: cell_count(size) as u32,
            place_count: size.places() as u32,
            cells: Buffer::new(gpu, CELLS, cell_bytes(size))?,
            places: Buffer::new(gpu, PLACES, size.places() * PLACE_BYTES)?,
        })
    }

    /// It holds one sample.
    pub fn limits(&self) -> FrameLimits {
        FrameLimits { samples: 1, ..FrameLimits::NONE }
    }

    /// What its passes run over.
    pub fn elements(&self, pass: &Pass) -> u32 {
        match *pass {
            GRID_CLEAR | GRID_ALLOT => self.cell_count,
            GRID_COUNT | GRID_FILL => self.place_count,
            _ => 0,
        }
    }

    /// Writes where it is.
    pub fn describe(&self, table: &mut LightSubpathTable) {
        table.grid_cells = address(self.cells.address());
        table.grid_places = address(self.places.address());
        table.grid_cell_count = self.cell_count;
    }

    /// Between passes it is of no further use.
    pub fn exchange(&self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        if under_way {
            stream.buffer(&self.cells)?;
            stream.buffer(&self.places)?;
        }
        Ok(())
    }
}
