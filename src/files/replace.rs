//! Files that are replaced only when the new one is complete.

use std::fs::{File, Metadata, Permissions};
use std::io::{self, Seek, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;

use super::destination::{Destination, destination, folder_of, is_writable};
use super::lock::{Claim, claim};
use crate::error::{Error, Result};

/// Bytes that are kept in memory on their way to a device or a pipe; more go by way of a file.
const IN_MEMORY: usize = 64 << 20;

/// Fails if a file could not be written there, without touching what is there now.
pub fn check_writable(path: &Path) -> Result<()> {
    let refused = |cause: &dyn std::fmt::Display| Error::Usage(format!("cannot write {}: {cause}", path.display()));
    match destination(path).map_err(|error| refused(&error))? {
        Destination::Stream(stream) => stream.check().map_err(|error| refused(&error)),
        Destination::File { path: file, there } => {
            let folder = folder_of(&file);
            if !folder.is_dir() {
                return Err(refused(&format!("there is no folder {}", folder.display())));
            }
            match temporary_beside(&file) {
                Ok(_) => Ok(()),
                Err(error) if takes_no_new_file(&error) && there.is_some() && is_writable(&file).is_ok() => Ok(()),
                Err(error) => Err(refused(&error.kind())),
            }
        }
    }
}

/// Writes a file beside its final place and moves it there once it is complete. A symbolic link stays and leads to the new file, which has
/// the mode and, where this process may give files away, the owner of the one before. Devices and pipes are written to once all is there,
/// and so is a file in a folder that takes no new ones.
pub fn replace_file(path: &Path, write: impl FnOnce(&mut dyn WriteSeek) -> Result<(), String>) -> Result<()> {
    let failed = |error: io::Error| Error::write(path, error);
    let (file, there) = match destination(path).map_err(failed)? {
        Destination::Stream(stream) => return pass_on(path, write, || stream.open()),
        Destination::File { path, there } => (path, there),
    };
    let mut partial = match temporary_beside(&file) {
        Ok(partial) => partial,
        Err(error) if takes_no_new_file(&error) && there.is_some() && is_writable(&file).is_ok() => {
            return pass_on(path, write, || File::options().write(true).truncate(true).open(&file));
        }
        Err(error) => return Err(Error::write(path, error.kind())),
    };
    {
        let mut buffered = io::BufWriter::new(partial.as_file_mut());
        write(&mut buffered).map_err(|cause| Error::write(path, cause))?;
        buffered.flush().map_err(failed)?;
    }
    if let Some(there) = there {
        inherit(partial.as_file(), &there).map_err(failed)?;
    }
    partial.as_file().sync_all().map_err(failed)?;
    partial.persist(&file).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Replaces a file by one of these bytes, as [`replace_file`] does.
pub fn replace_by(path: &Path, bytes: &[u8]) -> Result<()> {
    replace_file(path, |file| file.write_all(bytes).map_err(|error| error.to_string()))
}

/// Makes all of a file, then opens what it is to go to and copies it there.
fn pass_on(
    path: &Path,
    write: impl FnOnce(&mut dyn WriteSeek) -> Result<(), String>,
    open: impl FnOnce() -> io::Result<File>,
) -> Result<()> {
    let failed = |error: io::Error| Error::write(path, error);
    let mut whole = tempfile::SpooledTempFile::new(IN_MEMORY);
    write(&mut whole).map_err(|cause| Error::write(path, cause))?;
    whole.rewind().map_err(failed)?;
    io::stdout().flush().map_err(failed)?;
    let mut to = open().map_err(failed)?;
    io::copy(&mut whole, &mut to).map_err(failed)?;
    to.flush().map_err(failed)
}

/// Gives a new file the mode and, where this process may, the owner and the group of the one whose place it takes.
pub(crate) fn inherit(new: &File, old: &Metadata) -> io::Result<()> {
    let own = new.metadata()?;
    if (own.uid(), own.gid()) != (old.uid(), old.gid()) {
        let whole = std::os::unix::fs::fchown(new, Some(old.uid()), Some(old.gid()));
        // Who may not give files away may still be in the group.
        let _ = whole.or_else(|_| std::os::unix::fs::fchown(new, None, Some(old.gid())));
    }
    new.set_permissions(Permissions::from_mode(old.mode() & 0o777))
}

/// Whether the folder takes no new files of this user's. Where there is no room for one, what is there stays as it is.
fn takes_no_new_file(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem)
}

/// What a new file is written through: encoders of images seek in it.
pub trait WriteSeek: Write + Seek {}
impl<T: Write + Seek> WriteSeek for T {}

/// What the names of files begin with that are not complete yet, and how many characters follow.
const PARTIAL: &str = ".lumbre-partial-";
const PARTIAL_CHARACTERS: usize = 6;

/// A file that is locked for as long as this process writes it: the system undoes that when the process ends, however it ends, which tells
/// whose files nobody will complete.
fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = folder_of(path);
    remove_remains(&folder);
    loop {
        let file = tempfile::Builder::new()
            .prefix(PARTIAL)
            .rand_bytes(PARTIAL_CHARACTERS)
            .permissions(Permissions::from_mode(0o666)) // less what the umask takes away
            .tempfile_in(&folder)?;
        // Between these two another process may have taken it for remains. Where nothing can be locked, nothing is removed either.
        if claim(file.as_file(), file.path()).map_or(true, |claim| claim == Claim::Held) {
            return Ok(file);
        }
    }
}

/// Removes what processes left that were killed while they wrote. That it cannot be removed is no reason not to write.
fn remove_remains(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let rest = name.to_str().and_then(|name| name.strip_prefix(PARTIAL));
        if rest.is_none_or(|rest| rest.len() != PARTIAL_CHARACTERS)
            || !entry.file_type().is_ok_and(|kind| kind.is_file())
        {
            continue;
        }
        let Ok(file) = File::options().append(true).open(entry.path()) else { continue };
        if claim(&file, &entry.path()).is_ok_and(|claim| claim == Claim::Held) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
