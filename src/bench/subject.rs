//! What a bench measures: something that renders one scene, run after run, and can be stopped on the way to be looked at.

use std::time::Instant;

use super::results::Setup;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::image::Image;
use crate::render::{Renderer, Settings};
use crate::scene::Scene;

/// When a run is to be stopped and looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Samples per pixel at which the run is stopped at the latest.
    pub spp: u32,
    /// Seconds of rendering after which it is stopped at the latest; no bound where there are none. Whichever comes first counts.
    pub seconds: Option<f64>,
}

/// A run as it stands.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The image.
    pub image: Image,
    /// Samples per pixel: the mean over pixels, where a pass was cut short.
    pub spp: f64,
    /// Seconds of rendering since the run began, by the host's clock.
    pub seconds: f64,
    /// Seconds of rendering since the run began, by the device's clock.
    pub device_seconds: Option<f64>,
    /// Rays traced since the run began.
    pub rays: Option<u64>,
    /// Samples that were not finite and were dropped.
    pub nonfinite: u64,
    /// The renderer's own estimate of its relMSE, from the variance of its samples.
    pub estimated_relmse: Option<f64>,
}

/// Something that renders one scene.
pub trait Subject {
    /// The program and its version.
    fn renderer(&self) -> String;
    /// Seconds that it took before the first sample.
    fn setup(&self) -> Setup;
    /// Bytes on the device at their peak.
    fn device_bytes(&self) -> Option<u64>;
    /// What differs from the other subjects, for the reader.
    fn notes(&self) -> Vec<String>;
    /// Begins a run.
    fn begin(&mut self, seed: u32) -> Result<()>;
    /// Goes on with the run until `stop`.
    fn advance(&mut self, stop: Stop) -> Result<Snapshot>;
}

/// lumbre itself.
pub struct Lumbre {
    renderer: Renderer,
    setup: Setup,
    device_bytes: u64,
}

impl Lumbre {
    /// Uploads the scene and makes the kernels; `load` is what reading the scene took, in seconds.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &Settings, load: f64) -> Result<Self> {
        let before = gpu.bytes_in_use();
        gpu.reset_peak();
        let renderer = Renderer::new(gpu, scene, settings)?;
        let seconds = renderer.seconds();
        Ok(Self {
            renderer,
            setup: Setup { load, build: seconds.build, compile: seconds.compile },
            device_bytes: gpu.peak_bytes() - before,
        })
    }
}

impl Subject for Lumbre {
    fn renderer(&self) -> String {
        format!("lumbre {}", env!("CARGO_PKG_VERSION"))
    }

    fn setup(&self) -> Setup {
        self.setup
    }

    fn device_bytes(&self) -> Option<u64> {
        Some(self.device_bytes)
    }

    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    fn begin(&mut self, seed: u32) -> Result<()> {
        self.renderer.remake_kernel()?;
        self.renderer.restart(seed)
    }

    fn advance(&mut self, stop: Stop) -> Result<Snapshot> {
        if let Some(seconds) = stop.seconds {
            self.renderer.set_time_budget(seconds);
        }
        let late = |renderer: &Renderer| {
            renderer.has_image() && stop.seconds.is_some_and(|limit| renderer.seconds().render >= limit)
        };
        while !late(&self.renderer) && self.renderer.advance(stop.spp)? {}
        let film = self.renderer.film()?;
        let samples: u64 = film.counts.iter().sum();
        let seconds = self.renderer.seconds();
        Ok(Snapshot {
            spp: samples as f64 / film.counts.len().max(1) as f64,
            seconds: seconds.render,
            device_seconds: Some(seconds.device),
            rays: Some(self.renderer.rays()),
            nonfinite: film.nonfinite,
            estimated_relmse: film.error_estimate().map(|estimate| estimate.relmse),
            image: film.mean(),
        })
    }
}

/// A scene that was read, with the seconds that it took.
pub fn timed_load(load: impl FnOnce() -> Result<Scene>) -> Result<(Scene, f64)> {
    let started = Instant::now();
    let scene = load()?;
    Ok((scene, started.elapsed().as_secs_f64()))
}
