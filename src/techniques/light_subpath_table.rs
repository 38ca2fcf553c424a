//! The table of techniques that keep nothing but what [`LightSubpathTable`] says.

use super::state::StateBytes;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::LightSubpathTable;

const NAME: &str = "technique table";

/// What it takes.
pub(super) fn bytes() -> StateBytes {
    StateBytes::exact(NAME, size_of::<LightSubpathTable>() as u64)
}

/// Writes it to the device: `describe` fills it in.
pub(super) fn upload(gpu: &Gpu, describe: impl FnOnce(&mut LightSubpathTable)) -> Result<Buffer> {
    let mut table = LightSubpathTable::default();
    describe(&mut table);
    Buffer::with_data(gpu, NAME, &[table])
}
