//! The runs of one scene: every variant with every seed, in turn, so that what the machine does besides falls on all alike.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::results::Run;
use super::subject::{Snapshot, Stop, Subject};
use crate::error::{Error, Result};
use crate::files::replace_by;
use crate::image::{Image, Picture, write_picture};
use crate::reference::Truth;

/// Samples of the run that warms a variant up and is not measured.
const WARM_UP: u32 = 1;

/// One column of a bench.
pub struct Variant {
    /// Its name, unique in the bench.
    pub name: String,
    /// Technique with its parameters.
    pub technique: String,
    /// Ray backend, or the peer's variant.
    pub backend: String,
    /// Options that differ from the default.
    pub options: Vec<String>,
    /// What the table says of its bias; empty where it is unbiased.
    pub bias: String,
    /// What renders it.
    pub subject: Box<dyn Subject>,
}

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Independent runs of each variant.
    pub seeds: u32,
    /// Seconds of rendering per run, if time is the limit.
    pub seconds: Option<f64>,
    /// Samples per pixel of each run, if those are.
    pub spp: Option<u32>,
    /// The seed of the first run.
    #[serde(default)]
    pub first_seed: u32,
}

/// What a bench tells while it runs.
pub enum Event<'a> {
    /// A run begins: the variant, its seed, and which of how many runs of the scene it is.
    Run(&'a str, u32, usize, usize),
    /// A run was there already.
    Kept(&'a str, u32),
    /// Images for the rows of equal time and equal samples are made.
    Rows,
}

/// The bench of one scene.
pub struct Bench<'a> {
    /// Where its files go.
    pub folder: &'a Path,
    /// Name of the scene, which begins the names of its files.
    pub scene: &'a str,
    /// How much is measured.
    pub limits: Limits,
    /// What all of it depends on: a run that was kept counts only if this is the same.
    pub fingerprint: u64,
    /// What images are compared with.
    pub truth: &'a Truth,
}

/// A run as it is kept in a file.
#[derive(Serialize, Deserialize)]
struct Kept {
    fingerprint: u64,
    variant: String,
    run: Run,
}

impl Bench<'_> {
    /// Runs what was not run yet: one list of runs per variant, in their order. `hear` is told what happens and ends the bench
    /// with an error.
    pub fn run(&self, variants: &mut [Variant], mut hear: impl FnMut(Event) -> Result<()>) -> Result<Vec<Vec<Run>>> {
        let count = variants.len();
        let total = count * self.limits.seeds as usize;
        let mut runs: Vec<Vec<Run>> = vec![Vec::new(); count];
        let mut warm = vec![false; count];
        for round in 0..self.limits.seeds {
            let seed = self.limits.first_seed + round;
            for turn in 0..count {
                // Another one begins each round, so that none always follows the same one.
                let index = (turn + round as usize) % count;
                let variant = &mut variants[index];
                if let Some(run) = self.kept(index, &variant.name, seed) {
                    hear(Event::Kept(&variant.name, seed))?;
                    runs[index].push(run);
                    continue;
                }
                hear(Event::Run(&variant.name, seed, round as usize * count + turn, total))?;
                if !std::mem::replace(&mut warm[index], true) {
                    variant.subject.begin(u32::MAX)?;
                    variant.subject.advance(Stop { spp: WARM_UP, seconds: self.limits.seconds })?;
                }
                let run = self.measure(variant.subject.as_mut(), index, seed)?;
                self.keep(index, &variant.name, &run)?;
                runs[index].push(run);
            }
        }
        Ok(runs)
    }

    /// One run, looked at after 1, 2, 4, ... samples and at its end.
    fn measure(&self, subject: &mut dyn Subject, index: usize, seed: u32) -> Result<Run> {
        subject.begin(seed)?;
        let most = self.limits.spp.unwrap_or(u32::MAX);
        let mut points = Vec::new();
        let mut next = 1u32;
        let last: Snapshot = loop {
            let spp = next.min(most);
            let snapshot = subject.advance(Stop { spp, seconds: self.limits.seconds })?;
            points.push(self.truth.point(&snapshot)?);
            let late = self.limits.seconds.is_some_and(|limit| snapshot.seconds >= limit);
            if late || spp == most {
                break snapshot;
            }
            next = next.saturating_mul(2);
        };
        let image = format!("{}-{index}-{seed}.exr", self.scene);
        let picture = Picture { image: last.image, layers: Vec::new(), header: Vec::new() };
        write_picture(&self.folder.join("runs").join(&image), &picture)?;
        Ok(Run { seed, points, rays: last.rays, nonfinite: last.nonfinite, image: format!("runs/{image}") })
    }

    fn file(&self, index: usize, seed: u32) -> PathBuf {
        self.folder.join("runs").join(format!("{}-{index}-{seed}.json", self.scene))
    }

    /// A run that an earlier call kept. What cannot be read, or is of another bench, is run again.
    fn kept(&self, index: usize, variant: &str, seed: u32) -> Option<Run> {
        let text = std::fs::read_to_string(self.file(index, seed)).ok()?;
        let kept: Kept = serde_json::from_str(&text).ok()?;
        let same = kept.fingerprint == self.fingerprint && kept.variant == variant;
        (same && self.folder.join(&kept.run.image).exists()).then_some(kept.run)
    }

    fn keep(&self, index: usize, variant: &str, run: &Run) -> Result<()> {
        let path = self.file(index, run.seed);
        let kept = Kept { fingerprint: self.fingerprint, variant: variant.to_owned(), run: run.clone() };
        let text = serde_json::to_string(&kept).map_err(|error| Error::write(&path, error))?;
        replace_by(&path, text.as_bytes())
    }

    /// The image at the end of a run.
    pub(super) fn image(&self, run: &Run) -> Result<Image> {
        crate::image::read_image(&self.folder.join(&run.image))
    }
}
