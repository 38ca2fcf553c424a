//! A bench on the terminal.

use lumbre::bench::against::{Comparison, Figure};
use lumbre::bench::results::{self as bench, Reference, Results, SceneResults, VariantResults};
use lumbre::statistics::Interval;

use super::super::output::print;

pub(in super::super) fn print_results(results: &Results) {
    print(&format!("device     {} ({})", results.device.name, results.device.driver));
    print(&format!("intervals  {:.0} %, over {} seeds", 100.0 * results.confidence, results.seeds));
    for scene in &results.scenes {
        print_scene(scene);
    }
}

fn print_scene(scene: &SceneResults) {
    print("");
    print(&format!("{}, {}x{}", scene.name, scene.width, scene.height));
    for line in describe_reference(&scene.reference) {
        print(&line);
    }
    let figure = scene.ordered_by();
    let variants = scene.by_efficiency();
    let width = variants.iter().map(|(_, variant)| variant.name.len()).max().unwrap_or(0);
    let efficiency = match figure {
        bench::Figure::Relmse => "1/(relMSE s)",
        _ => "1/(relMSE of parts s)",
    };
    print(&format!("{:width$}  {efficiency:<26} relMSE    seconds      spp  Msamples/s  slope", "variant"));
    for (_, variant) in variants {
        let Some(last) = variant.last() else { continue };
        print(&format!(
            "{:width$}  {:<26} {:.3e}  {:>7.3}  {:>8.0}  {:>10.3}  {:>5.2}{}",
            variant.name,
            interval(variant.efficiency_by(figure)),
            last.relmse.mean,
            last.seconds.mean,
            last.spp,
            variant.samples_per_s.mean / 1e6,
            variant.slope.mean,
            flags(variant),
        ));
    }
    for pair in &scene.pairs {
        let by = match pair.decided_by {
            bench::Figure::Relmse => String::new(),
            figure => format!(" by {}", figure.in_words()),
        };
        let verdict = match (pair.significant, pair.tested_by == pair.decided_by) {
            (true, true) => String::new(),
            (true, false) => {
                let tested = times(&pair.by(pair.tested_by).ratio);
                format!(", significant by {} ({tested})", pair.tested_by.in_words())
            }
            (false, _) => String::from(", no significant difference"),
        };
        let doubt = if scene.reference.doubt.is_some() { " (reference not confirmed)" } else { "" };
        print(&format!("  {} against {}: {}{by}{verdict}{doubt}", pair.variant, pair.against, times(pair.decisive())));
    }
    if scene.reference_share().is_some() {
        print(
            "  note: the reference's own error is more than a tenth of the least error: --reference-time makes a better one",
        );
    }
}

/// What made the reference and how large its own error is, what its witness says, and whether to trust it.
fn describe_reference(reference: &Reference) -> Vec<String> {
    let mut made = format!("  reference {}", reference.origin);
    if let Some(technique) = &reference.technique {
        made += &format!(" by {technique}");
    }
    if let Some(spp) = reference.spp {
        made += &format!(", {spp} spp");
    }
    made += &match (&reference.certificate, reference.relmse) {
        (Some(certificate), _) => format!(", own error {}", certificate.error_in_words()),
        (None, Some(own)) => format!(", own error relMSE {own:.1e}"),
        (None, None) => String::from(", own error unknown"),
    };
    let witness = reference.certificate.as_ref().and_then(|certificate| certificate.witness.as_ref());
    let checked = match (witness, &reference.doubt) {
        (_, Some(doubt)) => format!("  WARNING: reference not confirmed: {doubt}"),
        (Some(witness), None) => format!(
            "  confirmed by {}, {:.0} spp, which shows {:.2} % in half of the tiles of 16x16",
            witness.technique,
            witness.spp,
            100.0 * witness.detectable
        ),
        (None, None) => String::from("  confirmed"),
    };
    vec![made, checked]
}

/// What is to be known before a variant's figures are used.
fn flags(variant: &VariantResults) -> String {
    let slope = match variant.slope_of {
        bench::Figure::Relmse => String::new(),
        figure => format!(", slope of the {}", figure.name()),
    };
    let heavy = if variant.is_heavy() {
        format!("  few pixels decide: a thousandth makes {:.0} % of the relMSE{slope}", 100.0 * variant.worst_share)
    } else {
        String::new()
    };
    let biased = match (variant.floor.flagged, variant.bias.is_empty()) {
        (true, true) => format!("  biased, floor {:.1e}: unexpected", variant.floor.relmse),
        (true, false) => format!("  biased, floor {:.1e}: {}", variant.floor.relmse, variant.bias),
        (false, _) => String::new(),
    };
    heavy + &biased
}

fn interval(value: &Interval) -> String {
    format!("{:.4} ({:.4} to {:.4})", Sig(value.mean), Sig(value.low), Sig(value.high))
}

fn times(value: &Interval) -> String {
    format!("x {:.3} ({:.3} to {:.3})", Sig(value.mean), Sig(value.low), Sig(value.high))
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
