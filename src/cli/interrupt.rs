//! Interrupts: Ctrl-C, SIGTERM and SIGHUP.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::flag;

/// The exit status of a process that the second of these signals ended.
const ENDED: i32 = 130;

/// A flag that Ctrl-C, SIGTERM and SIGHUP set: what was rendered is kept. The second one ends the process at once. One that was ignored when
/// the process began stays so: `nohup` and shells do that for what is to go on without them.
pub(super) fn listen_for_interrupts() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let ignored = ignored_signals();
    for signal in [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0) {
        // In this order: the first signal finds the flag not set. Without handlers a signal ends the process, which loses the image.
        let ends = flag::register_conditional_shutdown(signal, ENDED, interrupted.clone());
        let _ = ends.and_then(|_| flag::register(signal, interrupted.clone()));
    }
    interrupted
}

/// The signals that this process ignores, bit n - 1 for signal n; none where the system does not tell.
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
