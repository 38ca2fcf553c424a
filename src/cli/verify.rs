//! `lumbre verify`: the accuracy suite on the user's own device.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use lumbre::error::{Error, Result};
use lumbre::files::{check_folder_name, check_writable};
use lumbre::layout::backend::Backend;
use lumbre::verify::{CASES, Case, Effort, Figure, On, Outcome, Verdict, backends_of, find, measure_all};

use super::args::DeviceArgs;
use super::markdown::{Table, code};
use super::output::{check_json, print, takes_standard_output, write_json};

/// Characters of a figure's description in the table.
const WIDTH: usize = 72;

#[derive(Args)]
pub(super) struct VerifyArgs {
    /// Measure this case only and say where it is worst; may repeat. Its images go to `verify-NAME` unless -o says
    #[arg(long, value_name = "NAME")]
    case: Vec<String>,

    /// List the cases: what each tests, its bound, and the source of what is expected
    #[arg(long, conflicts_with_all = ["case", "short", "output", "backend"])]
    list: bool,

    /// With --list: as a Markdown table, which docs/verify.md holds
    #[arg(long, requires = "list", conflicts_with = "json")]
    markdown: bool,

    /// One or two techniques, fewer samples and rays: tens of seconds instead of minutes
    #[arg(long)]
    short: bool,

    /// Backends to verify, separated by commas; by default every one that the device has
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    backend: Vec<String>,

    /// Folder for verify.json and all images
    #[arg(short = 'o', long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Write the figures as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,
}

/// What the JSON file holds.
#[derive(Serialize)]
struct Report<'a> {
    schema: &'static str,
    version: &'static str,
    device: &'a str,
    driver: &'a str,
    effort: &'static str,
    verdict: Verdict,
    seconds: f64,
    cases: &'a [Outcome],
}

pub(super) fn run(args: &VerifyArgs) -> Result<()> {
    check_json(args.json.as_deref())?;
    args.output.as_deref().map_or(Ok(()), check_folder_name)?;
    if args.list {
        if args.markdown {
            print(table().trim_end());
        } else {
            list(args.json.as_deref())?;
        }
        return Ok(());
    }
    let named = args.case.iter().map(|name| find(name)).collect::<Result<Vec<_>>>()?;
    let cases: Vec<&'static Case> = if named.is_empty() { CASES.iter().collect() } else { named };
    let stdout = args.json.as_deref().is_some_and(takes_standard_output);
    let gpu = args.device.open()?;
    let mut backends: Vec<Backend> = if args.backend.is_empty() {
        backends_of(&gpu)
    } else {
        args.backend.iter().map(|name| gpu.backend(Some(name))).collect::<Result<_>>()?
    };
    let mut seen = Vec::new();
    backends.retain(|backend| {
        !seen.contains(backend) && {
            seen.push(*backend);
            true
        }
    });
    let default = args.case.first().map(|name| PathBuf::from(format!("verify-{name}")));
    let folder = args.output.clone().or(default);
    if let Some(folder) = &folder {
        std::fs::create_dir_all(folder)
            .map_err(|error| Error::Usage(format!("cannot write {}: {}", folder.display(), error.kind())))?;
        check_writable(&folder.join("verify.json"))?;
    }
    let survey = gpu.survey();
    if !stdout {
        print(&format!("device     {} ({})", survey.name, survey.driver));
        print(&head());
    }
    let started = Instant::now();
    let effort = if args.short { Effort::Short } else { Effort::Full };
    let mut outcomes = Vec::new();
    let open = || args.device.open();
    measure_all(open, DeviceArgs::report_validation, &cases, &backends, effort, folder.as_deref(), |outcome| {
        if !stdout {
            print_outcome(&outcome, !args.case.is_empty());
        }
        outcomes.push(outcome);
        Ok(())
    })?;
    let verdict = outcomes.iter().map(Outcome::verdict).max().unwrap_or(Verdict::Fail);
    let report = Report {
        schema: "lumbre-verify-1",
        version: env!("CARGO_PKG_VERSION"),
        device: &survey.name,
        driver: &survey.driver,
        effort: if args.short { "short" } else { "full" },
        verdict,
        seconds: started.elapsed().as_secs_f64(),
        cases: &outcomes,
    };
    for path in args.json.iter().cloned().chain(folder.map(|folder| folder.join("verify.json"))) {
        write_json(&path, &report)?;
    }
    let count = |wanted: Verdict| figures(&outcomes).filter(|figure| figure.verdict == wanted).count();
    if !stdout {
        print(&format!(
            "\n{} figures within their bounds, {} beyond them by the driver's doing, {} beyond them; {:.0} s",
            count(Verdict::Pass),
            count(Verdict::Driver),
            count(Verdict::Fail),
            report.seconds
        ));
    }
    let broken: Vec<String> = outcomes
        .iter()
        .filter(|outcome| outcome.verdict() == Verdict::Fail)
        .map(|outcome| format!("{} on {}", outcome.case, outcome.backend))
        .collect();
    if broken.is_empty() { Ok(()) } else { Err(Error::Verification(lumbre::error::all_of(broken))) }
}

fn figures(outcomes: &[Outcome]) -> impl Iterator<Item = &Figure> {
    outcomes.iter().flat_map(|outcome| &outcome.figures)
}

fn head() -> String {
    format!(
        "\n{:<18} {:<10} {:<25} {:<WIDTH$} {:>9} {:>9}  verdict",
        "case", "backend", "technique", "what", "figure", "bound"
    )
}

/// A case's worst figure of each technique and verdict; all of them where `all`.
fn print_outcome(outcome: &Outcome, all: bool) {
    let share = |figure: &Figure| match figure.bound {
        Some(bound) if bound > 0.0 => figure.figure / bound,
        _ => figure.figure,
    };
    let mut shown: Vec<&Figure> = Vec::new();
    for figure in &outcome.figures {
        let told = figure.verdict == Verdict::Told;
        let known = shown.iter_mut().find(|other| {
            !all && !told
                && figure.verdict == Verdict::Pass
                && other.verdict == Verdict::Pass
                && other.technique == figure.technique
        });
        match known {
            Some(other) if share(figure) > share(other) => *other = figure,
            Some(_) => (),
            None => shown.push(figure),
        }
    }
    for figure in shown {
        let bound = figure.bound.map_or(String::from("-"), number);
        print(&format!(
            "{:<18} {:<10} {:<25} {:<WIDTH$} {:>9} {:>9}  {}",
            outcome.case,
            outcome.backend,
            figure.technique,
            figure.what,
            number(figure.figure),
            bound,
            figure.verdict.name()
        ));
        if let (Some(measured), Some(expected), true) = (figure.measured, figure.expected, all) {
            print(&format!("{:<18} measured {measured} against {expected}", ""));
        }
        if !figure.worst.is_empty() && (all || figure.verdict >= Verdict::Driver) {
            print(&format!("{:<18} worst: {}", "", figure.worst));
        }
    }
    if all {
        outcome.files.iter().for_each(|file| print(&format!("{:<18} wrote {file}", "")));
    }
}

/// A figure in nine characters.
fn number(value: f64) -> String {
    if value == value.round() && value.abs() < 1e7 {
        format!("{value}")
    } else if (0.01..1e5).contains(&value.abs()) {
        format!("{value:.4}")
    } else {
        format!("{value:.2e}")
    }
}

/// The cases as a Markdown table.
fn table() -> String {
    let mut table = Table::new(&["case", "what", "bound", "source of what is expected", "on"]);
    for case in CASES {
        let on = match case.on {
            On::EachBackend => "each backend",
            On::Once => "once",
        };
        table.row(&[
            code(case.name),
            case.tests.to_owned(),
            case.bound.to_owned(),
            case.source.to_owned(),
            on.to_owned(),
        ]);
    }
    table.end()
}

fn list(json: Option<&Path>) -> Result<()> {
    #[derive(Serialize)]
    struct Row {
        case: &'static str,
        tests: &'static str,
        bound: &'static str,
        source: &'static str,
    }
    let row = |case: &Case| Row { case: case.name, tests: case.tests, bound: case.bound, source: case.source };
    let rows: Vec<Row> = CASES.iter().map(row).collect();
    if let Some(path) = json {
        return write_json(path, &rows);
    }
    for row in rows {
        print(&format!(
            "{:<18} {}\n{:<18} bound: {}\n{:<18} source: {}",
            row.case, row.tests, "", row.bound, "", row.source
        ));
    }
    Ok(())
}
