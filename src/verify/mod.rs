//! The accuracy suite on the user's own device: `lumbre verify`.
//!
//! Each row of [`CASES`] measures figures through the shaders that render, on one backend, and holds each against its bound. A row that
//! finds its bound broken says where it was worst, and the suite goes on. Adding a row is one entry in the table and one function.

mod agreement;
mod balance;
mod brute_force;
mod bsdf;
pub mod comparison;
mod defined_paths;
mod delta;
mod draws;
mod emitters;
pub mod expectations;
pub mod families;
mod figure;
mod formulas;
mod furnaces;
mod geometry;
mod leaving;
mod outlines;
mod path_weights;
mod placed;
mod room;
mod run;
pub mod sampling;
pub mod scattering;
mod sums;
mod table;
mod toy;
mod weights;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use serde::Serialize;

use crate::error::{Error, Result, one_of};
use crate::gpu::Gpu;
use crate::layout::backend::{BACKENDS, Backend};

pub use figure::{Figure, Verdict};
pub use run::{Effort, Run};
pub use table::CASES;

/// What a row is measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    /// Every backend: it traces rays.
    EachBackend,
    /// One of them: what it asks traces none.
    Once,
}

/// One row of the suite.
pub struct Case {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it tests, in one line.
    pub tests: &'static str,
    /// The bound, in words.
    pub bound: &'static str,
    /// Where the expected value comes from.
    pub source: &'static str,
    /// What it is measured on.
    pub on: On,
    /// What measures it. It fails only where the device does: a broken bound is a figure.
    pub measure: fn(&mut Run) -> Result<()>,
}

/// What one row came to on one backend.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The row's name.
    pub case: &'static str,
    /// What it was measured on.
    pub backend: &'static str,
    /// Every figure with its bound.
    pub figures: Vec<Figure>,
    /// Files that it left.
    pub files: Vec<String>,
    /// How long it took.
    pub seconds: f64,
}

impl Outcome {
    /// The worst verdict of its figures.
    pub fn verdict(&self) -> Verdict {
        self.figures.iter().map(|figure| figure.verdict).max().unwrap_or(Verdict::Fail)
    }
}

/// The row of that name.
pub fn find(name: &str) -> Result<&'static Case> {
    CASES.iter().find(|case| case.name == name).ok_or_else(|| {
        Error::Usage(format!("no case '{name}': valid are {}", one_of(CASES.iter().map(|case| case.name))))
    })
}

/// The backends that a device has.
pub fn backends_of(gpu: &Gpu) -> Vec<Backend> {
    BACKENDS.iter().map(|row| row.backend).filter(|backend| gpu.survey().refusal(*backend).is_none()).collect()
}

/// Those of `backends` that a row is measured on.
pub fn measured_on(case: &Case, backends: &[Backend]) -> Vec<Backend> {
    match case.on {
        On::EachBackend => backends.to_vec(),
        On::Once => {
            backends.iter().copied().find(|b| *b == Backend::Bvh).or(backends.first().copied()).into_iter().collect()
        }
    }
}

/// Measures a row on a backend. Its images go to `folder`, where one is given.
pub fn measure(gpu: &Gpu, case: &Case, backend: Backend, effort: Effort, folder: Option<&Path>) -> Result<Outcome> {
    let started = Instant::now();
    let mut run = Run::new(gpu, case.name, backend, effort, folder);
    (case.measure)(&mut run)?;
    let (figures, files) = run.finish();
    Ok(Outcome { case: case.name, backend: backend.name(), figures, files, seconds: started.elapsed().as_secs_f64() })
}

/// How many rows are measured at a time: drivers make kernels on one thread, and renderings seldom fill all others.
const WORKERS: usize = 2;

/// Measures every row of `cases` on those of `backends` that it is measured on, several at a time on a device of their own each, which `open`
/// opens; `seen` is given what they came to in their order, as soon as it is known. Ends at the first failure of a device, of `check` after a
/// row, or of `seen`.
pub fn measure_all(
    open: impl Fn() -> Result<Gpu> + Sync,
    check: impl Fn(&Gpu) -> Result<()> + Sync,
    cases: &[&'static Case],
    backends: &[Backend],
    effort: Effort,
    folder: Option<&Path>,
    mut seen: impl FnMut(Outcome) -> Result<()>,
) -> Result<()> {
    let rows = cases.iter().flat_map(|case| measured_on(case, backends).into_iter().map(|backend| (*case, backend)));
    let jobs: Vec<(usize, (&Case, Backend))> = rows.enumerate().collect();
    let next = AtomicUsize::new(0);
    let (sender, receiver) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..WORKERS.min(jobs.len()) {
            let (sender, next, jobs, open, check) = (sender.clone(), &next, &jobs, &open, &check);
            scope.spawn(move || {
                let mut gpu: Option<Gpu> = None;
                while let Some((index, (case, backend))) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let outcome = gpu.take().map_or_else(open, Ok).and_then(|opened| {
                        let outcome = measure(&opened, case, *backend, effort, folder)?;
                        check(&opened)?;
                        gpu = Some(opened);
                        Ok(outcome)
                    });
                    let failed = outcome.is_err();
                    // Nobody listens any more where an earlier one failed.
                    if sender.send((*index, outcome)).is_err() || failed {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let mut waiting: Vec<Option<Result<Outcome>>> = jobs.iter().map(|_| None).collect();
        let mut told = 0;
        for (index, outcome) in receiver {
            waiting[index] = Some(outcome);
            while let Some(outcome) = waiting.get_mut(told).and_then(Option::take) {
                seen(outcome?)?;
                told += 1;
            }
        }
        Ok(())
    })
}
