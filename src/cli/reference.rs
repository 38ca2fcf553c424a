//! `lumbre reference`: an image that stands for the truth, with what is known of it; or a check of one.

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Instant;

use clap::Args;
use indicatif::ProgressBar;

use lumbre::error::{Error, Result};
use lumbre::files::check_writable;
use lumbre::image::{Format, check_format};
use lumbre::reference::{self, Budget, Certificate, Request, Step, Truth};
use lumbre::render::{Settings, Technique};
use lumbre::techniques::Solves;

use super::args::{Depth, DeviceArgs, SceneArgs, parse_depth, parse_positive, parse_size};
use super::interrupt::listen_for_interrupts;
use super::output::{
    bar_on_terminal, check_apart, check_json, destination, print, print_warnings, say, takes_standard_output,
    write_json,
};

/// Seconds between two lines of progress where standard error is no terminal.
const INTERVAL: f64 = 10.0;

#[derive(Args)]
pub(super) struct ReferenceArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// The reference, an EXR file; its header has the certificate
    #[arg(short = 'o', long, value_name = "FILE", required_unless_present = "check")]
    output: Option<PathBuf>,

    /// Hold this image against an independent rendering instead of making one; exit with status 1 where they differ beyond noise
    #[arg(long, value_name = "FILE")]
    check: Option<PathBuf>,

    /// Seconds in all, kernels and the witness included
    #[arg(short = 't', long, value_name = "SECONDS", default_value_t = 60.0, value_parser = parse_positive, allow_negative_numbers = true)]
    time: f64,

    /// Size of the image in pixels; by default the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// Longest path in segments (1: emission only, 2: adds direct light); -1 is no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = parse_depth)]
    max_depth: Option<Depth>,

    /// Camera by name or number; the scene's first one by default
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,

    /// Which of several independent references
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=63), allow_negative_numbers = true)]
    seed: u32,

    /// Write the certificate as JSON ('-' is standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    #[command(flatten)]
    device: DeviceArgs,

    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(args: &ReferenceArgs) -> Result<()> {
    let interrupted = listen_for_interrupts();
    let output = args.output.as_deref().map(destination);
    if let Some(path) = &output {
        check_format(path, "a reference", Format::Exr)?;
        check_writable(path)?;
    }
    check_json(args.json.as_deref())?;
    check_apart(args.output.iter().chain(&args.json).map(PathBuf::as_path))?;
    let scene = args.scene.load()?;
    if !args.quiet {
        print_warnings(&scene);
    }
    let gpu = args.device.open()?;
    let mut settings = Settings::new(&scene, Technique::parse("path")?, gpu.backend(None)?);
    settings.set_camera(&scene, args.camera.as_deref())?;
    if let Some((width, height)) = args.size {
        (settings.width, settings.height) = (width, height);
    }
    if let Some(Depth(depth)) = args.max_depth {
        settings.max_depth = depth;
    }
    let given = match &args.check {
        Some(path) => Some(reference::read(path, settings.width, settings.height)?),
        None => None,
    };
    let request = Request {
        gpu: &gpu,
        scene: &scene,
        settings: &settings,
        solves: Solves::Everything,
        budget: Budget::Seconds(args.time),
        seed: args.seed,
        parts: None,
    };
    let mut progress = Progress::new(args.quiet);
    let mut hear = |step: Step| {
        if interrupted.load(Ordering::Relaxed) {
            return Err(Error::Interrupted(String::from("nothing was rendered that is worth keeping")));
        }
        progress.hear(&step);
        Ok(())
    };
    let truth = match (&given, &output) {
        (Some(given), output) => {
            let checked = reference::check(&request, given, &mut hear)?;
            if let Some(path) = output {
                reference::write(path, &checked)?;
            }
            checked
        }
        (None, Some(path)) => reference::resume(&request, path, &mut hear)?,
        (None, None) => return Err(Error::Usage(String::from("give a file for the reference with -o"))),
    };
    progress.finish();
    let certificate = truth.certificate.as_ref();
    if let (Some(path), Some(certificate)) = (&args.json, certificate) {
        write_json(path, certificate)?;
    }
    let is_silent = args.quiet || args.json.iter().chain(&args.output).any(|path| takes_standard_output(path));
    if let (false, Some(certificate)) = (is_silent, certificate) {
        print_certificate(certificate);
    }
    if let (false, Some(path)) = (is_silent, &args.output) {
        print(&format!("wrote      {}", path.display()));
    }
    DeviceArgs::report_validation(&gpu)?;
    refuse_what_differs(args, &truth)
}

/// An image that was to be checked and differs fails the command.
fn refuse_what_differs(args: &ReferenceArgs, truth: &Truth) -> Result<()> {
    let witness = truth.certificate.as_ref().and_then(|certificate| certificate.witness.as_ref());
    match (&args.check, witness) {
        (Some(path), Some(witness)) if !witness.differences.is_empty() => Err(Error::Verification(format!(
            "{} and {}, {}",
            path.display(),
            witness.technique,
            witness.differences[0].describe()
        ))),
        _ => Ok(()),
    }
}

/// What is said of a step; nothing of mere progress.
pub(super) fn told(step: &Step) -> Option<String> {
    match step {
        Step::Tries(technique) => Some(format!("reference: trying {technique}")),
        Step::Makes(technique, seconds) => Some(format!("reference by {technique}, {seconds:.1} s")),
        Step::Checks(technique, seconds) => Some(format!("checked by {technique}, {seconds:.1} s")),
        Step::Asks(technique, why) => Some(format!("{why}; asking {technique}")),
        Step::Share(_) => None,
    }
}

/// What is known of a reference, on the terminal.
fn print_certificate(certificate: &Certificate) {
    for pilot in &certificate.pilots {
        let chance = pilot
            .by_chance
            .as_ref()
            .map_or(String::new(), |what| format!(", finds {what} only with rare, bright samples"));
        let lacking = if pilot.lacking > 0.0 { format!(", lacks {:.1e}", pilot.lacking) } else { String::new() };
        print(&format!("tried      {}: relMSE x s {:.2e}{lacking}{chance}", pilot.technique, pilot.noise));
    }
    for maker in &certificate.makers {
        print(&format!(
            "made by    {}, {:.0} spp, {:.1} s, {:.0} % of the image",
            maker.technique,
            maker.spp,
            maker.seconds,
            100.0 * maker.share
        ));
    }
    print(&format!("own error  {}", certificate.error_in_words()));
    let error = &certificate.error;
    let index = error.tail_index.map_or(String::new(), |index| format!(", tail index {index:.1}"));
    print(&format!("           {:.0} % of it by a thousandth of the values{index}", 100.0 * error.largest_share));
    for witness in certificate.witness.iter().chain(&certificate.others) {
        let verdict = if witness.differences.is_empty() { "no difference" } else { "differs" };
        print(&format!(
            "witness    {}, {:.0} spp, {:.1} s: {verdict} in {} tests; half of the tiles of 16x16 show {:.2} %",
            witness.technique,
            witness.spp,
            witness.seconds,
            witness.tests,
            100.0 * witness.detectable
        ));
        for difference in &witness.differences {
            print(&format!("           {}", difference.describe()));
        }
    }
    let verdict = certificate.doubt().map_or(String::from("confirmed"), |doubt| format!("not confirmed: {doubt}"));
    print(&format!("verdict    {verdict}"));
    print(&format!("seconds    {:.1}, of these {:.1} to choose", certificate.seconds, certificate.pilot_seconds));
}

/// A bar on a terminal, a line now and then elsewhere.
struct Progress {
    quiet: bool,
    bar: Option<ProgressBar>,
    last: Instant,
}

impl Progress {
    fn new(quiet: bool) -> Self {
        Self { quiet, bar: if quiet { None } else { bar_on_terminal() }, last: Instant::now() }
    }

    fn hear(&mut self, step: &Step) {
        if let (Step::Share(share), Some(bar)) = (step, &self.bar) {
            bar.set_position((share * 1000.0) as u64);
        }
        if self.quiet {
            return;
        }
        if let Some(text) = told(step) {
            match &self.bar {
                Some(bar) => bar.println(text),
                None => say!("{text}"),
            }
        } else if let (Step::Share(share), None) = (step, &self.bar)
            && self.last.elapsed().as_secs_f64() > INTERVAL
        {
            say!("{:.0} %", 100.0 * share);
            self.last = Instant::now();
        }
    }

    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
