//! Two benches of the same scenes: what got faster or slower, better or worse, beyond noise.

use serde::Serialize;

use super::results::{Point, Results, Run, VariantResults};
use crate::statistics::{CONFIDENCE, Interval, SIGNIFICANCE};

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Figure {
    /// Samples per second of rendering: more is better.
    Speed,
    /// relMSE at the most samples that both were looked at: less is better.
    Error,
    /// 1 / (relMSE x seconds) at the end: more is better.
    Efficiency,
}

/// One figure of one variant, new over old.
#[derive(Clone, Debug, Serialize)]
pub struct Change {
    /// The scene.
    pub scene: String,
    /// The variant.
    pub variant: String,
    /// What was compared.
    pub figure: Figure,
    /// New over old, with its interval.
    pub ratio: Interval,
    /// Whether they differ at the 1 % level of Welch's test of their logarithms.
    pub significant: bool,
    /// Whether it is worse by more than the threshold, significantly.
    pub regression: bool,
}

/// What two benches have in common, and what they do not.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Comparison {
    /// Figures of what both have.
    pub changes: Vec<Change>,
    /// Scenes and variants that only one has, in words.
    pub unmatched: Vec<String>,
}

impl Comparison {
    /// Whether anything got worse by more than the threshold.
    pub fn has_regression(&self) -> bool {
        self.changes.iter().any(|change| change.regression)
    }
}

/// Compares two benches; `threshold` is the share by which a figure must be worse to count as a regression, 0.05 for 5 %.
pub fn compare(old: &Results, new: &Results, threshold: f64) -> Comparison {
    let mut found = Comparison::default();
    for scene in &new.scenes {
        let Some(before) = old.scenes.iter().find(|other| other.name == scene.name) else {
            found.unmatched.push(format!("{}: not in the old bench", scene.name));
            continue;
        };
        if (before.width, before.height) != (scene.width, scene.height) {
            found.unmatched.push(format!("{}: the image's size differs", scene.name));
            continue;
        }
        for variant in &scene.variants {
            let Some(other) = before.variants.iter().find(|other| other.name == variant.name) else {
                found.unmatched.push(format!("{}, {}: not in the old bench", scene.name, variant.name));
                continue;
            };
            found.changes.extend(changes(&scene.name, other, variant, threshold));
        }
        let gone = before.variants.iter().filter(|other| !scene.variants.iter().any(|v| v.name == other.name));
        found.unmatched.extend(gone.map(|other| format!("{}, {}: not in the new bench", scene.name, other.name)));
    }
    let gone = old.scenes.iter().filter(|other| !new.scenes.iter().any(|scene| scene.name == other.name));
    found.unmatched.extend(gone.map(|other| format!("{}: not in the new bench", other.name)));
    found
}

fn changes(scene: &str, old: &VariantResults, new: &VariantResults, threshold: f64) -> Vec<Change> {
    let ends = |variant: &VariantResults, value: &dyn Fn(&Point) -> f64| -> Vec<f64> {
        variant.runs.iter().filter_map(|run| run.points.last()).map(value).collect()
    };
    let speed = |point: &Point| point.per_second(point.spp as f64);
    let mut all = vec![
        (Figure::Speed, ends(old, &speed), ends(new, &speed)),
        (Figure::Efficiency, ends(old, &Point::efficiency), ends(new, &Point::efficiency)),
    ];
    if let Some(spp) = most_common_spp(old, new) {
        let errors = |variant: &VariantResults| -> Vec<f64> {
            let at = |run: &Run| run.points.iter().find(|point| point.spp == spp).map(|point| point.relmse);
            variant.runs.iter().filter_map(at).collect()
        };
        all.insert(1, (Figure::Error, errors(old), errors(new)));
    }
    all.into_iter()
        .map(|(figure, before, after)| {
            let strict = Interval::ratio(&before, &after, 1.0 - SIGNIFICANCE);
            let ratio = Interval::ratio(&before, &after, CONFIDENCE);
            let significant = before.len() > 1 && after.len() > 1 && !strict.contains(1.0);
            let worse = if figure == Figure::Error { ratio.mean } else { 1.0 / ratio.mean };
            let regression = significant && worse > 1.0 + threshold;
            Change { scene: scene.to_owned(), variant: new.name.clone(), figure, ratio, significant, regression }
        })
        .collect()
}

/// The largest number of samples at which every run of both was looked at.
fn most_common_spp(a: &VariantResults, b: &VariantResults) -> Option<u64> {
    let mut runs = a.runs.iter().chain(&b.runs);
    let first: Vec<u64> = runs.next()?.points.iter().map(|point| point.spp).collect();
    let rest: Vec<&Run> = runs.collect();
    first.into_iter().rev().find(|spp| rest.iter().all(|run| run.points.iter().any(|point| point.spp == *spp)))
}
