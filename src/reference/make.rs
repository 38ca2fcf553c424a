//! Making a reference, and checking one that was given.

use super::certificate::{Certificate, Maker, OwnError, Pilot, SCHEMA, Witness};
use super::pilot::Tried;
use super::request::{Hear, Request, Step};
use super::series::Series;
use super::tails::{blur, own_error};
use super::tiles::{Tile, TileMean, TileMeans, difference_map};
use super::truth::Truth;
use super::witness::{Kinds, hold_against};
use super::work::Work;
use crate::error::{Error, Result};
use crate::image::Image;
use crate::statistics::Interval;

/// Of the time that trying the techniques has left: what making takes at first, and what the witness does. The rest is for whatever they differ in, and
/// goes into making where they do not.
const MAKING: f64 = 0.5;
const CHECKING: f64 = 0.25;
/// Of the time for checking a given image, what the first witness has before another one is thought of.
const FIRST_LOOK: f64 = 0.6;
/// The share of the time that they have at least, should the kernels have taken all of it.
const LEAST_LEFT: f64 = 0.1;
/// Tiles of the map of differences, and the deviations that full colour stands for.
const MAP_TILE: u32 = 4;
const MAP_SCALE: f64 = 6.0;

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

impl Work<'_> {
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
        let of = |set: &[usize]| {
            let (shares, mixed) = self.mixed(maker, set);
            let mut error = own_error(&mixed);
            if mixed.is_blurred {
                error.bias = blur(&mixed, 2.0);
            }
            (shares, mixed, error)
        };
        let (with_those_that_aim, with_all) = (of(&aiming.collect::<Vec<usize>>()), of(&joining));
        let all = |error: &OwnError| error.relmse.mean + error.bias;
        let is_better = all(&with_all.2) < all(&with_those_that_aim.2);
        let (shares, mixed, error) = if is_better { with_all } else { with_those_that_aim };
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
