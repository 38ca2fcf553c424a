//! Progress of a rendering: a bar on a terminal, a plain line now and then elsewhere.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use lumbre::render::Renderer;

use super::Job;

/// Seconds between two lines where standard error is no terminal.
const INTERVAL: f64 = 10.0;
/// Seconds before the first of them.
const FIRST_LINE: f64 = 2.0;

pub(super) struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
    spp: u32,
    time: Option<f64>,
    next_line: f64,
}

impl Progress {
    pub fn new(quiet: bool, job: &Job) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(1000);
            if let Ok(style) = ProgressStyle::with_template("{wide_bar} {msg}") {
                bar.set_style(style);
            }
            bar
        });
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
        let line = || {
            let pixels = f64::from(renderer.settings().width) * f64::from(renderer.settings().height);
            let rate = samples * pixels / seconds.max(1e-9) / 1e6;
            format!("{samples:.1} spp, {rate:.2} Msamples/s, {left:.0} s left")
        };
        if let Some(bar) = &self.bar {
            bar.set_position((share * 1000.0) as u64);
            bar.set_message(line());
        } else if !self.quiet && seconds >= self.next_line {
            eprintln!("{}", line());
            self.next_line = seconds + INTERVAL;
        }
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
