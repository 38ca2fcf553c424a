//! A checkpoint's file, the one before it, and which of both is to be trusted.

use std::ffi::OsString;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::format::{self, Header, Save};
use super::identity::Identity;
use super::lock::Lock;
use crate::error::{Error, Result};
use crate::files::{STANDARD_INPUT, check_promise, check_writable, file_behind, folder_of, inherit};
use crate::render::{Renderer, SavedFilm};

/// The checkpoints of one rendering: `FILE`, and as `FILE.previous` the one before it. While one is written it is `FILE.partial`; and
/// `FILE.lock` keeps other processes away for as long as this lives. Where the name is that of a symbolic link, `FILE` is what it leads to.
pub struct Checkpoints {
    path: PathBuf,
    /// Whether `path` may take the place of the one before it: what was found damaged must not push out a good one.
    is_good: bool,
    _lock: Lock,
}

/// A checkpoint that can be gone on from.
#[derive(Clone, Debug)]
pub struct Found {
    /// What it tells.
    pub header: Header,
    /// Where it lies.
    pub path: PathBuf,
    /// Why it is not the newest one.
    pub warning: Option<String>,
}

impl Checkpoints {
    /// Takes hold of `path`. Fails where no file can be made beside it, and where another process has it.
    pub fn open(path: &Path) -> Result<Self> {
        check_name(path)?;
        let refused = |cause| Error::Usage(format!("cannot write {}: {cause}", path.display()));
        let path = file_behind(path).map_err(refused)?;
        check_writable(&path)?;
        let lock = Lock::take(beside(&path, ".lock"), &path)?;
        Ok(Self { path, is_good: true, _lock: lock })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The checkpoint to go on from: the newest one that is whole. Nothing where there is no file. Fails where files are there and none
    /// is whole, and where the newest one that is belongs to another rendering.
    pub fn find(&mut self, asked: &Identity) -> Result<Option<Found>> {
        let mut wrong: Vec<String> = Vec::new();
        for path in [self.path.clone(), beside(&self.path, ".previous")] {
            if !path.try_exists().unwrap_or(true) {
                continue;
            }
            match format::read_header(&path) {
                Err(cause) => wrong.push(format!("{}: {cause}", path.display())),
                Ok(header) => {
                    if let Some(differs) = header.identity.differs(asked) {
                        return Err(Error::Usage(format!(
                            "{} is of another rendering; what differs is {differs}. Without --resume it begins anew",
                            path.display()
                        )));
                    }
                    self.is_good = path == self.path || !self.path.exists();
                    let warning = (!wrong.is_empty())
                        .then(|| format!("{}; going on from {}, the one before it", wrong.join("; "), path.display()));
                    return Ok(Some(Found { header, path, warning }));
                }
            }
        }
        if wrong.is_empty() {
            return Ok(None);
        }
        Err(Error::Usage(format!("no checkpoint to go on from: {}. Without --resume it begins anew", wrong.join("; "))))
    }

    /// What the file holds, whatever it belongs to; nothing where there is none, or none that is whole.
    pub fn peek(&self) -> Option<Header> {
        format::read_header(&self.path).ok()
    }

    /// Gives a renderer the state that was found.
    pub fn restore(&self, found: &Found, renderer: &mut Renderer) -> Result<()> {
        format::restore(&found.path, renderer)
    }

    /// Writes a checkpoint of a rendering.
    pub fn save(&mut self, header: &Header, renderer: &mut Renderer) -> Result<()> {
        self.write(header, &mut |path, to| renderer.save(path, to))
    }

    /// Writes a checkpoint of a film with the technique's own state after it.
    pub fn save_film(&mut self, header: &Header, film: &mut SavedFilm, state: &[u8]) -> Result<()> {
        self.write(header, &mut |path, to| {
            film.write(path, to)?;
            to.write_all(state).map_err(|error| Error::write(path, error))
        })
    }

    /// Writes a checkpoint. At no time is there none, if there was one: the new file is whole and on the disk before it takes the place
    /// of the last one, which is kept.
    fn write(&mut self, header: &Header, save: &mut Save) -> Result<()> {
        let partial = beside(&self.path, ".partial");
        let written = format::write(&partial, header, save).and_then(|()| self.replace(&partial));
        if let Err(error) = written {
            let _ = std::fs::remove_file(&partial);
            // The name that the user knows, not that of the file in the making.
            return Err(match error {
                Error::File { doing: "write", cause, .. } => Error::write(&self.path, cause),
                other => other,
            });
        }
        self.is_good = true;
        Ok(())
    }

    fn replace(&self, partial: &Path) -> Result<()> {
        let failed = |error: std::io::Error| Error::write(&self.path, error);
        if let Ok(old) = self.path.metadata() {
            File::open(partial).and_then(|new| inherit(&new, &old)).map_err(failed)?;
        }
        if self.is_good && self.path.exists() {
            std::fs::rename(&self.path, beside(&self.path, ".previous")).map_err(failed)?;
        }
        std::fs::rename(partial, &self.path).map_err(failed)?;
        // Names are on the disk once their folder is.
        File::open(folder_of(&self.path)).and_then(|folder| folder.sync_all()).map_err(failed)
    }
}

/// Reads a checkpoint as it lies there: its header, the film, and the technique's own state.
pub fn read(path: &Path) -> Result<(Header, SavedFilm, Vec<u8>)> {
    let header = read_header(path)?;
    let (film, state) = format::read_film(path, &header)?;
    Ok((header, film, state))
}

/// Reads the header of a checkpoint, which must be whole.
pub fn read_header(path: &Path) -> Result<Header> {
    format::read_header(path).map_err(|cause| Error::read(path, cause))
}

/// Fails where the name of a checkpoint is that of another sort of file, or of standard output.
pub fn check_name(path: &Path) -> Result<()> {
    if path == Path::new(STANDARD_INPUT) {
        return Err(Error::Usage(String::from(
            "- is standard output, and a checkpoint is read again: valid is the name of a file",
        )));
    }
    check_promise(path, "a checkpoint", "ckpt")
}

/// Whether a file begins as a checkpoint does.
pub fn is_checkpoint(path: &Path) -> Result<bool> {
    let mut start = Vec::new();
    let file = File::open(path).map_err(|error| Error::read(path, error))?;
    file.take(format::MAGIC.len() as u64).read_to_end(&mut start).map_err(|error| Error::read(path, error))?;
    Ok(start == format::MAGIC)
}

/// The file of that name with more at its end.
fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(path.as_os_str());
    name.push(suffix);
    PathBuf::from(name)
}
