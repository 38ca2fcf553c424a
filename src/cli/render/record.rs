//! `--record`: what one frame does on the device, as JSON and as a picture of the timeline.

use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use lumbre::error::Result;
use lumbre::files::replace_by;
use lumbre::gpu::{BufferRecord, CommandRecord, Gpu, SubmissionRecord};
use lumbre::render::{KernelSize, Renderer};
use lumbre::report::html::escape;

use super::super::output::write_json;

/// The JSON object; its keys are a contract.
#[derive(Serialize)]
struct FrameReport {
    schema: &'static str,
    device: String,
    integrator: String,
    backend: &'static str,
    width: u32,
    height: u32,
    /// Samples of each pixel that these submissions took.
    samples: f64,
    kernels: Vec<KernelSize>,
    submissions: Vec<SubmissionRecord>,
    buffers: Vec<BufferRecord>,
}

/// Takes one sample of every pixel, writes what the queue was given for it to `folder`, and leaves the rendering as it was at the beginning.
/// Returns what it has written.
pub(super) fn record(gpu: &Gpu, renderer: &mut Renderer, folder: &Path) -> Result<String> {
    gpu.start_journal()?;
    while renderer.advance(1)? {}
    let (submissions, buffers) = gpu.end_journal();
    let settings = renderer.settings();
    let report = FrameReport {
        schema: "lumbre-frame-1",
        device: gpu.survey().name.clone(),
        integrator: settings.technique.describe(),
        backend: settings.backend.name(),
        width: settings.width,
        height: settings.height,
        samples: renderer.progress(),
        kernels: renderer.kernel_sizes(),
        submissions,
        buffers,
    };
    let (json, svg) = (folder.join("frame.json"), folder.join("frame.svg"));
    write_json(&json, &report)?;
    replace_by(&svg, timeline(&report).as_bytes())?;
    let seed = renderer.settings().seed;
    renderer.restart(seed)?;
    Ok(format!("{} and {}", json.display(), svg.display()))
}

/// Width of the bars' column, and where it begins.
const BARS: f64 = 620.0;
const LEFT: f64 = 360.0;
/// Height of a row.
const ROW: f64 = 20.0;

/// A row for each command, with a bar from when it began to when it was done.
fn timeline(report: &FrameReport) -> String {
    let whole = |submission: &SubmissionRecord| {
        submission.commands.iter().filter_map(|command| command.end_us).fold(0.0, f64::max)
    };
    let longest: f64 = report.submissions.iter().map(whole).sum::<f64>().max(1e-3);
    let mut rows = String::new();
    let mut y = 56.0;
    let mut before = 0.0;
    for submission in &report.submissions {
        let title =
            format!("{}: {}; {:.3} ms by the host's clock", submission.pass, submission.work, 1e3 * submission.wall_s);
        let _ = writeln!(rows, r#"<text x="10" y="{y:.0}" font-weight="bold">{}</text>"#, escape(&title));
        y += ROW;
        for command in &submission.commands {
            row(&mut rows, command, y, before, longest);
            y += ROW;
        }
        before += whole(submission);
        y += 0.5 * ROW;
    }
    let title = format!(
        "{} on {}, {}x{}, samples of each pixel: {}; {}",
        report.integrator, report.backend, report.width, report.height, report.samples, report.device
    );
    let height = y + 10.0;
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="1000" height="{height:.0}" viewBox="0 0 1000 {height:.0}" font-family="sans-serif" font-size="12">
<rect width="100%" height="100%" fill="#fff"/>
<text x="10" y="24" font-size="15">{}</text>
<text x="{LEFT}" y="42" fill="#666">0</text><text x="{:.0}" y="42" fill="#666" text-anchor="end">{:.3} ms by the device's clock</text>
{rows}</svg>
"##,
        escape(&title),
        LEFT + BARS,
        longest / 1e3
    )
}

fn row(rows: &mut String, command: &CommandRecord, y: f64, before: f64, longest: f64) {
    let name = match command.workgroups {
        Some(count) => format!("{} {}, {count} workgroups", command.kind, command.name),
        None if command.kind == "barrier" => String::from("barrier"),
        None => format!("{} {}", command.kind, command.name),
    };
    let _ = writeln!(rows, r##"<text x="20" y="{y:.0}" fill="#333">{}</text>"##, escape(&name));
    let (Some(begin), Some(end)) = (command.begin_us, command.end_us) else { return };
    let colour = match command.kind {
        "dispatch" => "#2a6fb0",
        "barrier" => "#bbb",
        _ => "#d08a20",
    };
    let place = |us: f64| LEFT + (before + us) / longest * BARS;
    let width = (place(end) - place(begin)).max(1.0);
    let took = format!("{:.3} ms", (end - begin) / 1e3);
    let _ = writeln!(
        rows,
        r#"<rect x="{:.1}" y="{:.1}" width="{width:.1}" height="13" fill="{colour}"><title>{}: {took}</title></rect>"#,
        place(begin),
        y - 11.0,
        escape(&name)
    );
}
