//! A lock that dies with its process.

use std::fs::File;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;

use crate::error::{Error, Result};

/// Holds a file of its own locked (flock), which the system undoes when the process ends, however it ends; the file goes with the lock.
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Locks `path`, which keeps `guarded` for this process. Fails at once where another one has it.
    pub fn take(path: PathBuf, guarded: &Path) -> Result<Self> {
        loop {
            let refused =
                |cause: &dyn std::fmt::Display| Error::Usage(format!("cannot lock {}: {cause}", path.display()));
            let file = File::options().create(true).append(true).open(&path).map_err(|error| refused(&error))?;
            match flock(&file, FlockOperation::NonBlockingLockExclusive) {
                Ok(()) => {}
                Err(Errno::WOULDBLOCK) => {
                    return Err(Error::Usage(format!(
                        "{} is in use: another lumbre writes its checkpoints there; wait for it, or choose another file",
                        guarded.display()
                    )));
                }
                Err(error) => return Err(refused(&error)),
            }
            // Whoever had it before may have removed the file between the two calls: then this is a lock on nothing.
            let own = file.metadata().map_err(|error| refused(&error))?;
            if path.metadata().is_ok_and(|there| (there.dev(), there.ino()) == (own.dev(), own.ino())) {
                return Ok(Self { path, _file: file });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still locked; a failure leaves an empty file, which locks nothing.
        let _ = std::fs::remove_file(&self.path);
    }
}
