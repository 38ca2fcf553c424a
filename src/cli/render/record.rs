//! `--record`: what one frame does on the device, as JSON and as a picture of the timeline.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use serde::Serialize;

use lumbre::error::{Error, Result};
use lumbre::files::{check_folder_name, check_writable, replace_by};
use lumbre::gpu::{BufferRecord, CommandRecord, Gpu, SubmissionRecord};
use lumbre::render::{KernelSize, Renderer};
use lumbre::report::html::escape;

use super::super::output::{say, write_json};
use super::job::Job;
use super::progress::Progress;

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

/// The files of a recording.
pub(super) fn files(folder: &Path) -> [PathBuf; 2] {
    ["frame.json", "frame.svg"].map(|name| folder.join(name))
}

/// Makes the folder; fails where the files of a recording could not be written to it.
pub(super) fn check_folder(folder: &Path) -> Result<()> {
    check_folder_name(folder)?;
    std::fs::create_dir_all(folder)
        .map_err(|error| Error::Usage(format!("cannot make the folder {}: {error}", folder.display())))?;
    files(folder).iter().try_for_each(|path| check_writable(path))
}

/// Takes one sample of every pixel, writes what the queue was given for it to `folder`, and leaves the rendering as it was at the beginning. The
/// seconds that this took are taken from those that the job has. Where the user ends it before each pixel has its sample, nothing is written.
pub(super) fn record(
    gpu: &Gpu,
    renderer: &mut Renderer,
    folder: &Path,
    job: &mut Job,
    (interrupted, quiet): (&AtomicBool, bool),
) -> Result<()> {
    let began = Instant::now();
    if !quiet {
        say!("recording one sample of each pixel");
    }
    if let Some(seconds) = job.time {
        renderer.set_time_budget(seconds);
    }
    gpu.start_journal()?;
    let taken = take_sample(renderer, interrupted, quiet);
    let (submissions, buffers) = gpu.end_journal();
    if !taken? {
        let folder = folder.display();
        return Err(Error::Interrupted(format!(
            "{folder} is as it was, for not every pixel had its sample; there is no image yet"
        )));
    }
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
    let [json, svg] = files(folder);
    replace_by(&svg, timeline(&report).as_bytes())?;
    write_json(&json, &report)?;
    if !quiet {
        say!("wrote {} and {}", json.display(), svg.display());
    }
    let seed = renderer.settings().seed;
    renderer.restart(seed)?;
    job.time = job.time.map(|seconds| (seconds - began.elapsed().as_secs_f64()).max(0.0));
    Ok(())
}

/// Renders until each pixel has a sample; whether the user let it.
fn take_sample(renderer: &mut Renderer, interrupted: &AtomicBool, quiet: bool) -> Result<bool> {
    let began = Instant::now();
    let mut progress = Progress::new(quiet, &Job { outputs: Vec::new(), spp: 1, time: None });
    while renderer.spp() < 1 && !interrupted.load(Ordering::Relaxed) && renderer.advance(1)? {
        progress.update(renderer, began.elapsed().as_secs_f64());
    }
    progress.finish();
    Ok(renderer.spp() >= 1)
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
