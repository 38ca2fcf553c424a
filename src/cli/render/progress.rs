//! Progress of a rendering: a bar on a terminal, a plain line now and then elsewhere.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use indicatif::ProgressBar;

use lumbre::render::{Building, Renderer};

use super::job::Job;
use crate::cli::output::{bar_on_terminal, say};

/// Seconds between two lines where standard error is no terminal.
const INTERVAL: f64 = 10.0;
/// Seconds before the first of them.
const FIRST_LINE: f64 = 2.0;
/// Seconds that building a scene may take before a bar appears: most scenes are done by then.
const FIRST_BAR: f64 = 0.5;

/// Progress of what comes before rendering: the acceleration structure, the upload, the kernels.
pub(super) struct BuildProgress {
    quiet: bool,
    started: Instant,
    shown: Mutex<Shown>,
}

/// What the user sees of it.
struct Shown {
    bar: Option<ProgressBar>,
    next_line: f64,
}

impl BuildProgress {
    pub fn new(quiet: bool) -> Self {
        Self { quiet, started: Instant::now(), shown: Mutex::new(Shown { bar: None, next_line: FIRST_LINE }) }
    }

    /// Takes note, from any thread.
    pub fn update(&self, building: Building) {
        let seconds = self.started.elapsed().as_secs_f64();
        if self.quiet || seconds < FIRST_BAR {
            return;
        }
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.bar.is_none() {
            shown.bar = bar_on_terminal();
        }
        if let Some(bar) = &shown.bar {
            bar.set_position((building.share.unwrap_or(0.0) * 1000.0) as u64);
            bar.set_message(building.doing);
        } else if seconds >= shown.next_line {
            let share = building.share.map_or(String::new(), |share| format!(", {:.0} %", 100.0 * share));
            say!("{}{share}", building.doing);
            shown.next_line = seconds + INTERVAL;
        }
    }

    pub fn finish(self) {
        if let Some(bar) = self.shown.into_inner().unwrap_or_else(PoisonError::into_inner).bar {
            bar.finish_and_clear();
        }
    }
}

pub(super) struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
    spp: u32,
    time: Option<f64>,
    next_line: f64,
}

impl Progress {
    pub fn new(quiet: bool, job: &Job) -> Self {
        let bar = if quiet { None } else { bar_on_terminal() };
        Self { bar, quiet, spp: job.spp, time: job.time, next_line: FIRST_LINE }
    }

    pub fn update(&mut self, renderer: &Renderer, seconds: f64) {
        let samples = renderer.progress();
        let share = match self.time {
            Some(limit) => seconds / limit,
            None => samples / f64::from(self.spp),
        }
        .min(1.0);
        let left = if share > 0.0 { seconds / share - seconds } else { 0.0 };
        let start = renderer.start();
        let line = || {
            if start < 1.0 {
                return format!("{:.0} % of the paths that chains begin with", 100.0 * start);
            }
            let pixels = f64::from(renderer.settings().width) * f64::from(renderer.settings().height);
            let rate = samples * pixels / seconds.max(1e-9) / 1e6;
            format!("{samples:.1} spp, {rate:.2} Msamples/s, {left:.0} s left")
        };
        if let Some(bar) = &self.bar {
            bar.set_position((share * 1000.0) as u64);
            bar.set_message(line());
        } else if !self.quiet && seconds >= self.next_line {
            say!("{}", line());
            self.next_line = seconds + INTERVAL;
        }
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
