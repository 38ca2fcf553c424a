//! Radiosity: patches of the scene's surfaces on the device, and the rounds in which they pass light on.

mod patches;
mod report;
mod state;

pub use report::PatchReport;
pub(super) use state::Patches;
pub use state::Radiosity;
