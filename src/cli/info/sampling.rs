//! Light of a scene that a technique cannot sample.

use serde::Serialize;

use lumbre::error::{Result, all_of};
use lumbre::render::Technique;
use lumbre::scene::Scene;
use lumbre::techniques::{Solves, TECHNIQUES};

/// What a technique makes of the light of a scene.
#[derive(Serialize)]
pub(super) struct Sampling {
    technique: String,
    /// Light that it does not find, in words.
    misses: Option<String>,
    /// Light that it finds with rare, bright samples alone, in words.
    finds_rarely: Option<String>,
    /// The techniques that account for full light transport of which neither holds.
    others: Vec<&'static str>,
}

impl Sampling {
    /// Of a technique in a scene.
    pub fn of(scene: &Scene, technique: &Technique) -> Result<Self> {
        let mut others = Vec::new();
        for row in TECHNIQUES.iter().filter(|row| row.solves == Solves::Everything) {
            let other = Technique::parse(row.name)?;
            if other.misses(scene).is_none() && other.finds_rarely(scene).is_none() {
                others.push(row.name);
            }
        }
        let (misses, finds_rarely) = (technique.misses(scene), technique.finds_rarely(scene));
        Ok(Self { technique: technique.describe(), misses, finds_rarely, others })
    }

    /// What the user should know of it.
    pub fn warnings(&self) -> Vec<String> {
        let name = &self.technique;
        let others =
            if self.others.is_empty() { String::new() } else { format!("; sampled by {}", all_of(&self.others)) };
        let misses =
            self.misses.iter().map(|light| format!("{name} does not find {light}: the image lacks it{others}"));
        let rarely = self
            .finds_rarely
            .iter()
            .map(|light| format!("{name} finds {light} only with rare, bright samples{others}"));
        misses.chain(rarely).collect()
    }
}
