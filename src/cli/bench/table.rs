//! A bench on the terminal.

use lumbre::bench::against::{Comparison, Figure};
use lumbre::bench::results::{Results, SceneResults, VariantResults};
use lumbre::bench::stats::Interval;

use super::super::print;

pub(super) fn print_results(results: &Results) {
    print(&format!("device     {} ({})", results.device.name, results.device.driver));
    print(&format!("intervals  {:.0} %, over {} seeds", 100.0 * results.confidence, results.seeds));
    for scene in &results.scenes {
        print_scene(scene);
    }
}

fn print_scene(scene: &SceneResults) {
    print("");
    let quality = scene.reference.relmse.map_or(String::from("unknown noise"), |own| format!("relMSE {own:.1e}"));
    print(&format!(
        "{}, {}x{}, reference {} ({quality})",
        scene.name, scene.width, scene.height, scene.reference.origin
    ));
    let mut variants: Vec<&VariantResults> = scene.variants.iter().collect();
    variants.sort_by(|a, b| b.efficiency.mean.total_cmp(&a.efficiency.mean));
    let width = variants.iter().map(|variant| variant.name.len()).max().unwrap_or(0);
    print(&format!("{:width$}  1/(relMSE s)                relMSE    seconds      spp  Msamples/s  slope", "variant"));
    for variant in variants {
        let Some(last) = variant.last() else { continue };
        let flag = match (variant.floor.flagged, variant.bias.is_empty()) {
            (true, true) => format!("  biased, floor {:.1e}: unexpected", variant.floor.relmse),
            (true, false) => format!("  biased, floor {:.1e}: {}", variant.floor.relmse, variant.bias),
            (false, _) => String::new(),
        };
        print(&format!(
            "{:width$}  {:<26} {:.3e}  {:>7.3}  {:>8.0}  {:>10.3}  {:>5.2}{flag}",
            variant.name,
            interval(&variant.efficiency),
            last.relmse.mean,
            last.seconds.mean,
            last.spp,
            variant.samples_per_s.mean / 1e6,
            variant.slope.mean,
        ));
    }
    for pair in &scene.pairs {
        let verdict = if pair.significant { "" } else { ", no significant difference" };
        print(&format!("  {} against {}: {}{verdict}", pair.variant, pair.against, times(&pair.efficiency.ratio)));
    }
    let least =
        scene.variants.iter().filter_map(|variant| Some(variant.last()?.relmse.mean)).fold(f64::INFINITY, f64::min);
    if scene.reference.relmse.is_some_and(|own| own > 0.1 * least) {
        print(
            "  note: the reference's own noise is more than a tenth of the least error: --reference-spp makes a better one",
        );
    }
}

fn interval(value: &Interval) -> String {
    format!("{:.4} ({:.4} to {:.4})", Sig(value.mean), Sig(value.low), Sig(value.high))
}

fn times(value: &Interval) -> String {
    format!("x {:.3} ({:.3} to {:.3})", value.mean, value.low, value.high)
}

/// A number with about as many significant digits as the precision says.
struct Sig(f64);

impl std::fmt::Display for Sig {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = f.precision().unwrap_or(4) as i32;
        let magnitude = if self.0 == 0.0 { 0 } else { self.0.abs().log10().floor() as i32 };
        if !(-4..7).contains(&magnitude) {
            return write!(f, "{:.*e}", (digits - 1).max(0) as usize, self.0);
        }
        write!(f, "{:.*}", (digits - 1 - magnitude).max(0) as usize, self.0)
    }
}

pub(super) fn print_comparison(old: &Results, new: &Results, found: &Comparison) {
    print("");
    print(&format!("against the bench of {}", old.started));
    if old.device != new.device {
        print(&format!("  note: that ran on {} ({}), {}", old.device.name, old.device.driver, old.device.host));
    }
    for change in &found.changes {
        let (better, worse, name) = match change.figure {
            Figure::Speed => ("faster", "slower", "samples per second"),
            Figure::Error => ("better", "worse", "relMSE at equal samples"),
            Figure::Efficiency => ("better", "worse", "efficiency"),
        };
        let gained = if change.figure == Figure::Error { change.ratio.mean < 1.0 } else { change.ratio.mean > 1.0 };
        let verdict = match (change.significant, gained, change.regression) {
            (false, _, _) => "no significant change",
            (true, true, _) => better,
            (true, false, false) => worse,
            (true, false, true) => "REGRESSION",
        };
        print(&format!("  {}, {}: {name} {}: {verdict}", change.scene, change.variant, times(&change.ratio)));
    }
    for line in &found.unmatched {
        print(&format!("  {line}"));
    }
}
