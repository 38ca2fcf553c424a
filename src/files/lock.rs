//! Locks of files (flock) that die with their process, however it ends.

use std::fs::File;
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;

/// What became of asking for a file's lock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Claim {
    /// It is this process's until the file is closed.
    Held,
    /// Another one has it.
    Refused,
    /// It is this process's, but another one has removed or replaced the file since it was opened: a lock on nothing.
    Void,
}

/// Asks for the lock of `file`, which was opened at `path`, without waiting for it. Fails where files cannot be locked.
pub(crate) fn claim(file: &File, path: &Path) -> io::Result<Claim> {
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Ok(()) => {}
        Err(Errno::WOULDBLOCK) => return Ok(Claim::Refused),
        Err(error) => return Err(error.into()),
    }
    let own = file.metadata()?;
    let is_there = path.metadata().is_ok_and(|there| (there.dev(), there.ino()) == (own.dev(), own.ino()));
    Ok(if is_there { Claim::Held } else { Claim::Void })
}
