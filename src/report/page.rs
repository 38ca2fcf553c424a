//! The page as a whole: what ran where, what the figures mean, and the sections in their order.

use super::csv::COLUMNS;
use super::html::{escape, fact, json_in_script};
use super::pictures::Pictures;
use super::{number, scene, summary};
use crate::bench::results::Results;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// The page; `json` and `csv` are the results as JSON, and their table as a JSON string.
pub fn page(results: &Results, pictures: &Pictures, json: &str, csv: &str) -> String {
    let title = title(results);
    let scenes: String =
        results.scenes.iter().enumerate().map(|(index, scene)| scene::section(index, scene, pictures)).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"generator\" content=\"lumbre {version}\"/>\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n\
         <body>\n{store}<header>\n<h1>{title}</h1>\n{head}</header>\n<main>\n{summary}{glossary}{scenes}</main>\n{footer}\
         <script type=\"application/json\" id=\"results-json\">{json}</script>\n\
         <script type=\"application/json\" id=\"results-csv\">{csv}</script>\n\
         <script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        version = escape(&results.version),
        store = pictures.store(),
        head = head(results),
        summary = summary::section(results),
        glossary = glossary(results),
        footer = footer(results),
        json = json_in_script(json),
        csv = json_in_script(csv),
    )
}

fn title(results: &Results) -> String {
    let names: Vec<&str> = results.scenes.iter().map(|scene| scene.name.as_str()).collect();
    match names.as_slice() {
        [] => String::from("Speed against error"),
        [first, rest @ ..] if rest.len() > 3 => {
            escape(&format!("Speed against error: {first} and {} more", rest.len()))
        }
        names => escape(&format!("Speed against error: {}", names.join(", "))),
    }
}

fn head(results: &Results) -> String {
    let device = &results.device;
    let length = match (results.seconds, results.spp) {
        (Some(seconds), _) => format!("{} s of rendering each", number::figure(seconds)),
        (None, Some(spp)) => format!("{} samples per pixel each", number::whole(spp.into())),
        (None, None) => String::from("of no set length"),
    };
    let runs = match results.seeds {
        1 => format!("1 run per variant, {length}"),
        seeds => format!("{seeds} runs per variant with different seeds, {length}"),
    };
    let facts = [
        fact("Device", &escape(&device.name)),
        fact("Driver", &escape(&device.driver)),
        fact("Host", &format!("{}, {} logical processors", escape(&device.host), device.processors)),
        fact("Started", &started(&results.started)),
        fact("Runs", &runs),
        fact("Program", &format!("lumbre {}", escape(&results.version))),
    ];
    format!(
        "<p class=\"lead\">{}</p>\n<dl class=\"facts\">\n{}</dl>\n\
         <p class=\"command\"><span class=\"quiet\">Command</span> <code>{}</code></p>\n",
        meaning_of_intervals(results),
        facts.concat(),
        escape(&results.command)
    )
}

/// A time in UTC as people read it.
fn started(time: &str) -> String {
    let readable = time.strip_suffix('Z').map(|time| format!("{} UTC", time.replace('T', " ")));
    format!("<time datetime=\"{}\">{}</time>", escape(time), escape(&readable.unwrap_or_else(|| time.to_owned())))
}

/// What the intervals mean, in one sentence.
fn meaning_of_intervals(results: &Results) -> String {
    match results.seeds {
        0 | 1 => String::from(
            "Every variant ran once, so no figure has an interval and no difference can be called significant.",
        ),
        seeds => format!(
            "Figures are means over {seeds} independent runs; the brackets, bands and whiskers are their {} % confidence \
             intervals: where the whole experiment is repeated, that share of such intervals holds the true mean.",
            number::trimmed(100.0 * results.confidence)
        ),
    }
}

fn glossary(results: &Results) -> String {
    let terms = [
        (
            "relMSE",
            "mean of (a − b)² / (b² + 0.01) over pixels and channels, a the image and b the reference; the reference's own noise is taken off, so that a small value can be negative.",
        ),
        (
            "relMSE of parts, trimmed relMSE, median",
            "the median of the means of eight parts of the image, into which the pixels are dealt at random; the relMSE without the worst thousandth of the pixels, and the median of the pixels' squared relative errors. A single firefly, a pixel with a rare and very bright sample, can make most of a relMSE; it does not change these three, and where bright samples are many, that of parts has them. What they leave out is error all the same: of a technique whose error is all in few pixels they tell too little.",
        ),
        (
            "Few pixels decide",
            "the worst thousandth of the pixels makes more than 30 % of the relMSE in a run. Another seed may then give quite another relMSE.",
        ),
        (
            "Reference",
            "the image that stands for the truth. Unless one is given, several techniques are tried for a moment, and the one that is expected to be least off makes it, from independent seeds. It is an estimate too: it has noise, and it lacks the light that its technique did not find.",
        ),
        (
            "Witness, confirmed",
            "the witness is another technique that renders the scene independently and is compared with the reference tile by tile, from single pixels to the whole image. The reference is confirmed if no tile differs beyond noise and one of the two can aim at all light of the scene. Tests are so strict that of a hundred right references one is doubted. Where a reference is not confirmed, errors against it may be those of the reference.",
        ),
        (
            "Own error, at least",
            "the reference's own relMSE, estimated from how its independent parts differ, with the interval that holds it in 95 % of cases. “At least” stands where few bright samples make most of it: more of them may be missing, and nobody knows how many.",
        ),
        (
            "RMSE, MAPE, FLIP",
            "root of the mean of (a − b)²; mean of |a − b| / (|b| + 0.01); mean of the difference that a viewer sees between the tone-mapped images (FLIP, 0 to 1).",
        ),
        (
            "Efficiency",
            "1 / (error × seconds of rendering): twice the efficiency reaches the same error in half the time. Geometric mean over runs. The error is the relMSE; in scenes where the relMSE of parts decides any ratio, it is that of parts for all variants, and the table says so.",
        ),
        (
            "Ratio, and which test decides",
            "efficiency over that of the scene's first variant; significant where Welch's test of the logarithms says so at the 1 % level. The test goes by relMSE. Where few pixels decide the relMSE of either variant, the ratio is that of the relMSE of parts, and the test that of the trimmed relMSE: bright samples tell how much better a technique is that has none of them, all other pixels whether it is.",
        ),
        (
            "Slope",
            "of log relMSE over log seconds; where few pixels decide the relMSE, of the median, as each rare bright sample makes a step of the relMSE. Plain Monte Carlo has −1; above it, something that more samples do not cure: bias, or a noisy reference.",
        ),
        (
            "Bias floor",
            "the relMSE that would stay after any number of samples, estimated from products of independent runs, ± its standard deviation where there is none. Marked where it exceeds four of those deviations.",
        ),
        ("Energy ratio", "mean of the image over that of the reference: 1 where no light is lost or added."),
        (
            "Seconds",
            "of rendering by the host's clock, without set-up: reading the scene (load), building the acceleration structure and uploading (build), making the kernels (compile).",
        ),
    ];
    let list: String =
        terms.iter().map(|(term, text)| format!("<dt>{}</dt><dd>{}</dd>\n", escape(term), escape(text))).collect();
    let columns: String = COLUMNS.iter().map(|column| format!("<code>{column}</code> ")).collect();
    let csv = format!(
        "<dt>results.csv</dt><dd>one line per scene, variant and point of its curve, with the columns {columns}. The figures are \
         those of {} runs; <code>results.json</code> has every single one.</dd>\n",
        results.seeds
    );
    format!(
        "<details class=\"glossary\">\n<summary>What the figures mean</summary>\n<dl>\n{list}{csv}</dl>\n</details>\n"
    )
}

fn footer(results: &Results) -> String {
    format!(
        "<footer>\n<p class=\"needs-script downloads\">The figures: \
         <button type=\"button\" data-download=\"results-json\" data-name=\"results.json\">results.json</button> \
         <button type=\"button\" data-download=\"results-csv\" data-name=\"results.csv\">results.csv</button></p>\n\
         <p class=\"quiet\">Written by lumbre {}, schema {}.</p>\n</footer>\n",
        escape(&results.version),
        escape(&results.schema)
    )
}
