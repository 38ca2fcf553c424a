//! The table of all variants, per scene the most efficient first.

use super::chart::key;
use super::html::escape;
use super::number;
use crate::bench::results::{Pair, Results, SceneResults, Setup, VariantResults};
use crate::bench::stats::Interval;

/// Heads of the columns: title and unit.
const COLUMNS: [(&str, &str); 13] = [
    ("Variant", ""),
    ("Efficiency", "1/(relMSE·s)"),
    ("Ratio", "to the first"),
    ("relMSE", ""),
    ("Time", "s"),
    ("Samples", "per pixel"),
    ("Speed", "Msamples/s"),
    ("Rays", "Mrays/s"),
    ("Slope", ""),
    ("Bias floor", "relMSE"),
    ("Energy", "ratio"),
    ("Set-up", "s, apart"),
    ("Memory", "MiB, peak"),
];

/// The section with the table.
pub fn section(results: &Results) -> String {
    let heads: String = COLUMNS
        .iter()
        .map(|(title, unit)| {
            let unit = if unit.is_empty() { String::new() } else { format!("<br/><small>{unit}</small>") };
            format!("<th scope=\"col\" role=\"columnheader\">{title}{unit}</th>\n")
        })
        .collect();
    let bodies: String = results.scenes.iter().enumerate().map(|(index, scene)| body(index, scene)).collect();
    format!(
        "<section aria-labelledby=\"summary\">\n<h2 id=\"summary\">Summary</h2>\n\
         <div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"summary\">\n\
         <table class=\"summary\" role=\"table\">\n<thead role=\"rowgroup\">\n<tr role=\"row\">\n{heads}</tr>\n</thead>\n{bodies}\
         </table>\n</div>\n</section>\n"
    )
}

/// The variants of a scene with their numbers, the most efficient first.
pub fn by_efficiency(scene: &SceneResults) -> Vec<(usize, &VariantResults)> {
    let rank = |variant: &VariantResults| {
        if variant.efficiency.mean.is_nan() { f64::NEG_INFINITY } else { variant.efficiency.mean }
    };
    let mut sorted: Vec<_> = scene.variants.iter().enumerate().collect();
    sorted.sort_by(|(_, a), (_, b)| rank(b).total_cmp(&rank(a)));
    sorted
}

/// What a scene's figures come to, in one sentence of HTML.
pub fn verdict(scene: &SceneResults) -> String {
    let sorted = by_efficiency(scene);
    let Some((_, best)) = sorted.first().filter(|(_, best)| best.efficiency.mean > 0.0 && sorted.len() > 1) else {
        return String::new();
    };
    let caveat = if best.floor.flagged { ", but biased here" } else { "" };
    let name = format!("Most efficient: <strong>{}</strong>{caveat}", escape(&best.name));
    let doubt = |pair: &Pair| if pair.significant { "" } else { " (the difference is not significant)" };
    if let Some(pair) = pair_of(scene, &best.name) {
        let ratio = number::interval_line(&pair.efficiency.ratio);
        return format!("{name}; {ratio} times {}{}.", escape(&pair.against), doubt(pair));
    }
    let next = sorted.get(1).and_then(|(_, next)| pair_of(scene, &next.name)).filter(|pair| pair.against == best.name);
    match next {
        Some(pair) => {
            let ratio = number::interval_line(&pair.efficiency.ratio);
            format!("{name}; next comes {} with {ratio} of its efficiency{}.", escape(&pair.variant), doubt(pair))
        }
        None => format!("{name}."),
    }
}

/// How a variant compares with the scene's first one.
fn pair_of<'a>(scene: &'a SceneResults, name: &str) -> Option<&'a Pair> {
    scene.pairs.iter().find(|pair| pair.variant == name && pair.against != name)
}

fn body(index: usize, scene: &SceneResults) -> String {
    let sorted = by_efficiency(scene);
    let most =
        sorted.iter().map(|(_, variant)| variant.efficiency.mean).filter(|value| value.is_finite()).fold(0.0, f64::max);
    let rows: String = sorted.iter().map(|(number, variant)| row(scene, *number, variant, most)).collect();
    format!(
        "<tbody role=\"rowgroup\">\n<tr class=\"scene\" role=\"row\"><th scope=\"rowgroup\" role=\"rowheader\" colspan=\"{}\">\
         <div class=\"stick\"><a href=\"#scene-{index}\">{}</a> <span class=\"quiet\">{}</span></div></th></tr>\n{rows}</tbody>\n",
        COLUMNS.len(),
        escape(&scene.name),
        verdict(scene)
    )
}

fn row(scene: &SceneResults, number: usize, variant: &VariantResults, most: f64) -> String {
    let last = variant.last();
    let mebibytes = variant.device_bytes.map(|bytes| number::figure(bytes as f64 / 1_048_576.0));
    let efficiency = variant.efficiency.mean;
    let share = if most > 0.0 && efficiency.is_finite() { (efficiency / most).clamp(0.0, 1.0) } else { 1.0 };
    let of = |value: Option<&Interval>| value.map_or_else(|| String::from("–"), interval);
    let million = |value: &Interval| interval(&number::scaled(value, 1e-6));
    let efficiency = format!(
        "{}<span class=\"bar {}\" style=\"width: {:.0}%\"></span>",
        interval(&variant.efficiency),
        super::chart::style(number),
        100.0 * share
    );
    let cells = [
        efficiency,
        ratio(scene, variant),
        of(last.map(|point| &point.relmse)),
        of(last.map(|point| &point.seconds)),
        last.map_or_else(|| String::from("–"), |point| number::samples(point.spp)),
        million(&variant.samples_per_s) + &speed_ratio(scene, variant),
        variant.rays_per_s.as_ref().map_or_else(|| String::from("–"), million),
        fixed(&variant.slope, 2),
        floor(variant),
        fixed(&variant.energy_ratio, 4),
        set_up(&variant.setup),
        mebibytes.unwrap_or_else(|| String::from("–")),
    ];
    let cells: String = COLUMNS[1..]
        .iter()
        .zip(cells)
        .map(|((title, unit), cell)| {
            let label = [*title, *unit].join(" ");
            format!("<td role=\"cell\" data-label=\"{}\"><div>{cell}</div></td>\n", label.trim_end())
        })
        .collect();
    format!(
        "<tr role=\"row\"><th scope=\"row\" role=\"rowheader\"><div>{} {}</div></th>\n{cells}</tr>\n{}",
        key(number),
        escape(&variant.name),
        remarks(variant)
    )
}

/// An interval in a cell: the mean, and below it the ends.
fn interval(value: &Interval) -> String {
    in_cell(number::interval(value))
}

/// The same with a fixed number of decimals.
fn fixed(value: &Interval, decimals: i32) -> String {
    in_cell(number::interval_fixed(value, decimals))
}

fn in_cell((mean, ends): (String, Option<String>)) -> String {
    match ends {
        Some(ends) => format!("{mean} <small>{ends}</small>"),
        None => mean,
    }
}

fn set_up(Setup { load, build, compile }: &Setup) -> String {
    let parts = [("load", load), ("build", build), ("compile", compile)];
    let parts = parts.map(|(part, seconds)| format!("<small>{part} {}</small>", number::figure(*seconds)));
    format!("{} {}", number::figure(load + build + compile), parts.join(" "))
}

fn ratio(scene: &SceneResults, variant: &VariantResults) -> String {
    match pair_of(scene, &variant.name) {
        Some(pair) if pair.significant => {
            format!("{} <small class=\"mark sure\">significant</small>", interval(&pair.efficiency.ratio))
        }
        Some(pair) => format!("{} <small class=\"mark\">not significant</small>", interval(&pair.efficiency.ratio)),
        None if scene.variants.first().is_some_and(|first| first.name == variant.name) => {
            String::from("1 <small class=\"mark\">the first</small>")
        }
        None => String::from("–"),
    }
}

fn speed_ratio(scene: &SceneResults, variant: &VariantResults) -> String {
    match pair_of(scene, &variant.name) {
        Some(pair) => format!(" <small>{} × the first</small>", number::figure(pair.speed_ratio.mean)),
        None => String::new(),
    }
}

fn floor(variant: &VariantResults) -> String {
    let (value, deviation) = (number::figure(variant.floor.relmse), number::figure(variant.floor.deviation));
    let mark = match (variant.floor.flagged, variant.bias.is_empty()) {
        (true, false) => " <small class=\"mark warning\">biased</small>",
        (true, true) => " <small class=\"mark warning\">unexpected bias</small>",
        (false, _) => "",
    };
    format!("{value} <small>± {deviation}</small>{mark}")
}

/// What is to be said below a variant's figures, in a row of its own.
fn remarks(variant: &VariantResults) -> String {
    let mut remarks: Vec<String> = Vec::new();
    if variant.floor.flagged {
        remarks.push(if variant.bias.is_empty() {
            String::from(
                "Unexpected bias: the technique counts as unbiased, yet its runs differ from the reference by more than \
                 noise. Either of the two is wrong here.",
            )
        } else {
            format!("Biased: {}", variant.bias)
        });
    }
    let dropped: u64 = variant.runs.iter().map(|run| run.nonfinite).sum();
    if dropped > 0 {
        remarks.push(format!("{} samples were not finite and were dropped.", number::whole(dropped)));
    }
    remarks.extend(variant.notes.iter().cloned());
    if remarks.is_empty() {
        return String::new();
    }
    let items: String = remarks.iter().map(|remark| format!("<li>{}</li>", escape(remark))).collect();
    format!(
        "<tr class=\"remarks\" role=\"row\"><td role=\"cell\" colspan=\"{}\"><ul class=\"stick\">{items}</ul></td></tr>\n",
        COLUMNS.len()
    )
}
