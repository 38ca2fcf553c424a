//! What a user asks of a rendering beyond what the scene's file says.

use super::sampler::Sampler;
use super::settings::Settings;
use super::technique::Technique;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::layout::backend::Backend;
use crate::scene::Scene;

/// What is asked beyond the scene's file. Nothing is what the file says, or the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// The technique with its parameters, as `-i` takes it.
    pub technique: Option<String>,
    /// The ray backend, as `--backend` takes it.
    pub backend: Option<String>,
    /// Width and height of the image in pixels.
    pub size: Option<(u32, u32)>,
    /// The scene's camera, by name or number.
    pub camera: Option<String>,
    /// Longest path in segments; `Some(None)` is no limit.
    pub max_depth: Option<Option<u32>>,
    /// Segments after which Russian roulette may end a path.
    pub rr_depth: Option<u32>,
    /// Probability that Russian roulette ends a path, as `--rr-q` takes it, for techniques with a constant one.
    pub rr_q: Option<String>,
    /// Where uniform numbers come from.
    pub sampler: Option<Sampler>,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl Overrides {
    /// The technique that is named, if one is.
    pub fn technique(&self) -> Result<Option<Technique>> {
        self.technique.as_deref().map(Technique::parse).transpose()
    }

    /// Fails where a name is none, before there are a scene and a device to hold it against.
    pub fn check(&self) -> Result<()> {
        self.technique()?;
        self.backend.as_deref().map(Backend::parse).transpose()?;
        Ok(())
    }

    /// What is asked, then what the scene's file asks for, then the defaults.
    pub fn settle(&self, scene: &Scene, gpu: &Gpu) -> Result<Settings> {
        let mut technique = Technique::of_scene(scene, self.technique()?)?;
        if let Some(q) = &self.rr_q {
            technique.set("q", q)?;
        }
        let mut settings = Settings::new(scene, technique, gpu.backend(self.backend.as_deref())?);
        settings.set_camera(scene, self.camera.as_deref())?;
        (settings.width, settings.height) = self.size.unwrap_or((settings.width, settings.height));
        settings.sampler = self.sampler.unwrap_or(settings.sampler);
        settings.seed = self.seed;
        settings.max_depth = self.max_depth.unwrap_or(settings.max_depth);
        settings.rr_depth = self.rr_depth.unwrap_or(settings.rr_depth);
        Ok(settings)
    }

    /// The words of a command line that comes to these settings with the same scene, whatever the defaults.
    pub fn words(&self, settings: &Settings) -> Vec<String> {
        let mut words = vec![String::from("-i"), settings.technique.describe()];
        let mut add = |flag: &str, value: String| words.extend([flag.to_owned(), value]);
        add("--size", format!("{}x{}", settings.width, settings.height));
        if let Some(camera) = &self.camera {
            add("--camera", camera.clone());
        }
        add("--max-depth", settings.max_depth.map_or(-1, i64::from).to_string());
        if self.rr_depth.is_some() {
            add("--rr-depth", settings.rr_depth.to_string());
        }
        if self.sampler.is_some() {
            add("--sampler", settings.sampler.name().to_owned());
        }
        add("--backend", settings.backend.name().to_owned());
        add("--seed", settings.seed.to_string());
        words
    }
}
