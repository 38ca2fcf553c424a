//! What the fuzz targets share: bytes go to a loader by way of a file, as `lumbre render` reads it, and what comes of it is
//! held against the rules of `tests/common/hostile.rs`, under the same bound on memory.

#[path = "../../tests/common/hostile.rs"]
mod hostile;

use std::cell::OnceCell;
use std::path::PathBuf;

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
        let folder = folder.get_or_init(|| {
            // In memory, where there is such a place: a file is written for each input.
            let base = Some(PathBuf::from("/dev/shm")).filter(|base| base.is_dir());
            let base = base.unwrap_or_else(std::env::temp_dir);
            Folder::new(base.join(format!("lumbre-fuzz-{}", std::process::id())))
        });
        folder.check(format, bytes);
    });
}
