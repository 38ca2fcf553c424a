//! The section of one scene: what ran, its reference, and the curves.

use super::chart::{Chart, Guide, Level, Series, Spot, Through, describe, key};
use super::html::{escape, fact};
use super::pictures::Pictures;
use super::reference::Own;
use super::{number, reference, rows, summary};
use crate::bench::results::{CurvePoint, ESTIMATE_TOLERANCE, Figure, SceneResults, VariantResults};
use crate::statistics::Interval;

/// A measure of error with its curves.
struct Metric {
    /// Its value in the page's switch.
    id: &'static str,
    name: &'static str,
    of: fn(&CurvePoint) -> Interval,
    /// Slope of plain Monte Carlo, where theory gives one.
    slope: Option<(f64, &'static str)>,
}

const METRICS: [Metric; 7] = [
    Metric { id: "relmse", name: "relMSE", of: |point| point.relmse, slope: Some((-1.0, "slope −1")) },
    Metric { id: "parts", name: "relMSE of parts", of: |point| point.parts_relmse, slope: Some((-1.0, "slope −1")) },
    Metric {
        id: "trimmed", name: "trimmed relMSE", of: |point| point.trimmed_relmse, slope: Some((-1.0, "slope −1"))
    },
    Metric { id: "median", name: "median", of: |point| point.median_relmse, slope: Some((-1.0, "slope −1")) },
    Metric { id: "rmse", name: "RMSE", of: |point| root(&point.mse), slope: Some((-0.5, "slope −½")) },
    Metric { id: "mape", name: "MAPE", of: |point| point.mape, slope: Some((-0.5, "slope −½")) },
    Metric { id: "flip", name: "FLIP", of: |point| point.flip, slope: None },
];

/// The section.
pub fn section(index: usize, scene: &SceneResults, pictures: &Pictures) -> String {
    let depth = if scene.max_depth < 0 { String::from("no limit") } else { format!("{} segments", scene.max_depth) };
    let facts = [
        fact("File", &format!("<code>{}</code>", escape(&scene.file))),
        fact("Image", &format!("{} × {} pixels", scene.width, scene.height)),
        fact("Longest path", &depth),
        fact("Triangles", &number::whole(scene.triangles)),
        fact("Lights", &number::whole(scene.lights)),
    ];
    let verdict = summary::verdict(scene);
    let verdict = if verdict.is_empty() { verdict } else { format!("<p class=\"lead\">{verdict}</p>\n") };
    format!(
        "<section class=\"scene\" aria-labelledby=\"scene-{index}\">\n<h2 id=\"scene-{index}\">{}</h2>\n{verdict}\
         <dl class=\"facts\">\n{}</dl>\n{}{}{}{}{}</section>\n",
        escape(&scene.name),
        facts.concat(),
        what_ran(scene),
        reference::section(scene, pictures),
        curves(index, scene),
        rows::rows(scene, pictures),
        rows::comparison(index, scene, pictures),
    )
}

fn what_ran(scene: &SceneResults) -> String {
    let row = |(index, variant): (usize, &VariantResults)| {
        let options = if variant.options.is_empty() { String::from("–") } else { escape(&variant.options.join(" ")) };
        let bias = if variant.bias.is_empty() { String::from("none") } else { escape(&variant.bias) };
        format!(
            "<tr role=\"row\"><th scope=\"row\" role=\"rowheader\"><div>{} {}</div></th>{}</tr>\n",
            key(index),
            escape(&variant.name),
            [
                ("Renderer", escape(&variant.renderer)),
                ("Technique", escape(&variant.technique)),
                ("Backend", escape(&variant.backend)),
                ("Options", options),
                ("Bias", bias),
                ("Time in kernels", kernel_share(variant)),
                ("Own estimate of relMSE", own_estimate(variant)),
            ]
            .map(|(label, cell)| format!("<td role=\"cell\" data-label=\"{label}\"><div>{cell}</div></td>"))
            .concat()
        )
    };
    let rows: String = scene.variants.iter().enumerate().map(row).collect();
    let heads =
        ["Variant", "Renderer", "Technique", "Backend", "Options", "Bias", "Time in kernels", "Own estimate of relMSE"]
            .map(|head| format!("<th scope=\"col\" role=\"columnheader\">{head}</th>"));
    format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"What ran\">\n<table class=\"ran\" role=\"table\">\n\
         <thead role=\"rowgroup\"><tr role=\"row\">{}</tr></thead>\n<tbody role=\"rowgroup\">\n{rows}</tbody>\n</table>\n</div>\n",
        heads.concat()
    )
}

/// What the variant's own estimate of its relMSE, at which `render -e` stops, is of the true one, and how often it was right.
fn own_estimate(variant: &VariantResults) -> String {
    match (variant.estimate_coverage(), &variant.estimate_ratio) {
        ((_, 0), _) | (_, None) => String::from("none"),
        ((right, runs), Some(ratio)) => format!(
            "{} of the true one; within {} % in {right} of {runs} runs",
            number::interval_line(ratio),
            number::trimmed(100.0 * ESTIMATE_TOLERANCE)
        ),
    }
}

/// The share of the time of rendering that the device spends in kernels, at the end.
fn kernel_share(variant: &VariantResults) -> String {
    let share = variant.last().and_then(|last| last.device_seconds.map(|device| device.mean / last.seconds.mean));
    match share.filter(|share| share.is_finite()) {
        Some(share) => format!("{} %", number::figure(100.0 * share)),
        None => String::from("not measured"),
    }
}

/// The error that the charts show at first: the one that the variants are ordered by.
fn is_shown_first(scene: &SceneResults, metric: &Metric) -> bool {
    metric.id == if scene.ordered_by() == Figure::Parts { "parts" } else { "relmse" }
}

fn curves(index: usize, scene: &SceneResults) -> String {
    let switch: String = METRICS
        .iter()
        .map(|metric| {
            let checked = if is_shown_first(scene, metric) { " checked=\"checked\"" } else { "" };
            format!(
                "<label><input type=\"radio\" name=\"metric-{index}\" value=\"{}\"{checked}/> {}</label>\n",
                metric.id, metric.name
            )
        })
        .collect();
    let legend: String = scene
        .variants
        .iter()
        .enumerate()
        .map(|(number, variant)| {
            format!("<li data-series=\"{number}\">{} {}</li>\n", key(number), escape(&variant.name))
        })
        .collect();
    let panels: String = METRICS.iter().map(|metric| panel(scene, metric)).collect();
    format!(
        "<div class=\"curves\">\n<h3>Error along the way</h3>\n<div class=\"controls\">\n\
         <fieldset class=\"switch needs-script\"><legend>Error as</legend>\n{switch}</fieldset>\n\
         <ul class=\"legend\" aria-label=\"Legend\">\n{legend}</ul>\n</div>\n{panels}{}</div>\n",
        kernels(scene)
    )
}

fn panel(scene: &SceneResults, metric: &Metric) -> String {
    let hidden = if is_shown_first(scene, metric) { "" } else { " hidden=\"hidden\"" };
    let time = chart(scene, metric, "seconds", "time of rendering (s)", |point| point.seconds);
    let samples = chart(scene, metric, "samples per pixel", "samples per pixel", |point| exact(point.spp));
    let mut explain = String::new();
    if ["relmse", "parts"].contains(&metric.id) {
        explain += "Dashed: slope −1 through the best end of a run; along it efficiency is the same, and a curve twice as high needs twice \
                    the time.";
        if metric.id == "relmse" && scene.variants.iter().any(shows_floor) {
            explain += " Dotted: the error that stays, where the bias is significant.";
        }
    }
    if !levels(scene, metric).is_empty() {
        explain += " Grey: the reference’s own error. Its expectation is taken off all curves, but one that comes near that line is \
                    flattened or bent by it.";
    }
    let explain = match explain.trim_start() {
        "" => String::new(),
        text => format!("<p class=\"quiet\">{text}</p>\n"),
    };
    format!(
        "<div class=\"panel\" data-metric=\"{}\"{hidden}>\n<div class=\"plots\">\n{time}{samples}</div>\n{explain}</div>\n",
        metric.id
    )
}

fn chart(scene: &SceneResults, metric: &Metric, unit: &str, x: &str, at: fn(&CurvePoint) -> Interval) -> String {
    let series = scene.variants.iter().enumerate().map(|(index, variant)| {
        let spots = variant.curve.iter().map(|point| {
            let (x, y) = (at(point), (metric.of)(point));
            let place = format!("{} spp, {} s", number::samples(point.spp), number::figure(point.seconds.mean));
            Spot { x, y, text: describe(&variant.name, &place, metric.name, &y) }
        });
        let floor = (metric.id == "relmse" && shows_floor(variant)).then_some(variant.floor.relmse);
        Series { name: &variant.name, index, points: spots.collect(), floor }
    });
    let guide = metric.slope.map(|(slope, label)| Guide { slope, through: Through::BestEnd, label });
    let text = format!("{} over {unit} for each variant on {}, both axes logarithmic", metric.name, scene.name);
    Chart { text, x, y: metric.name, series: series.collect(), guide, levels: levels(scene, metric) }.draw()
}

/// The reference's own error, where it is known by that measure: as a relMSE, and without its worst pixels about the same unless few
/// samples decide it.
fn levels(scene: &SceneResults, metric: &Metric) -> Vec<Level<'static>> {
    let Some(own) = Own::of(&scene.reference) else { return Vec::new() };
    let label = match (metric.id, own.at_least) {
        ("relmse", true) => "reference’s own error, at least",
        ("relmse" | "parts" | "trimmed", false) => "reference’s own error",
        _ => return Vec::new(),
    };
    vec![Level { value: own.relmse, label }]
}

/// Time in kernels over all time, if any variant knows both.
fn kernels(scene: &SceneResults) -> String {
    let series: Vec<Series> = scene
        .variants
        .iter()
        .enumerate()
        .map(|(index, variant)| {
            let spots = variant.curve.iter().filter_map(|point| {
                let y = point.device_seconds?;
                let place = format!("{} s of rendering", number::figure(point.seconds.mean));
                Some(Spot { x: point.seconds, y, text: describe(&variant.name, &place, "seconds in kernels:", &y) })
            });
            Series { name: &variant.name, index, points: spots.collect(), floor: None }
        })
        .filter(|series| !series.points.is_empty())
        .collect();
    if series.is_empty() {
        return String::new();
    }
    let without: Vec<&str> = scene
        .variants
        .iter()
        .filter(|variant| variant.curve.iter().all(|point| point.device_seconds.is_none()))
        .map(|variant| variant.name.as_str())
        .collect();
    let missing = if without.is_empty() {
        String::new()
    } else {
        format!(" Without a device clock: {}.", escape(&without.join("; ")))
    };
    let chart = Chart {
        text: format!("Seconds in kernels over seconds of rendering for each variant on {}", scene.name),
        x: "time of rendering, host's clock (s)",
        y: "time in kernels, device's clock (s)",
        series,
        guide: Some(Guide { slope: 1.0, through: Through::Unity, label: "all time in kernels" }),
        levels: Vec::new(),
    };
    format!(
        "<details class=\"kernels\">\n<summary>Time in kernels against all time of rendering</summary>\n\
         <p class=\"quiet\">The distance below the dashed line is what the host adds: recording, submitting, waiting.{missing}</p>\n\
         <div class=\"plots\">\n{}</div>\n</details>\n",
        chart.draw()
    )
}

fn shows_floor(variant: &VariantResults) -> bool {
    variant.floor.flagged && variant.floor.relmse > 0.0
}

/// A value without an interval.
fn exact(value: f64) -> Interval {
    Interval { mean: value, low: value, high: value }
}

/// The root of an interval; what is negative has the root 0.
fn root(interval: &Interval) -> Interval {
    let root = |value: f64| if value.is_nan() { value } else { value.max(0.0).sqrt() };
    Interval { mean: root(interval.mean), low: root(interval.low), high: root(interval.high) }
}
