//! Techniques: the table of what there is, and the technique, parameters and settings that a rendering was asked for.

mod bidirectional;
mod sampler;
mod settings;
mod table;
mod technique;

pub use bidirectional::{LONGEST, Strategies, Strategy};
pub use sampler::{SAMPLERS, Sampler, SamplerRow};
pub use settings::Settings;
pub(crate) use table::stages;
pub use table::{Bias, Chance, Kept, Missing, Over, Parameter, Pass, Solves, TECHNIQUES, TechniqueRow, Values, find};
pub use technique::Technique;

/// The passes of radiosity.
pub(crate) use table::radiosity as radiosity_passes;
