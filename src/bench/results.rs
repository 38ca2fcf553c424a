//! What a bench found, as `results.json` holds it: schema `lumbre-bench-2`, documented in `docs/bench.md`.
//!
//! Images are files beside it, named relative to the folder. Every figure that is a mean over seeds comes with its interval.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
pub use crate::image::metrics::pixels::HEAVY_TAIL;
use crate::reference::Certificate;
use crate::statistics::Interval;

/// The name and version of the schema.
pub const SCHEMA: &str = "lumbre-bench-2";

/// A whole bench.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Results {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of lumbre.
    pub version: String,
    /// The command line, as it was typed.
    pub command: String,
    /// When it began, ISO 8601 in UTC.
    pub started: String,
    /// The device that it ran on.
    pub device: Device,
    /// Independent runs of each variant.
    pub seeds: u32,
    /// Seconds of rendering per run, if time was the limit.
    pub seconds: Option<f64>,
    /// Samples per pixel of each run, if those were the limit.
    pub spp: Option<u32>,
    /// Confidence of all intervals, 0.95.
    pub confidence: f64,
    /// One entry per scene.
    pub scenes: Vec<SceneResults>,
}

/// Where a bench ran.
#[derive(Clone, Debug, Serialize, Deserialize, PartialEq, Eq)]
pub struct Device {
    /// The device's name.
    pub name: String,
    /// The driver and its version.
    pub driver: String,
    /// Logical processors of the host.
    pub processors: u32,
    /// Operating system and processor architecture.
    pub host: String,
}

/// One scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SceneResults {
    /// Its name: the file's, without folder and extension, made unique.
    pub name: String,
    /// The file, as it was named on the command line.
    pub file: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Longest path in segments, -1 for no limit.
    pub max_depth: i64,
    /// Triangles, each counted once however often it is placed.
    pub triangles: u64,
    /// Lights.
    pub lights: u64,
    /// What images were compared with.
    pub reference: Reference,
    /// One entry per variant, in the order of the command line.
    pub variants: Vec<VariantResults>,
    /// Each variant against the first one.
    pub pairs: Vec<Pair>,
    /// All variants after the same time, where they have it in common.
    pub equal_time: Option<Row>,
    /// All variants at the same number of samples, where they have one in common.
    pub equal_spp: Option<Row>,
}

/// The image that stands for the truth.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reference {
    /// The image, an EXR file of the bench's folder.
    pub image: String,
    /// The image as a PNG file of the bench's folder.
    pub picture: String,
    /// `given`, `made` or `cached`.
    pub origin: String,
    /// What made it, if it was made here.
    pub technique: Option<String>,
    /// Samples per pixel, if it was made here.
    pub spp: Option<u64>,
    /// Its own noise as a relMSE, which has been taken off all errors; nothing where the file does not say its variance.
    pub relmse: Option<f64>,
    /// Seconds that making or checking it took in this bench; 0 where it was there.
    pub seconds: f64,
    /// What is known of it; nothing of a file that says nothing and was not checked.
    pub certificate: Option<Certificate>,
    /// Where it differs from its witness, in deviations: red where the witness is brighter, a PNG file.
    pub difference_map: Option<String>,
    /// Why figures against it are not to be trusted, in one sentence; nothing where it was confirmed.
    pub doubt: Option<String>,
}

/// One variant: a technique, a backend and options.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct VariantResults {
    /// Its name, unique in the bench: `path on bvh`, `path on bvh, no-specialise`, `mitsuba scalar_rgb`.
    pub name: String,
    /// The program and its version: `lumbre 0.1.0`, `Mitsuba 3.9.1`.
    pub renderer: String,
    /// Technique with its parameters.
    pub technique: String,
    /// Ray backend, or the peer's variant.
    pub backend: String,
    /// Options that differ from the default, such as `no-specialise` or `lights=power`.
    pub options: Vec<String>,
    /// What the table says of its bias; empty where it is unbiased.
    pub bias: String,
    /// What differs from the other variants, to be printed below the figures.
    pub notes: Vec<String>,
    /// Seconds before the first sample.
    pub setup: Setup,
    /// Bytes on the device at their peak.
    pub device_bytes: Option<u64>,
    /// Errors along the way, by growing numbers of samples.
    pub curve: Vec<CurvePoint>,
    /// 1 / (relMSE x seconds) at the end of each run.
    pub efficiency: Interval,
    /// 1 / (error x seconds) at the end of each run, the error being the relMSE of all but the worst thousandth of the pixels.
    pub trimmed_efficiency: Interval,
    /// 1 / (error x seconds), the error being the relMSE as the median of the means of eight parts of the image.
    pub parts_efficiency: Interval,
    /// 1 / (error x seconds), the error being the median of the pixels' squared relative errors.
    pub median_efficiency: Interval,
    /// Share of the relMSE that the worst thousandth of the pixels makes at the end of a run, the most of all runs: above
    /// [`HEAVY_TAIL`], few bright samples decide it.
    pub worst_share: f64,
    /// Slope of log error over log seconds: -1 for plain Monte Carlo.
    pub slope: Interval,
    /// Of which error: relMSE, or the median where few pixels decide that, as each rare bright sample makes a step of it.
    pub slope_of: Figure,
    /// relMSE that more samples do not take away.
    pub floor: Floor,
    /// Mean of the image over that of the reference.
    pub energy_ratio: Interval,
    /// The renderer's own estimate of its relMSE over the true one, at the end of the runs; nothing where it makes none.
    #[serde(default)]
    pub estimate_ratio: Option<Interval>,
    /// Pixel samples per second of rendering.
    pub samples_per_s: Interval,
    /// Rays per second of rendering; nothing where the renderer does not count them.
    pub rays_per_s: Option<Interval>,
    /// The runs themselves, one per seed.
    pub runs: Vec<Run>,
}

/// Seconds before the first sample.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Setup {
    /// Reading the scene.
    pub load: f64,
    /// Building the acceleration structure and uploading.
    pub build: f64,
    /// Making the kernels, their first dispatch included, which is when CPU devices compile.
    pub compile: f64,
}

/// Means over seeds at one number of samples.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct CurvePoint {
    /// Samples per pixel; the mean over seeds where time was the limit.
    pub spp: f64,
    /// Seconds of rendering until then, by the host's clock.
    pub seconds: Interval,
    /// Seconds until then by the device's clock: the kernels alone.
    pub device_seconds: Option<Interval>,
    /// relMSE.
    pub relmse: Interval,
    /// relMSE without the worst thousandth of the pixels.
    pub trimmed_relmse: Interval,
    /// relMSE as the median of the means of eight parts of the image, into which pixels are dealt at random.
    pub parts_relmse: Interval,
    /// Median of the pixels' squared relative errors.
    pub median_relmse: Interval,
    /// MSE.
    pub mse: Interval,
    /// MAPE.
    pub mape: Interval,
    /// FLIP.
    pub flip: Interval,
}

/// Error that stays however many samples are taken.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Floor {
    /// Estimate of it as a relMSE; noise can make it negative.
    pub relmse: f64,
    /// Its standard deviation if there were no such error.
    pub deviation: f64,
    /// Whether it is significant (more than four deviations): the technique is biased here, or the reference is.
    pub flagged: bool,
}

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// Its seed.
    pub seed: u32,
    /// Errors along the way; the last one is the end.
    pub points: Vec<Point>,
    /// Rays traced in all.
    pub rays: Option<u64>,
    /// Samples that were not finite and were dropped.
    pub nonfinite: u64,
    /// The image at the end, an EXR file of the bench's folder.
    pub image: String,
}

/// Figures of one image along the way of a run, the reference's own noise taken off.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Point {
    /// Samples per pixel.
    pub spp: u64,
    /// Seconds of rendering until then, by the host's clock.
    pub seconds: f64,
    /// Seconds of rendering until then, by the device's clock.
    pub device_seconds: Option<f64>,
    /// Mean of (a - b)².
    pub mse: f64,
    /// Mean of (a - b)² / (b² + 0.01).
    pub relmse: f64,
    /// relMSE without the worst thousandth of the pixels.
    pub trimmed_relmse: f64,
    /// relMSE as the median of the means of eight parts of the image, into which pixels are dealt at random.
    pub parts_relmse: f64,
    /// Median over the pixels of what it is the mean of.
    pub median_relmse: f64,
    /// Share of the relMSE that the worst thousandth of the pixels makes.
    pub worst_share: f64,
    /// Mean of |a - b| / (|b| + 0.01).
    pub mape: f64,
    /// Mean of FLIP.
    pub flip: f64,
    /// Mean of the image over that of the reference.
    pub energy_ratio: f64,
    /// The renderer's own estimate of its relMSE, from the variance of its samples.
    #[serde(default)]
    pub estimated_relmse: Option<f64>,
}

/// One variant against the scene's first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Pair {
    /// The variant.
    pub variant: String,
    /// The one that it is compared with.
    pub against: String,
    /// Its efficiency over the other's, by relMSE.
    pub efficiency: Ratio,
    /// Its efficiency over the other's, by the relMSE without the worst thousandth of the pixels.
    pub trimmed: Ratio,
    /// Its efficiency over the other's, by the relMSE as the median of the means of eight parts.
    pub parts: Ratio,
    /// Its efficiency over the other's, by the median of the pixels' squared relative errors.
    pub median: Ratio,
    /// Its samples per second over the other's.
    pub speed_ratio: Interval,
    /// The figure that the ratio is told by: relMSE, or that of eight parts where few pixels decide the relMSE of either variant.
    pub decided_by: Figure,
    /// The figure whose test fits the tails: relMSE, or without the worst pixels where few of them decide.
    pub tested_by: Figure,
    /// Whether the efficiencies differ by that test, and the same way as the ratio.
    pub significant: bool,
}

/// A ratio of efficiencies with its test.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Ratio {
    /// The ratio of the geometric means over the seeds.
    pub ratio: Interval,
    /// Whether it differs from 1 at the 1 % level of Welch's test of the logarithms.
    pub significant: bool,
}

/// A figure of error that efficiencies can be made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Figure {
    /// relMSE.
    Relmse,
    /// relMSE without the worst thousandth of the pixels.
    Trimmed,
    /// relMSE as the median of the means of eight parts of the image.
    Parts,
    /// Median of the pixels' squared relative errors.
    Median,
}

/// Images of all variants side by side.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    /// What they have in common: seconds, or samples per pixel.
    pub at: f64,
    /// One per variant, in their order.
    pub cells: Vec<Cell>,
}

/// One variant's image in a row.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cell {
    /// The variant.
    pub variant: String,
    /// Samples per pixel of this image.
    pub spp: f64,
    /// Seconds that it took.
    pub seconds: f64,
    /// Its relMSE.
    pub relmse: f64,
    /// The image, a PNG file of the bench's folder.
    pub picture: String,
    /// A part of it, enlarged, a PNG file.
    pub crop: String,
    /// Its relative difference from the reference: red where too bright, blue where too dark, a PNG file.
    pub heat_map: String,
    /// The relative difference that full colour stands for, the same in the whole row.
    pub heat_scale: f64,
}

impl Results {
    /// Reads `results.json`.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|error| Error::read(path, error))?;
        let value: serde_json::Value = serde_json::from_str(&text).map_err(|error| Error::read(path, error))?;
        match value.get("schema").and_then(serde_json::Value::as_str) {
            Some(SCHEMA) => serde_json::from_value(value).map_err(|error| Error::read(path, error)),
            Some(other) => Err(Error::read(path, format!("its schema is '{other}': valid is {SCHEMA}"))),
            None => {
                Err(Error::read(path, format!("it has no schema: results of a bench have \"schema\": \"{SCHEMA}\"")))
            }
        }
    }
}

/// The least relMSE that an efficiency is computed with: below it the reference's own noise is all that is left.
pub(super) const LEAST_ERROR: f64 = 1e-12;
/// The least seconds that a rate is computed with.
const LEAST_SECONDS: f64 = 1e-9;

impl Point {
    /// 1 / (relMSE x seconds).
    pub fn efficiency(&self) -> f64 {
        self.efficiency_by(Figure::Relmse)
    }

    /// 1 / (error x seconds), by one figure of error.
    pub fn efficiency_by(&self, figure: Figure) -> f64 {
        1.0 / (self.error(figure).max(LEAST_ERROR) * self.seconds.max(LEAST_SECONDS))
    }

    /// That figure of error.
    pub fn error(&self, figure: Figure) -> f64 {
        match figure {
            Figure::Relmse => self.relmse,
            Figure::Trimmed => self.trimmed_relmse,
            Figure::Parts => self.parts_relmse,
            Figure::Median => self.median_relmse,
        }
    }

    /// So many of something, per second of rendering.
    pub fn per_second(&self, count: f64) -> f64 {
        count / self.seconds.max(LEAST_SECONDS)
    }
}

/// How far from the true relMSE a renderer's own estimate may be to count as right.
pub const ESTIMATE_TOLERANCE: f64 = 0.15;

impl VariantResults {
    /// How often the renderer's own estimate of its relMSE at the end of a run was right within [`ESTIMATE_TOLERANCE`] of the
    /// true one: so many runs, of so many that have an estimate.
    pub fn estimate_coverage(&self) -> (usize, usize) {
        let last = self.runs.iter().filter_map(|run| run.points.last());
        let ratios: Vec<f64> = last.filter_map(|point| Some(point.estimated_relmse? / point.relmse)).collect();
        let right = ratios.iter().filter(|ratio| (**ratio - 1.0).abs() <= ESTIMATE_TOLERANCE).count();
        (right, ratios.len())
    }

    /// The figures at the end of the runs.
    pub fn last(&self) -> Option<&CurvePoint> {
        self.curve.last()
    }
}
