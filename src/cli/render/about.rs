//! What an image and a checkpoint say of a rendering and its settings, whatever came of it.

use serde::{Deserialize, Serialize};

use lumbre::gpu::Gpu;
use lumbre::merge::names;
use lumbre::render::{KernelSize, Renderer};
use lumbre::scene::{Needs, Scene};

/// What is said of a rendering whatever came of it, as checkpoints keep it.
#[derive(Clone, Serialize, Deserialize)]
pub(in super::super) struct About {
    pub settings: SettingsOf,
    /// Light that the technique finds with rare, bright samples alone.
    pub rare: Option<String>,
}

impl About {
    pub fn new(scene: &Scene, gpu: &Gpu, renderer: &Renderer) -> Self {
        let rare = renderer.settings().technique.finds_rarely(scene).map(|light| light.to_string());
        Self { settings: SettingsOf::new(scene, gpu, renderer), rare }
    }

    /// What is true of the rendering that these shards are all of; nothing where there are none. Devices and drivers are listed.
    pub fn whole(shards: &[Self]) -> Option<Self> {
        let first = shards.first()?;
        let all = |of: fn(&SettingsOf) -> &str| names(shards.iter().map(|shard| of(&shard.settings)));
        let mut settings = first.settings.clone();
        settings.device = all(|own| &own.device);
        settings.driver = all(|own| &own.driver);
        if shards.iter().any(|shard| shard.settings.kernels != first.settings.kernels) {
            settings.kernels.clear();
        }
        (settings.shard, settings.shards) = (None, Some(shards.len()));
        Some(Self { settings, rare: first.rare.clone() })
    }
}

/// A part of the JSON object of `lumbre render`; its keys are a contract.
#[derive(Clone, Serialize, Deserialize)]
pub(in super::super) struct SettingsOf {
    schema: String,
    pub scene: String,
    pub integrator: String,
    pub backend: String,
    pub device: String,
    pub driver: String,
    pub width: u32,
    pub height: u32,
    pub seed: u32,
    pub max_depth: i64,
    rr_depth: u32,
    filter: String,
    sampler: String,
    energy_compensation: bool,
    mip_maps: bool,
    kernels: Vec<KernelSize>,
    /// Which share of the samples it is: `K/N`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shard: Option<String>,
    /// Of how many shards it was put together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shards: Option<usize>,
}

impl SettingsOf {
    fn new(scene: &Scene, gpu: &Gpu, renderer: &Renderer) -> Self {
        let settings = renderer.settings();
        let needs = Needs::of(scene);
        Self {
            schema: String::from("lumbre-render-1"),
            scene: scene.source.display().to_string(),
            integrator: settings.technique.describe(),
            backend: settings.backend.name().to_owned(),
            device: gpu.survey().name.clone(),
            driver: gpu.survey().driver.clone(),
            width: settings.width,
            height: settings.height,
            seed: settings.seed,
            max_depth: settings.max_depth.map_or(-1, i64::from),
            rr_depth: settings.rr_depth,
            filter: format!("{:?}", settings.filter),
            sampler: settings.sampler.name().to_owned(),
            energy_compensation: needs.energy_compensation,
            mip_maps: needs.mip_maps,
            kernels: renderer.kernel_sizes(),
            shard: settings.shard.map(|shard| shard.to_string()),
            shards: None,
        }
    }
}
