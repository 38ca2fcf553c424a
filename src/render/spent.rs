//! What renderers and probes of a thread have spent: where a program's time goes that makes many of them, as the tests are.

use std::cell::Cell;

/// Seconds and pixel samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spent {
    /// Seconds of making pipelines, and of running each for the first time, which is when CPU devices compile.
    pub compile: f64,
    /// Seconds of all other work on the device.
    pub render: f64,
    /// Samples of pixels.
    pub samples: u64,
}

thread_local! {
    static SPENT: Cell<Spent> = const { Cell::new(Spent { compile: 0.0, render: 0.0, samples: 0 }) };
}

/// The total of all that this thread has had made and rendered.
pub fn spent() -> Spent {
    SPENT.get()
}

/// Adds seconds of compiling.
pub(super) fn compiled(seconds: f64) {
    let spent = SPENT.get();
    SPENT.set(Spent { compile: spent.compile + seconds, ..spent });
}

/// Adds seconds of rendering, and the samples that were taken.
pub(super) fn rendered(seconds: f64, samples: u64) {
    let spent = SPENT.get();
    SPENT.set(Spent { render: spent.render + seconds, samples: spent.samples + samples, ..spent });
}
