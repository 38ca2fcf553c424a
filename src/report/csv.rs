//! The curves as a table: one line per scene, variant and point (RFC 4180, but with plain line feeds).

use crate::bench::results::Results;
use crate::statistics::Interval;

/// The columns of `results.csv`.
///
/// `scene`, `file`, `width`, `height`, `variant`, `renderer`, `technique`, `backend`, `options` (separated by spaces) and
/// `bias` say what was run; `seeds` how many runs the means are over, and `point` counts the curve's points from 0. Then,
/// for each quantity, its mean and the ends of its interval: `seconds` of rendering by the host's clock, `device_seconds` in
/// the kernels (empty where not measured), and the errors `relmse`, `parts_relmse` (the median of eight parts), `trimmed_relmse` (without the worst thousandth of the pixels),
/// `median_relmse` (median of the pixels' squared relative errors), `mse`, `mape` and `flip`. All numbers are written so that they
/// read back exactly.
pub const COLUMNS: [&str; 40] = [
    "scene",
    "file",
    "width",
    "height",
    "variant",
    "renderer",
    "technique",
    "backend",
    "options",
    "bias",
    "seeds",
    "point",
    "spp",
    "seconds",
    "seconds_low",
    "seconds_high",
    "device_seconds",
    "device_seconds_low",
    "device_seconds_high",
    "relmse",
    "relmse_low",
    "relmse_high",
    "parts_relmse",
    "parts_relmse_low",
    "parts_relmse_high",
    "trimmed_relmse",
    "trimmed_relmse_low",
    "trimmed_relmse_high",
    "median_relmse",
    "median_relmse_low",
    "median_relmse_high",
    "mse",
    "mse_low",
    "mse_high",
    "mape",
    "mape_low",
    "mape_high",
    "flip",
    "flip_low",
    "flip_high",
];

/// The whole table, its header included.
pub fn table(results: &Results) -> String {
    let mut table = line(COLUMNS.map(String::from));
    for scene in &results.scenes {
        for variant in &scene.variants {
            for (index, point) in variant.curve.iter().enumerate() {
                let what = [
                    scene.name.clone(),
                    scene.file.clone(),
                    scene.width.to_string(),
                    scene.height.to_string(),
                    variant.name.clone(),
                    variant.renderer.clone(),
                    variant.technique.clone(),
                    variant.backend.clone(),
                    variant.options.join(" "),
                    variant.bias.clone(),
                    results.seeds.to_string(),
                    index.to_string(),
                    point.spp.to_string(),
                ];
                let figures = [
                    Some(point.seconds),
                    point.device_seconds,
                    Some(point.relmse),
                    Some(point.parts_relmse),
                    Some(point.trimmed_relmse),
                    Some(point.median_relmse),
                    Some(point.mse),
                    Some(point.mape),
                    Some(point.flip),
                ];
                table += &line(what.into_iter().chain(figures.into_iter().flat_map(ends)));
            }
        }
    }
    table
}

fn ends(interval: Option<Interval>) -> [String; 3] {
    interval.map_or_else(Default::default, |Interval { mean, low, high }| [mean, low, high].map(|end| end.to_string()))
}

fn line(fields: impl IntoIterator<Item = String>) -> String {
    let quoted = fields.into_iter().map(|field| {
        if field.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field }
    });
    quoted.collect::<Vec<String>>().join(",") + "\n"
}
