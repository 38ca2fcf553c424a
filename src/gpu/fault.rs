//! Faults on demand: what a driver does once in a blue moon, for tests of what the program does then.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Result};

/// The variable that asks for one: `device-lost@N` at the N-th run of kernels, from which on the device stays lost;
/// `out-of-memory@N` at the N-th buffer.
const VARIABLE: &str = "LUMBRE_FAULT";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    DeviceLost,
    OutOfMemory,
}

/// A fault to come, or none.
#[derive(Debug, Default)]
pub(super) struct Fault {
    asked: Option<(Kind, u64)>,
    /// Runs, or buffers, so far.
    seen: AtomicU64,
}

impl Fault {
    /// What the environment asks for.
    pub fn from_environment() -> Result<Self> {
        std::env::var(VARIABLE).map_or(Ok(Self::default()), |text| Self::parse(&text))
    }

    fn parse(text: &str) -> Result<Self> {
        let parts =
            text.split_once('@').and_then(|(kind, at)| Some((kind, at.parse::<u64>().ok().filter(|at| *at > 0)?)));
        let asked = match parts {
            Some(("device-lost", at)) => (Kind::DeviceLost, at),
            Some(("out-of-memory", at)) => (Kind::OutOfMemory, at),
            _ => {
                return Err(Error::Usage(format!(
                    "{VARIABLE}={text}: valid are device-lost@N and out-of-memory@N, with N from 1"
                )));
            }
        };
        Ok(Self { asked: Some(asked), seen: AtomicU64::new(0) })
    }

    /// Counts a run of kernels; whether the device is lost in it, or was before.
    pub fn loses_device_at_run(&self) -> bool {
        match self.asked {
            Some((Kind::DeviceLost, at)) => self.seen.fetch_add(1, Ordering::Relaxed) + 1 >= at,
            _ => false,
        }
    }

    /// Whether the device was lost before.
    pub fn has_lost_device(&self) -> bool {
        matches!(self.asked, Some((Kind::DeviceLost, at)) if self.seen.load(Ordering::Relaxed) >= at)
    }

    /// Counts a buffer; whether there is no room for it.
    pub fn refuses_buffer(&self) -> bool {
        match self.asked {
            Some((Kind::OutOfMemory, at)) => self.seen.fetch_add(1, Ordering::Relaxed) + 1 == at,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_strikes_when_asked() {
        let lost = Fault::parse("device-lost@2").unwrap();
        assert_eq!([false, true, true], [(); 3].map(|()| lost.loses_device_at_run()));
        assert!(lost.has_lost_device() && !lost.refuses_buffer());
        let full = Fault::parse("out-of-memory@2").unwrap();
        assert_eq!([false, true, false], [(); 3].map(|()| full.refuses_buffer()));
        for wrong in ["", "device-lost", "device-lost@0", "fire@1", "out-of-memory@x"] {
            assert!(Fault::parse(wrong).unwrap_err().to_string().contains("valid are device-lost@N"), "{wrong}");
        }
    }
}
