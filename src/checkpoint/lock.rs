//! A lock that dies with its process.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::files::lock::{Claim, claim};

/// Holds a file of its own locked (flock), which the system undoes when the process ends, however it ends; the file goes with the lock.
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Locks `path`, which keeps `guarded` for this process. Fails at once where another one has it.
    pub fn take(path: PathBuf, guarded: &Path) -> Result<Self> {
        loop {
            let refused = |cause: io::Error| Error::Usage(format!("cannot lock {}: {cause}", path.display()));
            let file = File::options().create(true).append(true).open(&path).map_err(refused)?;
            match claim(&file, &path).map_err(refused)? {
                Claim::Held => return Ok(Self { path, _file: file }),
                Claim::Refused => {
                    return Err(Error::Usage(format!(
                        "{} is in use: another lumbre writes its checkpoints there; wait for it, or choose another file",
                        guarded.display()
                    )));
                }
                Claim::Void => {}
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
