//! Techniques: the table of what there is; the technique, parameters and settings that a rendering was asked for; and what each technique
//! keeps on the device.
//!
//! A family has a folder: `row.rs` holds its rows, which `build.rs` reads as well, the other files its state. A state is put together from
//! `splat_planes`, `light_paths` and `merging`, or is its own.

mod bidirectional;
mod light;
mod light_paths;
mod light_table;
mod merging;
mod metropolis;
mod pace;
mod photon;
mod radiosity;
mod sampler;
mod settings;
mod splat_planes;
mod state;
mod stream;
mod table;
mod technique;

pub use bidirectional::{LONGEST, Strategies, Strategy};
pub use merging::MergeSchedule;
pub use metropolis::Chains;
pub(crate) use pace::Pace;
pub use radiosity::{PatchReport, Radiosity};
pub use sampler::{SAMPLERS, Sampler, SamplerRow};
pub use settings::Settings;
pub(crate) use settings::slots;
pub use state::{Context, FilmScale, FrameLimits, Job, NextState, StateBytes, StateReport, TechniqueState};
pub(crate) use state::{StateKind, nothing};
pub use stream::StateStream;
pub(crate) use table::stages;
pub use table::{
    Bias, Chance, Correlated, Kept, Missing, Over, Parameter, Pass, Solves, TECHNIQUES, TechniqueRow, Values, find,
    structs,
};
pub use technique::Technique;

impl TechniqueRow {
    /// The kind of state that the technique has.
    pub(crate) fn state(&self) -> &'static dyn StateKind {
        match self.kept {
            Kept::Nothing => &state::Nothing,
            Kept::Splats => &light::LightTracing,
            Kept::LightSubpaths => &bidirectional::Connecting,
            Kept::MergedSubpaths => &bidirectional::ConnectingAndMerging,
            Kept::Photons => &photon::PhotonMapping,
            Kept::Chains => &metropolis::MarkovChains,
            Kept::Patches => &radiosity::Patches,
        }
    }
}
