//! Making a reference, and checking one that was given.

use std::path::Path;
use std::time::Instant;

use super::candidates::{Candidate, candidates, split};
use super::certificate::{Certificate, Maker, OwnError, Pilot, SCHEMA, Witness};
use super::parts::Parts;
use super::pilot::{TILE, Tried, judge};
use super::runner::Runner;
use super::series::Series;
use super::tails::{blur, own_error};
use super::tiles::{Tile, TileMean, TileMeans, difference_map};
use super::truth::Truth;
use super::witness::{Kinds, hold_against};
use crate::error::{Error, Result};
use crate::film::Image;
use crate::gpu::Gpu;
use crate::integrator::Solves;
use crate::metrics::intervals::Interval;
use crate::render::Settings;
use crate::scene::Scene;

/// Share of the time that trying each technique takes, kernels apart.
const PILOT: f64 = 0.025;
/// Of the time that is left then: what making takes at first, and what the witness does. The rest is for whatever they differ in, and
/// goes into making where they do not.
const MAKING: f64 = 0.5;
const CHECKING: f64 = 0.25;
/// Of the time for checking a given image, what the first witness has before another one is thought of.
const FIRST_LOOK: f64 = 0.6;
/// The share of the time that they have at least, should the kernels have taken all of it.
const LEAST_LEFT: f64 = 0.1;
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
/// Tiles of the map of differences, and the deviations that full colour stands for.
const MAP_TILE: u32 = 4;
const MAP_SCALE: f64 = 6.0;

/// How long it may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So many seconds in all.
    Seconds(f64),
    /// As long as so many samples per pixel of the first technique that can make it.
    Samples(f64),
}

/// A reference that is to be made or checked.
pub struct Request<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The scene.
    pub scene: &'a Scene,
    /// Size, backend and everything else but technique and seed.
    pub settings: &'a Settings,
    /// The light that it is to have.
    pub solves: Solves,
    /// How long it may take.
    pub budget: Budget,
    /// Which of several independent references it is, 0 to 63.
    pub seed: u32,
    /// Where what was rendered is kept, if it is to be, with a number for all that it depends on.
    pub parts: Option<(&'a Path, u64)>,
}

/// What is told while a reference is made.
pub enum Step<'a> {
    /// A technique is tried for a moment.
    Tries(&'a str),
    /// One makes the reference, for about so many seconds.
    Makes(&'a str, f64),
    /// One checks it.
    Checks(&'a str, f64),
    /// Another one is asked, since they differ; the text says where.
    Asks(&'a str, String),
    /// The share of the time that has passed, again and again.
    Share(f64),
}

type Hear<'a> = &'a mut dyn FnMut(Step) -> Result<()>;

/// Makes a reference: tries every technique that may, lets the best one run, and has another one check it.
///
/// # Errors
///
/// A scene that no technique can make a reference of on this device; whatever `hear` answers, which ends it.
pub fn make(request: &Request, hear: Hear) -> Result<Truth> {
    let mut work = Work::begin(request, hear, false)?;
    let main = MAKING * work.left().max(LEAST_LEFT * work.budget);
    let maker = work.best(main, &|_| true).ok_or_else(|| nobody(request))?;
    let name = work.name(maker);
    (work.hear)(Step::Makes(&name, main))?;
    work.run(maker, main)?;

    let Some(index) = work.first_witness(main, maker) else {
        return work.finish(Heard { maker, witness: None, others: Vec::new(), outvoted: None });
    };
    let seconds = CHECKING / (1.0 - MAKING) * work.left().max(LEAST_LEFT * work.budget);
    let name = work.name(index);
    (work.hear)(Step::Checks(&name, seconds))?;
    work.run(index, seconds)?;
    let found = work.held_against(maker, index);
    // Where they differ a third one says who is right, and where the witness may have missed light, what there is of it.
    let aimed = [maker, index].iter().any(|index| work.candidates[*index].by_chance.is_none());
    let third = match found.reason_to_ask().or_else(|| found.nobody_aimed().filter(|_| !aimed)) {
        Some(why) => work.another_witness(main, &[maker, index])?.map(|third| (third, why)),
        None => None,
    };
    let heard = match third {
        Some((third, why)) => work.ask(maker, (index, found), third, why)?,
        None => {
            work.run(maker, work.seconds(maker) + work.left())?;
            let witness = Some((index, work.held_against(maker, index)));
            Heard { maker, witness, others: Vec::new(), outvoted: None }
        }
    };
    work.finish(heard)
}

/// Has a reference that was given checked by the best technique that did not make it, and adds what came of it to what is known.
///
/// # Errors
///
/// As of [`make`].
pub fn check(request: &Request, given: &Truth, hear: Hear) -> Result<Truth> {
    let request = &Request { parts: None, ..*request };
    let mut work = Work::begin(request, hear, true)?;
    let (width, height) = (request.settings.width, request.settings.height);
    let own = |tile: Tile, channel: usize| TileMean::of_truth(given, tile, channel);
    let look = |work: &mut Work, index: usize, seconds: f64| -> Result<Witness> {
        let name = work.name(index);
        (work.hear)(Step::Checks(&name, seconds))?;
        work.run(index, seconds)?;
        let kinds = Kinds { of_reference: None, of_witness: work.candidates[index].by_chance.as_deref() };
        Ok(hold_against((width, height), &own, work.series(index), &name, kinds))
    };
    let all = work.left().max(LEAST_LEFT * work.budget);
    // Whoever made it is the last to be asked.
    let made = |index: &usize| {
        let makers = given.certificate.iter().flat_map(|certificate| &certificate.makers);
        makers.into_iter().any(|maker| maker.technique == work.name(*index))
    };
    let makers: Vec<usize> = (0..work.candidates.len()).filter(made).collect();
    let best = work.best_witness(all, &makers).or_else(|| work.best_witness(all, &[]));
    let mut index = best.ok_or_else(|| nobody(request))?;
    let mut witness = look(&mut work, index, FIRST_LOOK * all)?;
    let mut others = Vec::new();
    // One that finds some of the light by chance is not enough.
    let second = witness.nobody_aimed().filter(|_| witness.differences.is_empty());
    if second.is_some()
        && let Some(other) = work.another_witness(all, &[index])?
    {
        let seconds = work.left().max((1.0 - FIRST_LOOK) * all);
        let found = look(&mut work, other, seconds)?;
        others.push(std::mem::replace(&mut witness, found));
        index = other;
    } else {
        witness = look(&mut work, index, all)?;
    }
    let map = map_of((width, height), &own, work.series(index));
    let noise = given.relmse();
    let stated = noise.unwrap_or(0.0);
    let error = OwnError {
        relmse: Interval { mean: stated, low: stated, high: stated },
        bias: 0.0,
        largest_share: 0.0,
        tail_index: None,
        at_least: noise.is_none(),
    };
    let checked = work.certificate(Vec::new(), error, Some(witness), others);
    // What is known of how it was made stays.
    let certificate = match given.certificate.clone() {
        Some(known) => Certificate { witness: checked.witness, others: checked.others, ..known },
        None => checked,
    };
    Ok(given.clone().certified(certificate).with_difference_map(Some(map)))
}

/// Where a witness differs.
fn map_of((width, height): (u32, u32), own: &dyn Fn(Tile, usize) -> TileMean, witness: &Series) -> Image {
    let other = |tile: Tile, channel: usize| TileMean::of_series(witness, tile, channel);
    let own = TileMeans::of(width, height, MAP_TILE, own);
    difference_map(width, height, &own, &TileMeans::of(width, height, MAP_TILE, &other), MAP_SCALE)
}

fn nobody(request: &Request) -> Error {
    Error::Usage(format!(
        "no technique finds all light of {} on this device: give a reference with --reference",
        request.scene.source.display()
    ))
}

/// Who made a reference, and what the others say.
struct Heard {
    maker: usize,
    witness: Option<(usize, Witness)>,
    others: Vec<(usize, Witness)>,
    /// One that would have made it, and was contradicted by two others.
    outvoted: Option<usize>,
}

/// A reference under way.
struct Work<'a> {
    request: &'a Request<'a>,
    hear: Hear<'a>,
    candidates: Vec<Candidate>,
    /// Those that are tried only once the others contradict each other.
    held_back: Vec<Candidate>,
    /// What was rendered to try them.
    trials: Vec<(Candidate, Series, f64)>,
    parts: Parts,
    /// The technique that runs, by its index, whose kernels are there.
    runner: Option<(usize, Runner)>,
    budget: f64,
    /// Whether it checks an image that was made elsewhere, perhaps from the same seeds.
    checks: bool,
    started: Instant,
    kept: Instant,
}

impl<'a> Work<'a> {
    /// Takes up what was kept, or tries every technique.
    fn begin(request: &'a Request<'a>, hear: Hear<'a>, checks: bool) -> Result<Self> {
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
            work.try_all(all, budget)?;
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
    fn try_all(&mut self, candidates: Vec<Candidate>, budget: Option<f64>) -> Result<()> {
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
            if let (None, Budget::Samples(samples), []) = (budget, self.request.budget, self.trials.as_slice()) {
                self.budget = (samples * runner.seconds_per_sample).max(LEAST_BUDGET);
            }
            let seconds = (PILOT * self.budget).max(LEAST_PILOT);
            let mut series = runner.series(seconds, PILOT_IMAGES);
            let (hear, spent) = (&mut self.hear, self.parts.spent);
            let (started, budget) = (self.started, self.budget);
            runner.extend(&mut series, seconds, &mut |_| {
                hear(Step::Share(((spent + started.elapsed().as_secs_f64()) / budget).min(1.0)))
            })?;
            self.trials.push((candidate, series, runner.seconds_per_sample));
        }
        if let ([], Some(error)) = (self.trials.as_slice(), refused) {
            return Err(error);
        }
        self.parts.tried = judge(&self.trials);
        self.candidates = self.trials.iter().map(|(candidate, ..)| candidate.clone()).collect();
        Ok(())
    }

    fn spent(&self) -> f64 {
        self.parts.spent + self.started.elapsed().as_secs_f64()
    }

    fn left(&self) -> f64 {
        (self.budget - self.spent()).max(0.0)
    }

    fn name(&self, index: usize) -> String {
        self.candidates[index].technique.describe()
    }

    fn series(&self, index: usize) -> &Series {
        // It is asked for once it has run.
        self.parts.series(index).unwrap_or_else(|| unreachable!("{} has not run", self.name(index)))
    }

    fn seconds(&self, index: usize) -> f64 {
        self.parts.series(index).map_or(0.0, |series| series.seconds)
    }

    /// The technique that is expected to have the least error after so many seconds.
    fn best(&self, seconds: f64, may: &dyn Fn(usize) -> bool) -> Option<usize> {
        let error = |index: &usize| self.parts.tried[*index].expected(seconds.max(1e-3));
        (0..self.candidates.len()).filter(|index| may(*index)).min_by(|a, b| error(a).total_cmp(&error(b)))
    }

    /// The technique that is expected to see the smallest differences after so many seconds.
    fn best_witness(&self, seconds: f64, but: &[usize]) -> Option<usize> {
        let blindness = |index: &usize| {
            let tried = &self.parts.tried[*index];
            let chance = if tried.pilot.by_chance.is_some() { BY_CHANCE } else { 1.0 };
            let blur = if tried.is_consistent { BLURRED } else { 1.0 };
            chance * blur * tried.expected(seconds.max(1e-3))
        };
        let others = (0..self.candidates.len()).filter(|index| !but.contains(index));
        others.min_by(|a, b| blindness(a).total_cmp(&blindness(b)))
    }

    /// The same, of those that are not blurred where the maker is: what both have of the image then has less blur, and most of it none.
    fn first_witness(&self, seconds: f64, maker: usize) -> Option<usize> {
        let blurred = |index: &usize| self.candidates[*index].is_consistent;
        let mut excluded = vec![maker];
        if blurred(&maker) {
            excluded.extend((0..self.candidates.len()).filter(blurred));
        }
        self.best_witness(seconds, &excluded).or_else(|| self.best_witness(seconds, &[maker]))
    }

    /// The same, of those that aim at all light where none of `but` does; where all are spent, those that were held back are tried.
    fn another_witness(&mut self, seconds: f64, but: &[usize]) -> Result<Option<usize>> {
        if self.best_witness(seconds, but).is_none() && !self.held_back.is_empty() {
            let more = std::mem::take(&mut self.held_back);
            // The last one's memory first.
            self.runner = None;
            self.try_all(more, None)?;
        }
        let by_chance = |index: &usize| self.candidates[*index].by_chance.is_some();
        let mut excluded = but.to_vec();
        if but.iter().all(by_chance) {
            excluded.extend((0..self.candidates.len()).filter(by_chance));
        }
        Ok(self.best_witness(seconds, &excluded).or_else(|| self.best_witness(seconds, but)))
    }

    /// Has a technique render until its series took so many seconds.
    fn run(&mut self, index: usize, seconds: f64) -> Result<()> {
        let Request { gpu, scene, settings, parts, .. } = *self.request;
        if self.runner.as_ref().is_none_or(|(current, _)| *current != index) {
            // The other one's memory first.
            self.runner = None;
            let known = self.parts.tried[index].seconds_per_sample;
            let runner = Runner::new(gpu, scene, settings, &self.candidates[index], self.seeds(index), known)?;
            self.runner = Some((index, runner));
        }
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
            hear(Step::Share(((before + started.elapsed().as_secs_f64()) / budget).min(1.0)))
        });
        if done.is_err() && before + started.elapsed().as_secs_f64() > WORTH_KEEPING {
            keep(&series, all)?;
        }
        done?;
        all.put(index, series);
        Ok(())
    }

    /// Asks a third technique, and goes by the majority.
    fn ask(&mut self, maker: usize, (second, found): (usize, Witness), third: usize, why: String) -> Result<Heard> {
        let name = self.name(third);
        (self.hear)(Step::Asks(&name, why))?;
        self.run(third, self.left().max(self.seconds(second)))?;
        let of_maker = self.held_against(maker, third);
        if of_maker.reason_to_ask().is_none() {
            let (witness, other) = match found.reason_to_ask() {
                None => ((second, found), (third, of_maker)),
                Some(_) => ((third, of_maker), (second, found)),
            };
            return Ok(Heard { maker, witness: Some(witness), others: vec![other], outvoted: None });
        }
        // One that is blind where the others differ does not make a majority: it must contradict the maker as well.
        let both = !found.differences.is_empty() && !of_maker.differences.is_empty();
        if both && self.held_against(second, third).reason_to_ask().is_none() {
            // Two against one: the better of them goes on from what it has.
            let seconds = self.seconds(maker);
            let agreeing = self.best(seconds, &|index| index == second || index == third).unwrap_or(second);
            let other = if agreeing == second { third } else { second };
            let name = self.name(agreeing);
            (self.hear)(Step::Makes(&name, seconds))?;
            self.run(agreeing, seconds)?;
            let witness = Some((other, self.held_against(agreeing, other)));
            let others = vec![(maker, self.held_against(agreeing, maker))];
            return Ok(Heard { maker: agreeing, witness, others, outvoted: Some(maker) });
        }
        // Nobody agrees: the one that differs least is the witness.
        let (witness, other) = if of_maker.differences.len() < found.differences.len() {
            ((third, of_maker), (second, found))
        } else {
            ((second, found), (third, of_maker))
        };
        Ok(Heard { maker, witness: Some(witness), others: vec![other], outvoted: None })
    }

    fn held_against(&self, reference: usize, witness: usize) -> Witness {
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
    fn weights(&self, techniques: &[usize]) -> Vec<Vec<f32>> {
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
    fn mixed(&self, maker: usize, joining: &[usize]) -> (Vec<(usize, f64)>, Series) {
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

    fn finish(mut self, Heard { maker, witness, others, outvoted }: Heard) -> Result<Truth> {
        self.runner = None;
        let (width, height) = (self.request.settings.width, self.request.settings.height);
        let own = self.series(maker);
        let of_maker = |tile: Tile, channel: usize| TileMean::of_series(own, tile, channel);
        let map = witness.as_ref().map(|(index, _)| map_of((width, height), &of_maker, self.series(*index)));
        // Whoever does not differ may become a part of the image, unless that would blur it.
        let may_join = |(index, found): &&(usize, Witness)| {
            let series = self.series(*index);
            let blurs = series.is_blurred && !own.is_blurred;
            found.differences.is_empty()
                && !blurs
                && series.images.len() == own.images.len()
                && Some(*index) != outvoted
        };
        let joining: Vec<usize> = witness.iter().chain(&others).filter(may_join).map(|(index, _)| *index).collect();
        let aiming = joining.iter().copied().filter(|index| self.candidates[*index].by_chance.is_none());
        // With bright samples that a technique meets by chance, more of it can be worse than less.
        let sets = [Vec::new(), aiming.collect(), joining.clone()];
        let mut best: Option<(f64, Vec<(usize, f64)>, Series, OwnError)> = None;
        for set in sets {
            let (shares, mixed) = self.mixed(maker, &set);
            let mut error = own_error(&mixed);
            if mixed.is_blurred {
                error.bias = blur(&mixed, 2.0);
            }
            let all = error.relmse.mean + error.bias;
            if best.as_ref().is_none_or(|(least, ..)| all < *least) {
                best = Some((all, shares, mixed, error));
            }
        }
        let Some((_, shares, mixed, error)) = best else { return Err(nobody(self.request)) };
        let maker = |(index, share): &(usize, f64)| Maker {
            technique: self.name(*index),
            spp: self.series(*index).spp(),
            seconds: self.seconds(*index),
            share: *share,
            by_chance: self.candidates[*index].by_chance.clone(),
        };
        let makers = shares.iter().map(maker).collect();
        let image = mixed.mean();
        if image.pixels.iter().flatten().all(|value| *value == 0.0) {
            let scene = self.request.scene.source.display();
            return Err(Error::Usage(format!("the image of {scene} is black: nothing can be compared with it")));
        }
        let truth = Truth::new(image, Some(mixed.variance())).with_noise(mixed.noise());
        let certificate = {
            let found = |(_, found): (usize, Witness)| found;
            self.certificate(makers, error, witness.map(found), others.into_iter().map(found).collect())
        };
        Ok(truth.certified(certificate).with_difference_map(map))
    }

    fn certificate(
        &self,
        makers: Vec<Maker>,
        error: OwnError,
        witness: Option<Witness>,
        others: Vec<Witness>,
    ) -> Certificate {
        let mut pilots: Vec<&Tried> = self.parts.tried.iter().collect();
        pilots.sort_by(|a, b| a.expected(self.budget).total_cmp(&b.expected(self.budget)));
        let pilots: Vec<Pilot> = pilots.into_iter().map(|tried| tried.pilot.clone()).collect();
        Certificate {
            schema: SCHEMA.to_owned(),
            scene: self.request.scene.source.display().to_string(),
            budget: self.budget,
            seconds: self.spent(),
            pilot_seconds: self.parts.pilot_seconds,
            pilots,
            makers,
            error,
            witness,
            others,
        }
    }
}

impl Budget {
    fn seconds(self) -> Option<f64> {
        match self {
            Self::Seconds(seconds) => Some(seconds),
            Self::Samples(_) => None,
        }
    }
}
