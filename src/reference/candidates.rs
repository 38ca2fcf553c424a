//! Which techniques may make or check a reference of a scene.

use crate::render::{Settings, Technique};
use crate::scene::Scene;
use crate::techniques::{Bias, Missing, Solves, TECHNIQUES, TechniqueRow};

/// A technique that can make a reference.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The technique.
    pub technique: Technique,
    /// The longest path that it is to take, in segments.
    pub max_depth: Option<u32>,
    /// What it finds only by chance, in words.
    pub by_chance: Option<String>,
    /// Whether its image is blurred by less and less, rather than right in the mean.
    pub is_consistent: bool,
}

impl Candidate {
    fn new(technique: Technique, scene: &Scene, max_depth: Option<u32>) -> Self {
        let by_chance = technique.finds_rarely(scene);
        let is_consistent = technique.row.bias != Bias::Unbiased;
        Self { technique, max_depth, by_chance, is_consistent }
    }

    /// Whether it is unbiased and aims at all light that there is.
    pub fn aims_at_all(&self) -> bool {
        self.by_chance.is_none() && !self.is_consistent
    }
}

/// Every technique that accounts for `solves` in this scene and finds all of it.
///
/// Full transport of paths of at most two segments is direct light; in a scene whose materials are all diffuse it is what radiosity
/// solves. So techniques of full transport make those references too.
pub fn candidates(scene: &Scene, solves: Solves, settings: &Settings) -> Vec<Candidate> {
    let diffuse = scene.not_diffuse().is_empty();
    let depth = |row: &TechniqueRow| match (row.solves, solves) {
        (own, wanted) if own == wanted => Some(settings.max_depth),
        (Solves::Everything, Solves::Direct) => Some(Some(settings.max_depth.map_or(2, |depth| depth.min(2)))),
        (Solves::Everything, Solves::Diffuse) if diffuse => Some(settings.max_depth),
        _ => None,
    };
    let unbiased_exists = TECHNIQUES.iter().any(|row| row.referee && depth(row).is_some() && !is_biased(row));
    let mut found = Vec::new();
    for row in TECHNIQUES.iter().filter(|row| row.referee && !row.misses.contains(&Missing::DeltaLights)) {
        let Some(max_depth) = depth(row) else { continue };
        if is_biased(row) && unbiased_exists {
            continue;
        }
        let Ok(technique) = Technique::parse(row.name) else { continue };
        if technique.misses(scene).is_none() {
            found.push(Candidate::new(technique, scene, max_depth));
        }
    }
    // Where there is but one row, another form of it is better than nobody.
    if let [only] = found.as_slice()
        && let Ok(other) = Technique::parse(&format!("{}:branches=one", only.technique.row.name))
    {
        found.push(Candidate::new(other, scene, settings.max_depth));
    }
    found
}

/// Splits off those that are tried only once the others contradict each other: two that are unbiased and aim at all light need no third that
/// is blurred.
pub(super) fn split(all: Vec<Candidate>) -> (Vec<Candidate>, Vec<Candidate>) {
    let enough = all.iter().filter(|candidate| candidate.aims_at_all()).count() >= 2;
    all.into_iter().partition(|candidate| !(enough && candidate.is_consistent))
}

fn is_biased(row: &TechniqueRow) -> bool {
    matches!(row.bias, Bias::Biased(_))
}
