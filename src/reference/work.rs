//! A reference under way: techniques that are tried, chosen, run and held against each other.

use std::time::Instant;

use super::candidates::{Candidate, candidates, split};
use super::certificate::Witness;
use super::parts::Parts;
use super::pilot::{TILE, Tried, judge};
use super::request::{Budget, Hear, Request, Step};
use super::runner::Runner;
use super::series::Series;
use super::tiles::{Tile, TileMean};
use super::witness::{Kinds, hold_against};
use crate::error::{Error, Result};

/// Share of the time that trying each technique takes, kernels apart.
const PILOT: f64 = 0.025;
/// The least seconds that a technique is tried for.
const LEAST_PILOT: f64 = 0.05;
/// The least seconds of a reference whose time nobody says.
const LEAST_BUDGET: f64 = 1.0;
/// Independent images of a pilot, and of a long run at most.
const PILOT_IMAGES: usize = 4;
const IMAGES: usize = 16;
/// Pixels of all independent images of a run together, unless that leaves fewer than [`LEAST_IMAGES`].
const MOST_PIXELS: usize = 1 << 26;
const LEAST_IMAGES: usize = 6;
/// Seconds between two times that what was rendered is kept.
const KEPT_EVERY: f64 = 20.0;
/// Seconds of work from which on an interrupted reference is kept.
const WORTH_KEEPING: f64 = 3.0;
/// By how much more error a technique counts that finds some of the light only by chance, as it cannot say where the reference is too
/// bright; and one whose blur has to be allowed for.
const BY_CHANCE: f64 = 2.0;
const BLURRED: f64 = 3.0;

/// A reference under way.
pub(super) struct Work<'a> {
    pub request: &'a Request<'a>,
    pub hear: Hear<'a>,
    pub candidates: Vec<Candidate>,
    /// Those that are tried only once the others contradict each other.
    held_back: Vec<Candidate>,
    /// What was rendered to try them.
    trials: Vec<(Candidate, Series, f64)>,
    pub parts: Parts,
    /// The technique that runs, by its index, whose kernels are there.
    pub runner: Option<(usize, Runner)>,
    pub budget: f64,
    /// Whether it checks an image that was made elsewhere, perhaps from the same seeds.
    checks: bool,
    started: Instant,
    kept: Instant,
}

impl<'a> Work<'a> {
    /// Takes up what was kept, or tries every technique.
    pub fn begin(request: &'a Request<'a>, hear: Hear<'a>, checks: bool) -> Result<Self> {
        let (all, held_back) = split(candidates(request.scene, request.solves, request.settings));
        let parts = request.parts.and_then(|(path, key)| Parts::read(path, key));
        let (budget, now) = (Budget::seconds(request.budget), Instant::now());
        let mut work = Self {
            request,
            hear,
            candidates: Vec::new(),
            held_back,
            trials: Vec::new(),
            parts: parts.unwrap_or_default(),
            runner: None,
            budget: budget.unwrap_or(LEAST_BUDGET),
            checks,
            started: now,
            kept: now,
        };
        if work.parts.tried.is_empty() {
            work.try_all(all)?;
            work.parts.pilot_seconds = work.spent();
        } else {
            if budget.is_none() {
                work.budget = work.parts.budget;
            }
            // What the device cannot run was dropped when they were tried, and what was held back may have been.
            let both: Vec<Candidate> = all.into_iter().chain(std::mem::take(&mut work.held_back)).collect();
            let by_name = |tried: &Tried| {
                both.iter().find(|candidate| candidate.technique.describe() == tried.pilot.technique).cloned()
            };
            work.candidates = work.parts.tried.iter().filter_map(by_name).collect();
        }
        Ok(work)
    }

    /// Seeds of a technique's renderings: no two have one in common, and no bench has them.
    fn seeds(&self, slot: usize) -> u32 {
        1 << 31 | u32::from(self.checks) << 30 | (self.request.seed & 0x3f) << 24 | ((slot as u32) & 0xf) << 20
    }

    /// Has each of these render for a moment, and judges all that were tried.
    fn try_all(&mut self, candidates: Vec<Candidate>) -> Result<()> {
        let Request { gpu, scene, settings, .. } = *self.request;
        let mut refused = None;
        for candidate in candidates {
            (self.hear)(Step::Tries(&candidate.technique.describe()))?;
            let seeds = self.seeds(self.trials.len() + 8);
            let mut runner = match Runner::new(gpu, scene, settings, &candidate, seeds, 0.0) {
                Ok(runner) => runner,
                // What the device has no room or no feature for makes no reference.
                Err(error @ (Error::OutOfMemory { .. } | Error::Usage(_))) => {
                    refused = Some(error);
                    continue;
                }
                Err(error) => return Err(error),
            };
            runner.calibrate(0.2 * (PILOT * self.budget).max(LEAST_PILOT))?;
            if let (Budget::Samples(samples), []) = (self.request.budget, self.trials.as_slice()) {
                self.budget = (samples * runner.seconds_per_sample).max(LEAST_BUDGET);
            }
            let seconds = (PILOT * self.budget).max(LEAST_PILOT);
            let mut series = runner.series(seconds, PILOT_IMAGES);
            let share = self.share();
            let hear = &mut self.hear;
            runner.extend(&mut series, seconds, &mut |_| hear(Step::Share(share())))?;
            self.trials.push((candidate, series, runner.seconds_per_sample));
        }
        if let ([], Some(error)) = (self.trials.as_slice(), refused) {
            return Err(error);
        }
        self.parts.tried = judge(&self.trials);
        self.candidates = self.trials.iter().map(|(candidate, ..)| candidate.clone()).collect();
        Ok(())
    }

    /// The share of the time that has passed, whenever it is asked for.
    fn share(&self) -> impl Fn() -> f64 + use<> {
        let (before, started, budget) = (self.parts.spent, self.started, self.budget);
        move || ((before + started.elapsed().as_secs_f64()) / budget).min(1.0)
    }

    pub fn spent(&self) -> f64 {
        self.parts.spent + self.started.elapsed().as_secs_f64()
    }

    pub fn left(&self) -> f64 {
        (self.budget - self.spent()).max(0.0)
    }

    pub fn name(&self, index: usize) -> String {
        self.candidates[index].technique.describe()
    }

    pub fn series(&self, index: usize) -> &Series {
        // It is asked for once it has run.
        self.parts.series(index).unwrap_or_else(|| unreachable!("{} has not run", self.name(index)))
    }

    pub fn seconds(&self, index: usize) -> f64 {
        self.parts.series(index).map_or(0.0, |series| series.seconds)
    }

    /// The technique that is expected to have the least error after so many seconds.
    pub fn best(&self, seconds: f64, may: &dyn Fn(usize) -> bool) -> Option<usize> {
        let error = |index: &usize| self.parts.tried[*index].expected(seconds.max(1e-3));
        (0..self.candidates.len()).filter(|index| may(*index)).min_by(|a, b| error(a).total_cmp(&error(b)))
    }

    /// The technique that is expected to see the smallest differences after so many seconds.
    pub fn best_witness(&self, seconds: f64, but: &[usize]) -> Option<usize> {
        let blindness = |index: &usize| {
            let tried = &self.parts.tried[*index];
            let chance = if tried.pilot.by_chance.is_some() { BY_CHANCE } else { 1.0 };
            let blur = if tried.is_consistent { BLURRED } else { 1.0 };
            chance * blur * tried.expected(seconds.max(1e-3))
        };
        let others = (0..self.candidates.len()).filter(|index| !but.contains(index));
        others.min_by(|a, b| blindness(a).total_cmp(&blindness(b)))
    }

    /// The best witness of what `maker` makes after so many seconds, one that is not blurred where the maker is: what both have of the image then has less blur, and most of it none.
    pub fn first_witness(&self, seconds: f64, maker: usize) -> Option<usize> {
        let blurred = |index: &usize| self.candidates[*index].is_consistent;
        let mut excluded = vec![maker];
        if blurred(&maker) {
            excluded.extend((0..self.candidates.len()).filter(blurred));
        }
        self.best_witness(seconds, &excluded).or_else(|| self.best_witness(seconds, &[maker]))
    }

    /// The best witness besides `but` after so many seconds; where all are spent, those that were held back are tried.
    pub fn another_witness(&mut self, seconds: f64, but: &[usize]) -> Result<Option<usize>> {
        if self.best_witness(seconds, but).is_none() && !self.held_back.is_empty() {
            let more = std::mem::take(&mut self.held_back);
            // The last one's memory first.
            self.runner = None;
            self.try_all(more)?;
        }
        let by_chance = |index: &usize| self.candidates[*index].by_chance.is_some();
        let mut excluded = but.to_vec();
        if but.iter().all(by_chance) {
            excluded.extend((0..self.candidates.len()).filter(by_chance));
        }
        Ok(self.best_witness(seconds, &excluded).or_else(|| self.best_witness(seconds, but)))
    }

    /// Has a technique render until its series took so many seconds.
    pub fn run(&mut self, index: usize, seconds: f64) -> Result<()> {
        let Request { gpu, scene, settings, parts, .. } = *self.request;
        if self.runner.as_ref().is_none_or(|(current, _)| *current != index) {
            // The other one's memory first.
            self.runner = None;
            let known = self.parts.tried[index].seconds_per_sample;
            let runner = Runner::new(gpu, scene, settings, &self.candidates[index], self.seeds(index), known)?;
            self.runner = Some((index, runner));
        }
        let share = self.share();
        let Some((_, runner)) = &mut self.runner else { return Ok(()) };
        let pixels = (settings.width as usize * settings.height as usize).max(1);
        let most = (MOST_PIXELS / pixels).clamp(LEAST_IMAGES, IMAGES);
        let mut series = self.parts.series(index).cloned().unwrap_or_else(|| runner.series(seconds, most));
        let (hear, kept, started, budget) = (&mut self.hear, &mut self.kept, self.started, self.budget);
        let all = &mut self.parts;
        let before = all.spent;
        let keep = |series: &Series, all: &mut Parts| -> Result<()> {
            let Some((path, key)) = parts else { return Ok(()) };
            all.put(index, series.clone());
            (all.spent, all.budget) = (before + started.elapsed().as_secs_f64(), budget);
            let written = all.write(path, key);
            all.spent = before;
            written
        };
        let done = runner.extend(&mut series, seconds, &mut |series| {
            if kept.elapsed().as_secs_f64() > KEPT_EVERY {
                // That it cannot be kept is no reason to stop.
                let _ = keep(series, all);
                *kept = Instant::now();
            }
            hear(Step::Share(share()))
        });
        if done.is_err() && before + started.elapsed().as_secs_f64() > WORTH_KEEPING {
            keep(&series, all)?;
        }
        done?;
        all.put(index, series);
        Ok(())
    }

    pub fn held_against(&self, reference: usize, witness: usize) -> Witness {
        let (own, other) = (self.series(reference), self.series(witness));
        let settings = self.request.settings;
        let kinds = Kinds {
            of_reference: self.candidates[reference].by_chance.as_deref(),
            of_witness: self.candidates[witness].by_chance.as_deref(),
        };
        let own = |tile: Tile, channel: usize| TileMean::of_series(own, tile, channel);
        hold_against((settings.width, settings.height), &own, other, &self.name(witness), kinds)
    }

    /// The weights of some techniques in each pixel, by the errors that the pilot lets expect of them after the seconds that they had: these
    /// do not depend on the values that they weigh.
    pub fn weights(&self, techniques: &[usize]) -> Vec<Vec<f32>> {
        let (width, height) = (self.request.settings.width, self.request.settings.height);
        let mut weights = vec![vec![0.0; (width * height) as usize]; techniques.len()];
        for (number, tile) in Tile::all(width, height, TILE).enumerate() {
            let precision = |index: &usize| {
                1.0 / self.parts.tried[*index].expected_in(number, self.seconds(*index)).max(f64::MIN_POSITIVE)
            };
            let precisions: Vec<f64> = techniques.iter().map(precision).collect();
            let sum: f64 = precisions.iter().sum();
            for (own, precision) in weights.iter_mut().zip(&precisions) {
                tile.pixels(width).for_each(|pixel| own[pixel] = (precision / sum) as f32);
            }
        }
        weights
    }

    /// The mean of a technique and of those that join it, with their shares.
    pub fn mixed(&self, maker: usize, joining: &[usize]) -> (Vec<(usize, f64)>, Series) {
        let techniques: Vec<usize> = std::iter::once(maker).chain(joining.iter().copied()).collect();
        let weights = self.weights(&techniques);
        let mean = |weights: &Vec<f32>| {
            weights.iter().map(|weight| f64::from(*weight)).sum::<f64>() / weights.len().max(1) as f64
        };
        let shares = techniques.iter().copied().zip(weights.iter().map(mean)).collect();
        if joining.is_empty() {
            return (shares, self.series(maker).clone());
        }
        let parts: Vec<(&Series, Vec<f32>)> = techniques.iter().map(|index| self.series(*index)).zip(weights).collect();
        (shares, Series::mixed(&parts))
    }
}
