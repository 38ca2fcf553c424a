//! What a rendering came to: the JSON object, the EXR header, the summary.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use lumbre::error::Result;
use lumbre::gpu::Gpu;
use lumbre::image::{NamedLayer, Picture};
use lumbre::render::Renderer;
use lumbre::render::film::{BadSample, ErrorEstimate, Film};

use super::super::output::print;
use super::about::SettingsOf;
use super::fireflies::{Firefly, print_fireflies};

/// The JSON object of `lumbre render`; its keys are a contract.
#[derive(Serialize)]
pub(in super::super) struct Report {
    #[serde(flatten)]
    about: SettingsOf,
    spp: u64,
    rays: u64,
    seconds: Seconds,
    mrays_per_s: f64,
    samples_per_s: f64,
    nonfinite: u64,
    nonfinite_at: Vec<BadSample>,
    mean: [f64; 3],
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
    /// Nothing where it was rendered in parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    peak_device_bytes: Option<u64>,
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
    /// Nothing where it was rendered in parts.
    #[serde(flatten)]
    before: Option<Before>,
    render: f64,
    device: f64,
    total: f64,
}

/// Seconds of what comes before the first sample.
#[derive(Serialize)]
struct Before {
    load: f64,
    build: f64,
    compile: f64,
}

/// What is known of a rendering besides its settings and its film.
pub(in super::super) struct Figures {
    /// Rays traced.
    pub rays: u64,
    /// Seconds of all frames by the host's clock, and by the device's.
    pub frames: [f64; 2],
    /// Light that the technique finds with rare, bright samples alone.
    pub rare: Option<String>,
}

impl Report {
    pub fn new(
        (about, figures): (SettingsOf, Figures),
        gpu: &Gpu,
        renderer: &Renderer,
        film: &Film,
        load: f64,
        started: Instant,
    ) -> Result<Self> {
        let took = renderer.seconds();
        let report = renderer.report()?;
        let own = Self::of_film(about, film, &figures);
        Ok(Self {
            seconds: Seconds {
                before: Some(Before { load, build: took.build, compile: took.compile }),
                total: started.elapsed().as_secs_f64(),
                ..own.seconds
            },
            technique: report.iter().map(|report| (report.key, report.figures.clone())).collect(),
            technique_summary: report.map_or(Vec::new(), |report| report.summary),
            peak_device_bytes: Some(gpu.peak_bytes()),
            ..own
        })
    }

    /// The report with the brightest samples.
    pub fn with_fireflies(self, fireflies: Vec<Firefly>) -> Self {
        Self { fireflies, ..self }
    }

    /// What a film and the settings say, whoever rendered it.
    pub fn of_film(about: SettingsOf, film: &Film, figures: &Figures) -> Self {
        let samples: u64 = film.counts.iter().sum();
        let [frames, device] = figures.frames;
        let estimate = film.error_estimate();
        let name = about.integrator.split(':').next().unwrap_or_default();
        Self {
            spp: film.spp(),
            rays: figures.rays,
            seconds: Seconds { before: None, render: frames, device, total: frames },
            mrays_per_s: figures.rays as f64 / frames.max(1e-9) / 1e6,
            samples_per_s: samples as f64 / frames.max(1e-9),
            nonfinite: film.nonfinite,
            nonfinite_at: film.bad_samples.clone(),
            mean: film.average(),
            estimated_relmse: estimate.map(|estimate| estimate.relmse),
            estimate_doubt: estimate.and_then(|estimate| doubt(&estimate, name, figures.rare.as_deref())),
            brightness: film
                .brightness
                .map(|found| Brightness { mean: found.mean, standard_error: found.variance.sqrt() }),
            denoiser: None,
            technique: BTreeMap::new(),
            technique_summary: Vec::new(),
            fireflies: Vec::new(),
            peak_device_bytes: None,
            about,
        }
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
fn doubt(estimate: &ErrorEstimate, technique: &str, rare: Option<&str>) -> Option<String> {
    if let Some(light) = rare {
        return Some(format!("{technique} finds {light} only with rare, bright samples"));
    }
    let share = 100.0 * estimate.worst_share;
    estimate.is_at_least().then(|| format!("a thousandth of the pixels makes {share:.0} % of its square"))
}

/// The image with its layers by length or strategy, and those that `--aov` asks for.
pub(in super::super) fn picture(film: &Film, report: &Report, mut further: Vec<NamedLayer>) -> Picture {
    let mut layers = Vec::new();
    let count = film.lengths.len();
    for layer in 0..count {
        let open_ended = layer + 1 == count && report.about.max_depth != count as i64;
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

pub(in super::super) fn print_summary(report: &Report, written: &[&Path], interrupted: bool) {
    if interrupted {
        print("interrupted: what was rendered is kept");
    }
    let depth = if report.about.max_depth < 0 { String::from("no limit") } else { report.about.max_depth.to_string() };
    print(&format!("scene      {}, {}x{}", report.about.scene, report.about.width, report.about.height));
    print(&format!(
        "technique  {} on {}, {} spp, depth {depth}, seed {}",
        report.about.integrator, report.about.backend, report.spp, report.about.seed
    ));
    print(&format!("device     {} ({})", report.about.device, report.about.driver));
    let s = &report.seconds;
    let parts = match &s.before {
        Some(Before { load, build, compile }) => {
            format!("(load {load:.3}, build {build:.3}, compile {compile:.3}, render {:.3})", s.render)
        }
        None => String::from("of rendering, all shards together"),
    };
    print(&format!("seconds    {:.3} {parts}", s.total));
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
    let written: Vec<_> = written.iter().map(|path| path.display().to_string()).collect();
    print(&format!("wrote      {}", written.join(", ")));
}
