//! Techniques: the table of what there is; the technique, parameters and settings that a rendering was asked for; and what each technique
//! keeps on the device.
//!
//! A family has a folder: `row.rs` holds its rows, which `build.rs` reads as well, `mod.rs` and what it names its state. `table.rs` lists
//! the families. A state is put together from
//! `splat_planes`, `light_paths` and `merging`, or is its own.

mod light_paths;
mod light_subpath_table;
mod merging;
mod overrides;
mod pace;
mod sampler;
mod settings;
mod shard;
mod splat_planes;
mod state;
mod stream;
pub(crate) mod table;
mod technique;

pub use bidirectional::{LONGEST, Strategies, Strategy};
pub use merging::MergeSchedule;
pub use metropolis::Chains;
pub use overrides::Overrides;
pub(crate) use pace::Pace;
pub use radiosity::{PatchReport, Radiosity};
pub use sampler::{SAMPLERS, Sampler, SamplerRow};
pub(crate) use settings::slots;
pub use settings::{AovSettings, Settings};
pub use shard::{BLOCK_SAMPLES, Shard};
pub use state::{Context, FilmScale, FrameLimits, Job, NextState, StateBytes, StateReport, TechniqueState, Trial};
pub(crate) use state::{StateKind, nothing};
pub use stream::StateStream;
pub(crate) use stream::{HostStore, Store};
use table::families;
pub(crate) use table::stages;
pub use table::{
    Bias, Correlated, Missing, Over, Parameter, Pass, RareLight, Solves, TECHNIQUES, TechniqueRow, Values, find,
    structs,
};
pub use technique::Technique;

macro_rules! states {
    ($( $family:ident $file:literal $(with $structs:ident)? : $($row:ident keeps $state:ident),+ ; )+) => {
        $(mod $family;)+

        /// The kind of state that each technique has, by the technique's name.
        const STATES: &[(&str, &dyn StateKind)] = &[$($((table::$family::$row.name, &$family::$state)),+),+];
    };
}
families!(states);

impl TechniqueRow {
    /// The kind of state that the technique has.
    pub(crate) fn state(&self) -> &'static dyn StateKind {
        STATES.iter().find(|(name, _)| *name == self.name).map_or(&state::Nothing, |(_, kind)| *kind)
    }
}
