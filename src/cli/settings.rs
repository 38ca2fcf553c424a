//! Arguments that say how a scene is rendered, which every sub-command that follows paths takes.

use clap::Args;

use lumbre::error::Result;
use lumbre::gpu::Gpu;
use lumbre::render::{Settings, Technique};
use lumbre::scene::Scene;
use lumbre::techniques::Sampler;

use super::args::{Depth, choose_backend, parse_depth, parse_sampler, parse_size};

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
    /// The technique that the command names, if it names one.
    pub(super) fn technique(&self) -> Result<Option<Technique>> {
        self.integrator.as_deref().map(Technique::parse).transpose()
    }

    /// What the command line, then the scene, then the defaults ask for; `asked` is the technique that the command names.
    pub(super) fn settle(&self, scene: &Scene, gpu: &Gpu, asked: Option<Technique>) -> Result<Settings> {
        let mut technique = Technique::of_scene(scene, asked)?;
        if let Some(q) = &self.rr_q {
            technique.set("q", q)?;
        }
        let mut settings = Settings::new(scene, technique, choose_backend(&self.backend, gpu)?);
        settings.set_camera(scene, self.camera.as_deref())?;
        if let Some((width, height)) = self.size {
            (settings.width, settings.height) = (width, height);
        }
        settings.sampler = self.sampler.unwrap_or(settings.sampler);
        settings.seed = self.seed;
        if let Some(Depth(depth)) = self.max_depth {
            settings.max_depth = depth;
        }
        settings.rr_depth = self.rr_depth.unwrap_or(settings.rr_depth);
        Ok(settings)
    }
    /// The words of a command line that asks for the same.
    pub(super) fn words(&self, settings: &Settings) -> Vec<String> {
        let mut words = vec![String::from("-i"), settings.technique.describe()];
        let mut add = |flag: &str, value: String| words.extend([flag.to_owned(), value]);
        add("--size", format!("{}x{}", settings.width, settings.height));
        if let Some(camera) = &self.camera {
            add("--camera", camera.clone());
        }
        add("--max-depth", settings.max_depth.map_or(-1, i64::from).to_string());
        if let Some(depth) = self.rr_depth {
            add("--rr-depth", depth.to_string());
        }
        if let Some(sampler) = self.sampler {
            add("--sampler", sampler.name().to_owned());
        }
        add("--backend", settings.backend.name().to_owned());
        add("--seed", settings.seed.to_string());
        words
    }
}
