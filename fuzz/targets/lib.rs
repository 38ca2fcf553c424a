//! What the fuzz targets share: bytes go to a loader by way of a file, as `lumbre render` reads it, and what comes of it is
//! held against the rules of `tests/common/hostile.rs`, under the same bound on memory.

#[path = "../../tests/common/hostile.rs"]
mod hostile;

use std::cell::OnceCell;

pub use hostile::Format;
use hostile::{Bounded, Folder};

#[global_allocator]
static ALLOCATOR: Bounded = Bounded;

/// Runs one input; a broken rule is a panic, which libFuzzer keeps as a crash.
pub fn run(format: Format, bytes: &[u8]) {
    thread_local! {
        static FOLDER: OnceCell<Folder> = const { OnceCell::new() };
    }
    FOLDER.with(|folder| {
        folder.get_or_init(|| Folder::new("lumbre-fuzz")).check(format, bytes);
    });
}
