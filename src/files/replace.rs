//! Files that are replaced only when the new one is complete.

use std::fs::{File, Permissions};
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use super::lock::{Claim, claim};
use crate::error::{Error, Result};

/// Fails if a file could not be written there, without touching what is there now.
pub fn check_writable(path: &Path) -> Result<()> {
    let refused = |cause: &str| Error::Usage(format!("cannot write {}: {cause}", path.display()));
    if path.is_dir() {
        return Err(refused("it is a folder"));
    }
    match path.parent() {
        Some(folder) if folder != Path::new("") && !folder.is_dir() => {
            Err(refused(&format!("there is no folder {}", folder.display())))
        }
        _ => temporary_beside(path).map(|_| ()).map_err(|error| Error::Usage(error.to_string())),
    }
}

/// Writes a file beside its final place and moves it there once it is complete.
pub fn replace_file(path: &Path, write: impl FnOnce(&mut dyn WriteSeek) -> Result<(), String>) -> Result<()> {
    let mut file = temporary_beside(path)?;
    {
        let mut buffered = std::io::BufWriter::new(file.as_file_mut());
        write(&mut buffered).map_err(|cause| Error::write(path, cause))?;
        buffered.flush().map_err(|error| Error::write(path, error))?;
    }
    file.as_file().sync_all().map_err(|error| Error::write(path, error))?;
    file.persist(path).map_err(|error| Error::write(path, error.error))?;
    Ok(())
}

/// What a new file is written through: encoders of images seek in it.
pub trait WriteSeek: Write + Seek {}
impl<T: Write + Seek> WriteSeek for T {}

/// The folder that a file lies in.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// What the names of files begin with that are not complete yet, and how many characters follow.
const PARTIAL: &str = ".lumbre-";
const PARTIAL_CHARACTERS: usize = 6;

/// A file that is locked for as long as this process writes it: the system undoes that when the process ends, however it ends, which tells
/// whose files nobody will complete.
fn temporary_beside(path: &Path) -> Result<tempfile::NamedTempFile> {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder_of(path);
    remove_remains(&folder);
    loop {
        let file = tempfile::Builder::new()
            .prefix(PARTIAL)
            .rand_bytes(PARTIAL_CHARACTERS)
            .permissions(Permissions::from_mode(0o666)) // less what the umask takes away
            .tempfile_in(&folder)
            .map_err(|error| Error::write(path, error.kind()))?;
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
