//! Arguments that say how a scene is rendered, which every sub-command that follows paths takes.

use clap::Args;

use lumbre::techniques::{Overrides, Sampler};

use super::args::{Depth, parse_depth, parse_sampler, parse_size};

/// How to render.
#[derive(Args)]
pub(super) struct SettingsArgs {
    /// Technique, with parameters as NAME:PARAMETER=VALUE; `lumbre list` shows them all. By default the
    /// one that the scene's file names, else path, or bdpt where points, spots, projectors or
    /// parallel light make caustics
    #[arg(short = 'i', long, value_name = "NAME")]
    pub(super) integrator: Option<String>,

    /// Size of the image in pixels
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,

    /// Longest path in segments (1: emission only, 2: adds direct light); -1 is no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse_depth)]
    pub(super) max_depth: Option<Depth>,

    /// Segments after which Russian roulette may end a path, once its throughput is low
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub(super) rr_depth: Option<u32>,

    /// Probability that Russian roulette ends a path, for techniques with a constant one
    #[arg(long, value_name = "Q", allow_negative_numbers = true)]
    pub(super) rr_q: Option<String>,

    /// Where uniform numbers come from: sobol (the default but for mlt) or independent
    #[arg(long, value_name = "NAME", value_parser = parse_sampler)]
    pub(super) sampler: Option<Sampler>,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u32,

    /// Ray backend: auto, ray-query or bvh
    #[arg(long, value_name = "NAME", default_value = "auto")]
    pub(super) backend: String,

    /// Camera by name or number; the scene's first one by default
    #[arg(long, value_name = "NAME")]
    pub(super) camera: Option<String>,
}

impl SettingsArgs {
    /// What they ask for beyond the scene's file.
    pub(super) fn overrides(&self) -> Overrides {
        Overrides {
            technique: self.integrator.clone(),
            backend: Some(self.backend.clone()),
            size: self.size,
            camera: self.camera.clone(),
            max_depth: self.max_depth.map(|Depth(depth)| depth),
            rr_depth: self.rr_depth,
            rr_q: self.rr_q.clone(),
            sampler: self.sampler,
            seed: self.seed,
        }
    }
}
