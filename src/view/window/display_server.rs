//! The X11 or Wayland server that shows the window: whether there is one, and what is left when it goes away.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind, set_hook, take_hook};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use winit::error::EventLoopError;

use crate::error::{Error, Result};

/// Why no window can be opened.
pub(super) fn refusal(error: EventLoopError) -> Error {
    let why = match &error {
        EventLoopError::Os(_) if !is_named() => {
            String::from("there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)")
        }
        // Before its last part are places in the library's code.
        other => other.to_string().rsplit(": ").next().unwrap_or_default().to_owned(),
    };
    Error::Device(format!("no window can be opened: {why}; `lumbre render` needs none"))
}

/// Whether the environment names a display.
fn is_named() -> bool {
    ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn gone() -> Error {
    Error::Device(String::from("the display went away, or destroyed the window"))
}

/// Runs the event loop. Where the server has ended, or has destroyed the window, behind its back, winit panics (X11) or returns a status of its own
/// (Wayland): that is an error here. Any other panic goes on.
pub(super) fn survive(run: impl FnOnce() -> std::result::Result<(), EventLoopError>) -> Result<()> {
    type Hook = dyn Fn(&std::panic::PanicHookInfo<'_>) + Send + Sync;
    let previous: Arc<Hook> = Arc::from(take_hook());
    let own = std::thread::current().id();
    let of_winit = Arc::new(AtomicBool::new(false));
    let (told, otherwise) = (of_winit.clone(), previous.clone());
    set_hook(Box::new(move |info| {
        let is_winit = info.location().is_some_and(|place| place.file().contains("winit"));
        if is_winit && std::thread::current().id() == own {
            told.store(true, Ordering::Relaxed);
        } else {
            otherwise(info);
        }
    }));
    let ran = catch_unwind(AssertUnwindSafe(run));
    set_hook(Box::new(move |info| previous(info)));
    match ran {
        Ok(Ok(())) => Ok(()),
        Ok(Err(EventLoopError::ExitFailure(_))) => Err(gone()),
        Ok(Err(error)) => Err(refusal(error)),
        Err(_) if of_winit.load(Ordering::Relaxed) => Err(gone()),
        Err(panic) => resume_unwind(panic),
    }
}
