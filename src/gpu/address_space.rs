//! What a limit on the process's address space (`ulimit -v`) leaves: drivers that run into it crash or hang instead of failing.

use rustix::process::{Resource, getrlimit};

use crate::error::{Bytes, Error, Result};

/// Bytes of address space that drivers take for themselves: the libraries, what compiling needs, and for each core some threads with their
/// stacks and heaps. With lavapipe on two cores a rendering took 1000 MB, and one that was given 900 MB crashed.
fn for_drivers() -> u64 {
    let cores = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    (512 << 20) + cores * (256 << 20)
}

/// Bytes that the process may still take; nothing where there is no limit, or the system does not tell.
fn left() -> Option<u64> {
    let limit = getrlimit(Resource::As).current?;
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let size = status.lines().find_map(|line| line.strip_prefix("VmSize:"))?;
    let kibibytes: u64 = size.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kibibytes << 10))
}

/// Bytes that the process may still take besides what drivers need; nothing where there is no limit.
pub(super) fn left_for_data() -> Option<u64> {
    left().map(|left| left.saturating_sub(for_drivers()))
}

/// Fails where drivers would run into the limit.
pub(super) fn check() -> Result<()> {
    let Some(left) = left().filter(|left| *left < for_drivers()) else { return Ok(()) };
    Err(Error::Device(format!(
        "the process may take {} more of address space (ulimit -v), and Vulkan's drivers need {}: raise that limit, or lift it",
        Bytes(left),
        Bytes(for_drivers())
    )))
}
