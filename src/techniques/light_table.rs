//! The table of techniques that keep nothing but what [`LightTable`] says.

use super::state::StateBytes;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::LightTable;

const NAME: &str = "technique table";

/// What it takes.
pub(super) fn bytes() -> StateBytes {
    StateBytes::exact(NAME, size_of::<LightTable>() as u64)
}

/// Writes it to the device: `describe` fills it in.
pub(super) fn upload(gpu: &Gpu, describe: impl FnOnce(&mut LightTable)) -> Result<Buffer> {
    let mut table = LightTable::default();
    describe(&mut table);
    Buffer::with_data(gpu, NAME, &[table])
}
