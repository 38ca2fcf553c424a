//! What each test took: a line for each in the file that `LUMBRE_TEST_TIMES` names, of which `make test` shows the slowest.

use std::cell::Cell;
use std::io::Write;
use std::time::Instant;

/// Of the test that runs on a thread: libtest gives each test a thread with its name.
struct Clock {
    started: Instant,
    /// Seconds and number of the processes that it waited for.
    children: Cell<u32>,
}

thread_local! {
    static CLOCK: Clock = Clock { started: Instant::now(), children: Cell::new(0) };
}

/// Starts the clock of the test on this thread, unless it runs: what a test does before that does not count.
pub fn start() {
    CLOCK.with(|_| ());
}

/// Starts the clock where a test starts another process, which does its work there.
pub fn start_child() {
    CLOCK.with(|clock| clock.children.set(clock.children.get() + 1));
}

impl Drop for Clock {
    /// The test is over: its name, its seconds, of these compiling and rendering in this process, pixel samples, processes.
    fn drop(&mut self) {
        let Some(path) = std::env::var_os("LUMBRE_TEST_TIMES") else { return };
        let spent = lumbre::render::spent();
        let line = format!(
            "{:.2} {:.2} {:.2} {} {} {}\n",
            self.started.elapsed().as_secs_f64(),
            spent.compile,
            spent.render,
            spent.samples,
            self.children.get(),
            std::thread::current().name().unwrap_or("?")
        );
        // One write of a short line to a file that only grows: processes may do so beside each other.
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        if let Err(error) = file.and_then(|mut file| file.write_all(line.as_bytes())) {
            eprintln!("LUMBRE_TEST_TIMES: {error}");
        }
    }
}
