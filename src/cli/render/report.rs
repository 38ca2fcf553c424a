//! What a rendering came to: the JSON object, the EXR header, the summary.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;

use lumbre::error::Result;
use lumbre::gpu::Gpu;
use lumbre::image::{NamedLayer, Picture};
use lumbre::render::film::{BadSample, ErrorEstimate, Film};
use lumbre::render::{KernelSize, Renderer, Technique};
use lumbre::scene::{Needs, Scene};

use super::super::output::print;
use super::fireflies::{Firefly, print_fireflies};

/// The JSON object of `lumbre render`; its keys are a contract.
#[derive(Serialize)]
pub(super) struct Report {
    schema: &'static str,
    scene: String,
    integrator: String,
    backend: &'static str,
    device: String,
    driver: String,
    width: u32,
    height: u32,
    spp: u64,
    seed: u32,
    max_depth: i64,
    rr_depth: u32,
    filter: String,
    sampler: &'static str,
    energy_compensation: bool,
    mip_maps: bool,
    rays: u64,
    seconds: Seconds,
    mrays_per_s: f64,
    samples_per_s: f64,
    nonfinite: u64,
    nonfinite_at: Vec<BadSample>,
    mean: [f64; 3],
    kernels: Vec<KernelSize>,
    estimated_relmse: Option<f64>,
    /// Why the error is at least that, rather than that; nothing where the estimate is to be trusted.
    estimate_doubt: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    brightness: Option<Brightness>,
    /// What has denoised the image; the other figures are of the noisy one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub denoiser: Option<String>,
    /// What the technique has to say, by its key.
    #[serde(flatten)]
    technique: BTreeMap<&'static str, serde_json::Value>,
    /// The brightest samples, where they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    fireflies: Vec<Firefly>,
    peak_device_bytes: u64,
    #[serde(skip)]
    technique_summary: Vec<String>,
}

/// What the image of Markov chains is scaled by.
#[derive(Serialize)]
struct Brightness {
    mean: f64,
    standard_error: f64,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    build: f64,
    compile: f64,
    render: f64,
    device: f64,
    total: f64,
}

impl Report {
    pub fn new(
        scene: &Scene,
        gpu: &Gpu,
        renderer: &Renderer,
        film: &Film,
        load: f64,
        started: Instant,
    ) -> Result<Self> {
        let settings = renderer.settings();
        let took = renderer.seconds();
        let samples: u64 = film.counts.iter().sum();
        let render = took.render.max(1e-9);
        let estimate = film.error_estimate();
        let report = renderer.report()?;
        let needs = Needs::of(scene);
        Ok(Self {
            schema: "lumbre-render-1",
            scene: scene.source.display().to_string(),
            integrator: settings.technique.describe(),
            backend: settings.backend.name(),
            device: gpu.survey().name.clone(),
            driver: gpu.survey().driver.clone(),
            width: settings.width,
            height: settings.height,
            spp: film.spp(),
            seed: settings.seed,
            max_depth: settings.max_depth.map_or(-1, i64::from),
            rr_depth: settings.rr_depth,
            filter: format!("{:?}", settings.filter),
            sampler: settings.sampler.name(),
            energy_compensation: needs.energy_compensation,
            mip_maps: needs.mip_maps,
            rays: renderer.rays(),
            seconds: Seconds {
                load,
                build: took.build,
                compile: took.compile,
                render: took.render,
                device: took.device,
                total: started.elapsed().as_secs_f64(),
            },
            mrays_per_s: renderer.rays() as f64 / render / 1e6,
            samples_per_s: samples as f64 / render,
            nonfinite: film.nonfinite,
            nonfinite_at: film.bad_samples.clone(),
            mean: film.average(),
            kernels: renderer.kernel_sizes(),
            estimated_relmse: estimate.map(|estimate| estimate.relmse),
            estimate_doubt: estimate.and_then(|estimate| doubt(&estimate, &settings.technique, scene)),
            brightness: film
                .brightness
                .map(|found| Brightness { mean: found.mean, standard_error: found.variance.sqrt() }),
            denoiser: None,
            technique: report.iter().map(|report| (report.key, report.figures.clone())).collect(),
            technique_summary: report.map_or(Vec::new(), |report| report.summary),
            fireflies: Vec::new(),
            peak_device_bytes: gpu.peak_bytes(),
        })
    }

    /// The report with the brightest samples.
    pub fn with_fireflies(self, fireflies: Vec<Firefly>) -> Self {
        Self { fireflies, ..self }
    }

    /// Every setting and figure, for the EXR header.
    fn header(&self) -> Vec<(String, String)> {
        let Ok(serde_json::Value::Object(fields)) = serde_json::to_value(self) else { return Vec::new() };
        let text = |value: serde_json::Value| match value {
            serde_json::Value::String(text) => text,
            other => other.to_string(),
        };
        fields.into_iter().map(|(name, value)| (format!("lumbre.{name}"), text(value))).collect()
    }
}

/// Why an error is at least as large as it is estimated to be; nothing where the estimate is to be trusted.
fn doubt(estimate: &ErrorEstimate, technique: &Technique, scene: &Scene) -> Option<String> {
    if let Some(light) = technique.finds_rarely(scene) {
        return Some(format!("{} finds {light} only with rare, bright samples", technique.row.name));
    }
    let share = 100.0 * estimate.worst_share;
    estimate.is_at_least().then(|| format!("a thousandth of the pixels makes {share:.0} % of its square"))
}

/// The image with its layers by length or strategy, and those that `--aov` asks for.
pub(super) fn picture(film: &Film, report: &Report, mut further: Vec<NamedLayer>) -> Picture {
    let mut layers = Vec::new();
    let count = film.lengths.len();
    for layer in 0..count {
        let open_ended = layer + 1 == count && report.max_depth != count as i64;
        let name = format!("length{:02}{}", layer + 1, if open_ended { "plus" } else { "" });
        layers.push(NamedLayer::colours(name, film.length(layer)));
    }
    for found in &film.strategies {
        let name = found.strategy.name();
        layers.push(NamedLayer::colours(format!("{name}_unweighted"), film.image_of(&found.unweighted)));
        layers.push(NamedLayer::colours(name, film.image_of(&found.weighted)));
    }
    layers.append(&mut further);
    Picture { image: film.mean(), layers, header: report.header() }
}

pub(super) fn print_summary(report: &Report, outputs: &[PathBuf], interrupted: bool) {
    if interrupted {
        print("interrupted: what was rendered is kept");
    }
    let depth = if report.max_depth < 0 { String::from("no limit") } else { report.max_depth.to_string() };
    print(&format!("scene      {}, {}x{}", report.scene, report.width, report.height));
    print(&format!(
        "technique  {} on {}, {} spp, depth {depth}, seed {}",
        report.integrator, report.backend, report.spp, report.seed
    ));
    print(&format!("device     {} ({})", report.device, report.driver));
    let s = &report.seconds;
    print(&format!(
        "seconds    {:.3} (load {:.3}, build {:.3}, compile {:.3}, render {:.3})",
        s.total, s.load, s.build, s.compile, s.render
    ));
    print(&format!("speed      {:.3} Msamples/s, {:.2} Mrays/s", report.samples_per_s / 1e6, report.mrays_per_s));
    let [r, g, b] = report.mean;
    let error = match (&report.brightness, report.estimated_relmse) {
        (Some(found), _) => {
            format!("scaled by a brightness known to {:.2} %", 100.0 * found.standard_error / found.mean)
        }
        (None, Some(error)) => match &report.estimate_doubt {
            None => format!("relative standard error of a pixel {:.3}", error.sqrt()),
            Some(why) => format!("relative standard error of a pixel at least {:.3}: {why}", error.sqrt()),
        },
        (None, None) => String::from("relative standard error of a pixel unknown from one sample"),
    };
    print(&format!("mean       {r:.6} {g:.6} {b:.6}, {error}"));
    report.technique_summary.iter().for_each(|line| print(line));
    if let Some(denoiser) = &report.denoiser {
        print(&format!("denoised   by {denoiser}; the mean and its error are those of the noisy image"));
    }
    if report.nonfinite > 0 {
        let first = report
            .nonfinite_at
            .first()
            .map_or(String::new(), |bad| format!("; the first at pixel ({}, {}), sample {}", bad.x, bad.y, bad.sample));
        print(&format!("nonfinite  {} samples were dropped{first}", report.nonfinite));
    }
    print_fireflies(&report.fireflies);
    if report.spp == 0 {
        print("warning    the time was too short for one sample per pixel: part of the image is black");
    }
    let written: Vec<_> = outputs.iter().map(|path| path.display().to_string()).collect();
    print(&format!("wrote      {}", written.join(", ")));
}
