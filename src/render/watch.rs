//! Telling whoever waits how far the building of a scene is.

use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// How far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Building {
    /// What is being done.
    pub doing: &'static str,
    /// The share of it that is done, 0 to 1, where that is known.
    pub share: Option<f64>,
}

/// Is told now and then, from any thread, how far the building of a scene is.
pub type Watch<'a> = &'a (dyn Fn(Building) + Sync);

/// Time between two words on work that only a driver knows the end of.
const WORD: Duration = Duration::from_millis(100);

impl Building {
    /// So many primitives have found their place in the acceleration structure.
    pub(super) fn tree(done: usize, of: usize) -> Self {
        Self { doing: "building the acceleration structure", share: Some(done as f64 / of.max(1) as f64) }
    }
}

/// Has a driver compile kernels, and tells so for as long as that takes.
pub(super) fn while_compiling<T>(watch: Watch, compile: impl FnOnce() -> T) -> T {
    struct Done<'a>(&'a Mutex<bool>, &'a Condvar);
    impl Drop for Done<'_> {
        fn drop(&mut self) {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
            self.1.notify_all();
        }
    }
    let (done, changed) = (Mutex::new(false), Condvar::new());
    std::thread::scope(|scope| {
        // Dropped however the work ends, so that the other thread ends, too.
        let _done = Done(&done, &changed);
        scope.spawn(|| {
            let mut is_done = done.lock().unwrap_or_else(PoisonError::into_inner);
            while !*is_done {
                watch(Building { doing: "compiling kernels", share: None });
                is_done = changed.wait_timeout(is_done, WORD).unwrap_or_else(PoisonError::into_inner).0;
            }
        });
        compile()
    })
}
