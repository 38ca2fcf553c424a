//! What techniques with paths from the lights need besides the film: planes of splats, the vertices of light paths, and a grid to
//! find these in. All are bounded whatever the image's size: a frame is cut so that it fits, or a sample has fewer light paths.

use super::frames::{Room, slots};
use super::state::State;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{BIDIRECTIONAL_LENGTH, FIXED_RGB_BYTES, GridCell, LightVertex, WORKGROUP};
use crate::techniques::{Kept, Settings};

/// Bytes of splats that more than one sample per frame may take.
const SPLAT_BYTES: u64 = 64 << 20;
/// Bytes of light paths that more than the least frame may take.
const LIGHT_PATH_BYTES: u64 = 256 << 20;
/// Cells of the grid for each light path, at least: where the radius is small, each of its few vertices is alone in a cell.
const CELLS_OF_PATH: u64 = 2;
/// Bytes of a vertex's place in the grid.
const PLACE_BYTES: u64 = 4;
/// The most samples of a frame: more planes than this save no time.
const MOST_PLANES: u64 = 64;

/// How much there is of each, before anything is allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ScratchSize {
    /// Samples that have a plane of splats; 0 where the technique has none.
    pub planes: u64,
    /// Bytes of all planes.
    pub splat_bytes: u64,
    /// Vertices that a light path has room for.
    pub vertices: u32,
    /// Light paths that have room.
    pub paths: u64,
    /// Bytes of all light paths.
    pub light_path_bytes: u64,
    /// Cells of the grid; 0 where there is none.
    pub cells: u32,
    /// Bytes of the cells, and of the places that they share.
    pub cell_bytes: u64,
    pub place_bytes: u64,
    /// Light paths in each sample of the image.
    pub light_paths: u32,
    /// Each sample shows patches in a state of their own.
    pub has_patches: bool,
}

impl ScratchSize {
    pub fn of(settings: &Settings) -> Self {
        let row = settings.technique.row;
        let pixels = u64::from(settings.width) * u64::from(settings.height);
        let plane = pixels * u64::from(settings.layers().max(1)) * u64::from(FIXED_RGB_BYTES);
        let has_grid = matches!(row.kept, Kept::Grid(..));
        let planes = match (row.splats, has_grid) {
            (false, _) => 0,
            (true, true) => 1, // the grid is that of one sample
            (true, false) => (SPLAT_BYTES / plane).clamp(1, MOST_PLANES),
        };
        let (vertex, vertices) = match row.kept {
            Kept::Nothing | Kept::Chains | Kept::Patches => (0, 0),
            Kept::Paths => (size_of::<LightVertex>() as u32, connected(settings.max_depth)),
            Kept::Grid(bytes, most) => (bytes, most.min(gathered(settings.max_depth))),
        };
        let path = 4 + u64::from(vertices) * u64::from(vertex);
        let all = slots(settings.width, settings.height) * planes.max(1);
        let least = u64::from(WORKGROUP) * planes.max(1);
        let paths = match row.kept {
            Kept::Nothing | Kept::Chains | Kept::Patches => 0,
            Kept::Paths => (LIGHT_PATH_BYTES / path).max(least).min(all),
            Kept::Grid(..) => (LIGHT_PATH_BYTES / path).min(pixels),
        };
        let cells = if has_grid { (paths * CELLS_OF_PATH).next_power_of_two() } else { 0 };
        Self {
            planes,
            splat_bytes: planes * plane,
            vertices,
            paths,
            light_path_bytes: paths * path,
            cells: cells as u32,
            cell_bytes: if has_grid { 4 + cells * size_of::<GridCell>() as u64 } else { 0 },
            place_bytes: if has_grid { paths * u64::from(vertices) * PLACE_BYTES } else { 0 },
            light_paths: match row.kept {
                Kept::Grid(..) => paths as u32,
                Kept::Chains => places(settings) as u32,
                Kept::Nothing | Kept::Paths | Kept::Patches => pixels as u32,
            },
            has_patches: row.kept == Kept::Patches,
        }
    }

    /// Places for vertices of light paths.
    pub fn places(&self) -> u32 {
        (self.place_bytes / PLACE_BYTES) as u32
    }

    /// What it leaves of frames.
    pub fn room(&self, max_workgroups: u32) -> Room {
        let has_grid = self.cells > 0;
        Room {
            slots: max_workgroups.saturating_mul(WORKGROUP).max(WORKGROUP),
            samples: match (has_grid || self.has_patches, self.planes) {
                (true, _) => 1,
                (false, 0) => u32::MAX,
                (false, planes) => planes as u32,
            },
            paths: if self.paths > 0 && !has_grid { self.paths } else { u64::MAX },
            whole_passes: self.planes > 0,
        }
    }
}

/// Pixels of the image with the border from which wide filters reach into it.
fn places(settings: &Settings) -> u64 {
    let border = (settings.filter.radius() - 0.5).max(0.0).ceil() as u64;
    (u64::from(settings.width) + 2 * border) * (u64::from(settings.height) + 2 * border)
}

/// Vertices of a light path that a path from the camera may be connected to: the second one onwards, up to one less than the
/// longest path has segments.
fn connected(max_depth: Option<u32>) -> u32 {
    max_depth.unwrap_or(u32::MAX).min(BIDIRECTIONAL_LENGTH).saturating_sub(2)
}

/// Vertices of a light path that paths from the camera may meet: as many as the longest path has segments, less one.
fn gathered(max_depth: Option<u32>) -> u32 {
    max_depth.unwrap_or(u32::MAX).saturating_sub(1)
}

/// The buffers.
pub(super) struct Scratch {
    pub size: ScratchSize,
    pub splats: Buffer,
    pub light_paths: Buffer,
    pub grid_cells: Buffer,
    pub grid_places: Buffer,
}

impl Scratch {
    pub fn new(gpu: &Gpu, settings: &Settings) -> Result<Self> {
        let size = ScratchSize::of(settings);
        Ok(Self {
            size,
            splats: Buffer::zeroed(gpu, "splats", size.splat_bytes)?,
            light_paths: Buffer::new(gpu, "light paths", size.light_path_bytes)?,
            grid_cells: Buffer::new(gpu, "grid cells", size.cell_bytes)?,
            grid_places: Buffer::new(gpu, "grid places", size.place_bytes)?,
        })
    }

    /// What a pass that is under way has left for its later stages.
    pub fn transfer(&self, state: &mut State) -> Result<()> {
        [&self.splats, &self.light_paths, &self.grid_cells, &self.grid_places]
            .into_iter()
            .try_for_each(|buffer| state.buffer(buffer))
    }
}
