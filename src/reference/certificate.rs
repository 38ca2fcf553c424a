//! What is known of a reference: who made it, how large its own error is, and what an independent technique says of it.
//!
//! It travels in the header of the EXR file, so that `bench --reference` and `compare` know what they hold images against.

use serde::{Deserialize, Serialize};

use crate::statistics::Interval;

/// The name and version of the form.
pub const SCHEMA: &str = "lumbre-reference-1";

/// A witness that overlooks a larger relative difference than this, in half of the tiles of 16 x 16 pixels, confirms nothing.
const WEAK: f64 = 0.25;

/// What is known of a reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// [`SCHEMA`].
    pub schema: String,
    /// The scene's file.
    pub scene: String,
    /// Seconds that it may take, kernels and pilot included: what a longer one is told by.
    pub budget: f64,
    /// Seconds that it took.
    pub seconds: f64,
    /// Of these, what choosing the technique took.
    pub pilot_seconds: f64,
    /// The techniques that were tried, the chosen one first.
    pub pilots: Vec<Pilot>,
    /// What the image is the mean of.
    pub makers: Vec<Maker>,
    /// Its own error.
    pub error: OwnError,
    /// What an independent technique says; nothing where none could be asked.
    pub witness: Option<Witness>,
    /// Others that were asked as well, some of which may differ: then two of three agree.
    pub others: Vec<Witness>,
}

/// A technique that was tried for a moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pilot {
    /// The technique.
    pub technique: String,
    /// Seconds of rendering.
    pub seconds: f64,
    /// relMSE x seconds of its noise: one over its efficiency.
    pub noise: f64,
    /// relMSE of what more samples would not take away as quickly: blur, or light that it did not find and another one did.
    pub lacking: f64,
    /// What the scene has that the technique finds only with rare, bright samples, in words.
    pub by_chance: Option<String>,
}

/// A technique that made a part of the image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Maker {
    /// The technique.
    pub technique: String,
    /// Samples per pixel.
    pub spp: f64,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Its mean weight in the image.
    pub share: f64,
    /// What the scene has that the technique finds only with rare, bright samples, in words.
    pub by_chance: Option<String>,
}

/// The error of a reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OwnError {
    /// relMSE of its noise, from independent seeds, with a 95 % prediction interval.
    pub relmse: Interval,
    /// relMSE of the blur of a consistent technique, at most (95 %); 0 for unbiased ones.
    pub bias: f64,
    /// Share of the noise that a thousandth of the values of single seeds makes.
    pub largest_share: f64,
    /// Index of the tail of the noise (Hill 1975): below 2 the variance is infinite as far as can be told.
    pub tail_index: Option<f64>,
    /// Whether the noise is at least that, as few bright samples decide it: how many more are missing, nobody knows.
    pub at_least: bool,
}

/// An independent run of another technique, held against the reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Witness {
    /// The technique.
    pub technique: String,
    /// Samples per pixel.
    pub spp: f64,
    /// Seconds of rendering.
    pub seconds: f64,
    /// What it finds only with rare, bright samples, in words: then it cannot confirm that this light is right.
    pub by_chance: Option<String>,
    /// Tiles and channels in which it is darker beyond noise while it finds some of the light only with rare, bright samples: there it confirms nothing, and
    /// contradicts nothing.
    pub unseen: u64,
    /// Tests that were made: tiles of all sizes x channels.
    pub tests: u64,
    /// The relative difference of a tile of 16 x 16 pixels that it would have seen, for half of the tiles.
    pub detectable: f64,
    /// Where they differ beyond noise, the clearest first.
    pub differences: Vec<Difference>,
}

/// A tile where reference and witness differ beyond noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Left column.
    pub x: u32,
    /// Upper row.
    pub y: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The reference's mean there, of the channel that differs most.
    pub reference: f64,
    /// The witness's.
    pub witness: f64,
    /// Deviations that they are apart.
    pub deviations: f64,
    /// What kind of light it is likely to be, in words.
    pub likely: String,
}

impl Certificate {
    /// Why the reference is not confirmed, in one sentence; nothing where it is.
    pub fn doubt(&self) -> Option<String> {
        let Some(witness) = &self.witness else {
            return Some(String::from("no other technique can check it"));
        };
        let name = &witness.technique;
        let Some(first) = witness.differences.first() else {
            if let (Some(light), places @ 1..) = (&witness.by_chance, witness.unseen) {
                return Some(format!(
                    "{name} lacks light in {places} tiles, as it finds {light} only with rare, bright samples"
                ));
            }
            // One that aims at all light and agrees with the others is enough.
            let aimed = |found: &Witness| found.by_chance.is_none() && found.differences.is_empty();
            let aimed = aimed(witness)
                || self.makers.iter().any(|maker| maker.by_chance.is_none())
                || self.others.iter().any(aimed);
            if let (false, Some(light)) = (aimed, &witness.by_chance) {
                return Some(format!("nobody aimed at {light}"));
            }
            let overlooked = 100.0 * witness.detectable;
            return (witness.detectable > WEAK)
                .then(|| format!("{name} is so noisy that it overlooks {overlooked:.0} % in half of the tiles"));
        };
        let more = match witness.differences.len() {
            1 => String::new(),
            2 => String::from(" and another place"),
            n => format!(" and {} more places", n - 1),
        };
        Some(format!("{name} differs: {}{more}", first.describe()))
    }

    /// What made it, in words: `bdpt`, `bdpt and path`; `somebody else` where it was given.
    pub fn makers(&self) -> String {
        if self.makers.is_empty() {
            return String::from("somebody else");
        }
        crate::error::all_of(self.makers.iter().map(|maker| maker.technique.clone()))
    }

    /// Its own error in words: `relMSE 1.2e-4 (1.0e-4 to 1.5e-4)`, with `at least` where that is all that can be said.
    pub fn error_in_words(&self) -> String {
        let OwnError { relmse, bias, at_least, .. } = self.error;
        let blur = if bias > 0.0 { format!(", and blur of at most {bias:.1e}") } else { String::new() };
        if at_least {
            return format!("relMSE at least {:.1e}{blur}", relmse.low);
        }
        format!("relMSE {:.1e} ({:.1e} to {:.1e}){blur}", relmse.mean, relmse.low, relmse.high)
    }
}

impl Witness {
    /// What light it has not aimed at, in words, if there is any.
    pub fn nobody_aimed(&self) -> Option<String> {
        self.by_chance.as_ref().map(|light| format!("nobody has aimed at {light} yet"))
    }

    /// Why another technique is to be asked, in words; nothing where this one confirms the reference.
    pub fn reason_to_ask(&self) -> Option<String> {
        match (self.differences.first(), self.unseen) {
            (Some(first), _) => Some(format!("{} differs, {}", self.technique, first.describe())),
            (None, 0) => None,
            (None, places) => Some(format!(
                "{} lacks light in {places} tiles that it finds only with rare, bright samples",
                self.technique
            )),
        }
    }
}

impl OwnError {
    /// Whether the true error of the reference, as a relMSE, is one that this allows.
    pub fn covers(&self, truth: f64) -> bool {
        truth >= self.relmse.low && (self.at_least || truth <= self.relmse.high + self.bias)
    }
}

impl Difference {
    /// `tile (16, 32) of 16x16: 0.52 against 0.61 of the witness, 7.3 deviations (likely caustics)`.
    pub fn describe(&self) -> String {
        format!(
            "tile ({}, {}) of {}x{}: {:.4} against {:.4} of the witness, {:.1} deviations (likely {})",
            self.x, self.y, self.width, self.height, self.reference, self.witness, self.deviations, self.likely
        )
    }
}
