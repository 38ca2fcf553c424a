//! The tables of all variants, per scene the most efficient first: what they come to, the error by three figures, and what else was measured.

use super::chart::key;
use super::html::escape;
use super::number;
use crate::bench::results::{CurvePoint, Figure, Pair, Results, SceneResults, Setup, VariantResults};
use crate::statistics::Interval;

/// Stands before what the reader must not miss. The second character asks for letters, not for a coloured picture.
pub const WARNING: &str = "\u{26a0}\u{fe0e}";

/// A column: its title and its unit.
type Column = (&'static str, &'static str);

/// A table of all variants of all scenes.
struct Table {
    /// Its heads, but for the variant's name.
    columns: &'static [Column],
    /// The cells of a variant below them, as HTML.
    cells: fn(&SceneResults, usize, &VariantResults) -> Vec<String>,
    /// What stands beside a scene's name, as HTML.
    beside: fn(&SceneResults) -> String,
    /// What is to be said below a variant's figures.
    remarks: fn(&VariantResults) -> Vec<String>,
}

const OVERVIEW: Table = Table {
    columns: &[
        ("Efficiency", "1/(relMSE·s)"),
        ("Ratio", "to the first"),
        ("relMSE", ""),
        ("Time", "s"),
        ("Samples", "per pixel"),
        ("Slope", ""),
        ("Flags", ""),
    ],
    cells: overview,
    beside: verdict,
    remarks,
};

const BY_FIGURE: Table = Table {
    columns: &[
        ("relMSE", "and ratio"),
        ("Of parts", "relMSE and ratio"),
        ("Trimmed", "relMSE and ratio"),
        ("Median", "of pixels, and ratio"),
        ("Worst pixels", "share of relMSE"),
    ],
    cells: by_figure,
    beside: doubted,
    remarks: |_| Vec::new(),
};

const REST: Table = Table {
    columns: &[
        ("Speed", "Msamples/s"),
        ("Rays", "Mrays/s"),
        ("Bias floor", "relMSE"),
        ("Energy", "ratio"),
        ("Set-up", "s, apart"),
        ("Memory", "MiB, peak"),
    ],
    cells: rest,
    beside: |_| String::new(),
    remarks: |_| Vec::new(),
};

/// The section with the tables.
pub fn section(results: &Results) -> String {
    let details = |title: &str, explain: &str, table: &Table| {
        format!(
            "<details open=\"open\">\n<summary>{title}</summary>\n<p class=\"quiet\">{explain}</p>\n{}</details>\n",
            table.html(results, title)
        )
    };
    let by_figure = details(
        "Error that few pixels do not decide",
        "A few bright samples can make most of a relMSE. That of parts is the median of the means of eight parts of the image: it counts bright \
         samples where most parts have some. The trimmed one leaves out the worst thousandth of the pixels, and the median does not see \
         bright pixels at all. Ratios are those of efficiencies to the scene's first variant; “decides” marks the one that \
         the verdict goes by.",
        &BY_FIGURE,
    );
    let rest = details("Speed, bias and memory", "Of whole runs; set-up is not in the time of rendering.", &REST);
    format!(
        "<section aria-labelledby=\"summary\">\n<h2 id=\"summary\">Summary</h2>\n{}{by_figure}{rest}</section>\n",
        OVERVIEW.html(results, "Summary")
    )
}

impl Table {
    fn html(&self, results: &Results, label: &str) -> String {
        let heads: String = [("Variant", "")]
            .iter()
            .chain(self.columns)
            .map(|(title, unit)| {
                let unit = if unit.is_empty() { String::new() } else { format!("<br/><small>{unit}</small>") };
                format!("<th scope=\"col\" role=\"columnheader\">{title}{unit}</th>\n")
            })
            .collect();
        let bodies: String = results.scenes.iter().enumerate().map(|(index, scene)| self.body(index, scene)).collect();
        format!(
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">\n<table class=\"summary\" role=\"table\">\n\
             <thead role=\"rowgroup\">\n<tr role=\"row\">\n{heads}</tr>\n</thead>\n{bodies}</table>\n</div>\n",
            escape(label)
        )
    }

    fn body(&self, index: usize, scene: &SceneResults) -> String {
        let rows: String =
            scene.by_efficiency().iter().map(|(number, variant)| self.row(scene, *number, variant)).collect();
        format!(
            "<tbody role=\"rowgroup\">\n<tr class=\"scene\" role=\"row\"><th scope=\"rowgroup\" role=\"rowheader\" \
             colspan=\"{}\"><div><a href=\"#scene-{index}\">{}</a> <span class=\"quiet\">{}</span></div></th></tr>\n\
             {rows}</tbody>\n",
            self.columns.len() + 1,
            escape(&scene.name),
            (self.beside)(scene)
        )
    }

    fn row(&self, scene: &SceneResults, number: usize, variant: &VariantResults) -> String {
        let cells: String = self
            .columns
            .iter()
            .zip((self.cells)(scene, number, variant))
            .map(|((title, unit), cell)| {
                let label = [*title, *unit].join(" ");
                format!("<td role=\"cell\" data-label=\"{}\"><div>{cell}</div></td>\n", label.trim_end())
            })
            .collect();
        let remarks: String =
            (self.remarks)(variant).iter().map(|remark| format!("<li>{}</li>", escape(remark))).collect();
        let below = if remarks.is_empty() {
            remarks
        } else {
            let columns = self.columns.len() + 1;
            format!(
                "<tr class=\"remarks\" role=\"row\"><td role=\"cell\" colspan=\"{columns}\"><ul>{remarks}</ul></td></tr>\n"
            )
        };
        format!(
            "<tr role=\"row\"><th scope=\"row\" role=\"rowheader\"><div>{} {}</div></th>\n{cells}</tr>\n{below}",
            key(number),
            escape(&variant.name)
        )
    }
}

/// What a scene's figures come to, in one or two sentences of HTML: what is most efficient, and whether the reference can say so.
pub fn verdict(scene: &SceneResults) -> String {
    [most_efficient(scene), doubted(scene), coarse(scene)]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

/// That the scene's reference is not confirmed, if that is so.
pub fn doubted(scene: &SceneResults) -> String {
    match &scene.reference.doubt {
        Some(doubt) => {
            format!("<strong class=\"doubt\">{WARNING} Reference not confirmed: {}.</strong>", escape(doubt))
        }
        None => String::new(),
    }
}

/// That the reference's own error is not far below the least one, if that is so.
fn coarse(scene: &SceneResults) -> String {
    match scene.reference_share() {
        Some(share) if share.is_finite() => format!(
            "The reference’s own error is {} times the least relMSE here; with more <code>--reference-time</code> it is less.",
            number::figure(share)
        ),
        Some(_) => String::from(
            "The least relMSE here is lost in the reference’s own error; with more <code>--reference-time</code> that is less.",
        ),
        None => String::new(),
    }
}

fn most_efficient(scene: &SceneResults) -> String {
    let (sorted, figure) = (scene.by_efficiency(), scene.ordered_by());
    let best = sorted.first().filter(|(_, best)| best.efficiency_by(figure).mean > 0.0 && sorted.len() > 1);
    let Some((_, best)) = best else {
        return String::new();
    };
    let caveat = if best.floor.flagged { ", but biased here" } else { "" };
    let name = format!("Most efficient: <strong>{}</strong>{caveat}", escape(&best.name));
    let told = |pair: &Pair| {
        let by = match pair.decided_by {
            Figure::Relmse => String::new(),
            figure => format!(" by {}", figure.in_words()),
        };
        let doubt = if pair.significant { "" } else { " (the difference is not significant)" };
        by + doubt
    };
    if let Some(pair) = scene.pair_of(&best.name) {
        let ratio = number::interval_line(pair.decisive());
        return format!("{name}; {ratio} times {}{}.", escape(&pair.against), told(pair));
    }
    let next = sorted.get(1).and_then(|(_, next)| scene.pair_of(&next.name)).filter(|pair| pair.against == best.name);
    match next {
        Some(pair) => {
            let ratio = number::interval_line(pair.decisive());
            format!("{name}; next comes {} with {ratio} of its efficiency{}.", escape(&pair.variant), told(pair))
        }
        None => format!("{name}."),
    }
}

fn overview(scene: &SceneResults, number: usize, variant: &VariantResults) -> Vec<String> {
    let last = variant.last();
    let figure = scene.ordered_by();
    let efficiency = variant.efficiency_by(figure);
    let most = scene.variants.iter().map(|variant| variant.efficiency_by(figure).mean);
    let most = most.filter(|value| value.is_finite()).fold(0.0, f64::max);
    let share = if most > 0.0 && efficiency.mean.is_finite() { (efficiency.mean / most).clamp(0.0, 1.0) } else { 1.0 };
    let by = match figure {
        Figure::Relmse => String::new(),
        figure => format!(" <small class=\"mark\">by {}</small>", figure.name()),
    };
    vec![
        format!(
            "{}{by}<span class=\"bar {}\" style=\"width: {:.0}%\"></span>",
            interval(efficiency),
            super::chart::style(number),
            100.0 * share
        ),
        ratio(scene, variant),
        of(last.map(|point| &point.relmse)),
        of(last.map(|point| &point.seconds)),
        last.map_or_else(none, |point| number::samples(point.spp)),
        slope(variant),
        flags(variant),
    ]
}

fn by_figure(scene: &SceneResults, _: usize, variant: &VariantResults) -> Vec<String> {
    let last = variant.last();
    let pair = scene.pair_of(&variant.name);
    let ratio = |figure: Figure| match pair {
        Some(pair) => {
            let found = pair.by(figure);
            let mark = |is: bool, what: &str| {
                if is { format!(" <small class=\"mark decides\">{what}</small>") } else { String::new() }
            };
            let tests = pair.tested_by == figure && pair.decided_by != figure;
            let decides = mark(pair.decided_by == figure, "decides") + &mark(tests, "its test decides");
            format!("<hr/>× {} {}{decides}", interval(&found.ratio), significance(found.significant))
        }
        None => String::new(),
    };
    let cell = |figure: Figure, value: fn(&CurvePoint) -> &Interval| of(last.map(value)) + &ratio(figure);
    let share = format!("{} %", number::trimmed((1000.0 * variant.worst_share).round() / 10.0));
    let mark = if variant.is_heavy() { " <small class=\"mark warning\">few pixels decide</small>" } else { "" };
    vec![
        cell(Figure::Relmse, |point| &point.relmse),
        cell(Figure::Parts, |point| &point.parts_relmse),
        cell(Figure::Trimmed, |point| &point.trimmed_relmse),
        cell(Figure::Median, |point| &point.median_relmse),
        share + mark,
    ]
}

fn rest(scene: &SceneResults, _: usize, variant: &VariantResults) -> Vec<String> {
    let million = |value: &Interval| interval(&number::scaled(value, 1e-6));
    let speed_ratio = scene.pair_of(&variant.name).map_or_else(String::new, |pair| {
        format!(" <small>{} × the first</small>", number::figure(pair.speed_ratio.mean))
    });
    let mebibytes = variant.device_bytes.map(|bytes| number::figure(bytes as f64 / 1_048_576.0));
    let (floor, deviation) = (number::figure(variant.floor.relmse), number::figure(variant.floor.deviation));
    vec![
        million(&variant.samples_per_s) + &speed_ratio,
        variant.rays_per_s.as_ref().map_or_else(none, million),
        format!("{floor} <small>± {deviation}</small>{}", bias_mark(variant)),
        fixed(&variant.energy_ratio, 4),
        set_up(&variant.setup),
        mebibytes.unwrap_or_else(none),
    ]
}

/// What stands where there is no figure.
fn none() -> String {
    String::from("–")
}

fn of(value: Option<&Interval>) -> String {
    value.map_or_else(none, interval)
}

/// An interval in a cell: the mean, and below it the ends.
fn interval(value: &Interval) -> String {
    in_cell(number::interval(value))
}

/// An interval in a cell, each number with so many decimals.
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

fn is_first(scene: &SceneResults, variant: &VariantResults) -> bool {
    scene.variants.first().is_some_and(|first| first.name == variant.name)
}

fn significance(significant: bool) -> &'static str {
    if significant {
        "<small class=\"mark sure\">significant</small>"
    } else {
        "<small class=\"mark\">not significant</small>"
    }
}

/// The ratio that decides, with its verdict.
fn ratio(scene: &SceneResults, variant: &VariantResults) -> String {
    let Some(pair) = scene.pair_of(&variant.name) else {
        let first = "1 <small class=\"mark\">the first</small>";
        return if is_first(scene, variant) { String::from(first) } else { none() };
    };
    let by = match pair.decided_by {
        Figure::Relmse => String::new(),
        figure => format!(" <small class=\"mark\">by {}</small>", figure.name()),
    };
    let doubt = match &scene.reference.doubt {
        Some(_) => format!(" <small class=\"mark warning\">{WARNING} reference</small>"),
        None => String::new(),
    };
    format!("{} {}{by}{doubt}", interval(pair.decisive()), significance(pair.significant))
}

fn bias_mark(variant: &VariantResults) -> &'static str {
    match (variant.floor.flagged, variant.bias.is_empty()) {
        (true, false) => " <small class=\"mark warning\">biased</small>",
        (true, true) => " <small class=\"mark warning\">unexpected bias</small>",
        (false, _) => "",
    }
}

fn slope(variant: &VariantResults) -> String {
    let of = match variant.slope_of {
        Figure::Relmse => String::new(),
        figure => format!(" <small class=\"mark\">of the {}</small>", figure.name()),
    };
    fixed(&variant.slope, 2) + &of
}

/// What is to be looked at before the figures of a variant are used, in a word or two each.
fn flags(variant: &VariantResults) -> String {
    let heavy = if variant.is_heavy() { "<small class=\"mark warning\">few pixels decide</small>" } else { "" };
    let flags = format!("{heavy}{}", bias_mark(variant));
    if flags.is_empty() { none() } else { flags }
}

/// What is to be said below a variant's figures.
fn remarks(variant: &VariantResults) -> Vec<String> {
    let mut remarks: Vec<String> = Vec::new();
    if variant.is_heavy() {
        remarks.push(format!(
            "A thousandth of the pixels makes {:.0} % of the relMSE, so few bright samples decide it.",
            100.0 * variant.worst_share
        ));
    }
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
    remarks
}
