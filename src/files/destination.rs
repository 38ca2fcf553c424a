//! What a name to write to stands for: symbolic links are followed, and devices and pipes are told from files.

use std::fs::{File, Metadata};
use std::io;
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};

/// The most symbolic links that lead to a file, as on Linux.
const MOST_LINKS: usize = 40;

/// The folder that a file lies in.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// What a name to write to stands for.
pub(super) enum Destination {
    /// A file.
    File {
        /// Its name behind all symbolic links; there need be no file of that name yet.
        path: PathBuf,
        /// What is known of it where there is one.
        there: Option<Metadata>,
    },
    /// What is written to, and never replaced.
    Stream(Stream),
}

/// A device, a pipe, or what this process has open already.
pub(super) enum Stream {
    /// A device or a pipe of this name.
    Special(PathBuf),
    /// An open file of this process, by its number and a name that leads to it, such as `/dev/fd/3`.
    Open(u32, PathBuf),
}

impl Stream {
    /// Opens it. A pipe waits here for someone who reads.
    pub fn open(&self) -> io::Result<File> {
        match self {
            Self::Special(path) => File::options().write(true).open(path),
            // The same position in the file: a copy of what is open, rather than another opening of it.
            Self::Open(1, _) => io::stdout().as_fd().try_clone_to_owned().map(File::from),
            Self::Open(2, _) => io::stderr().as_fd().try_clone_to_owned().map(File::from),
            Self::Open(_, path) => File::options().append(true).open(path),
        }
    }

    /// Fails where it cannot be written. A pipe is not opened for that: who reads it would see its end.
    pub fn check(&self) -> io::Result<()> {
        match self {
            Self::Open(1 | 2, _) => Ok(()),
            Self::Special(path) | Self::Open(_, path) => is_writable(path),
        }
    }
}

/// Fails where this process may not write what stands at `path`.
pub(super) fn is_writable(path: &Path) -> io::Result<()> {
    Ok(rustix::fs::access(path, rustix::fs::Access::WRITE_OK)?)
}

/// What `path` stands for.
pub(super) fn destination(path: &Path) -> io::Result<Destination> {
    let wrong = |message: &str| io::Error::new(io::ErrorKind::InvalidInput, message);
    let name = path.as_os_str().as_encoded_bytes();
    if name.is_empty() {
        return Err(wrong("the name is empty"));
    }
    let there = match std::fs::metadata(path) {
        Ok(there) => Some(there),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    if there.as_ref().is_some_and(Metadata::is_dir) || name.ends_with(b"/") {
        return Err(wrong("it is a folder"));
    }
    let mut file = path.to_owned();
    for _ in 0..MOST_LINKS {
        if let Some(number) = descriptor(&file) {
            return Ok(Destination::Stream(Stream::Open(number, path.to_owned())));
        }
        match std::fs::read_link(&file) {
            Ok(target) => file = folder_of(&file).join(target),
            Err(_) => break, // no link, or nothing
        }
    }
    if there.as_ref().is_some_and(|there| !there.is_file()) {
        return Ok(Destination::Stream(Stream::Special(path.to_owned())));
    }
    Ok(Destination::File { path: file, there })
}

/// The number of the open file that a name such as `/dev/fd/3` or `/proc/self/fd/3` is that of.
fn descriptor(path: &Path) -> Option<u32> {
    let number = path.file_name()?.to_str()?.parse().ok()?;
    let folder = folder_of(path).canonicalize().ok()?;
    let own = Path::new("/proc").join(std::process::id().to_string()).join("fd");
    (folder == own || folder == Path::new("/dev/fd")).then_some(number)
}

/// The file behind the symbolic links of a name, there or not. Fails where that is no file.
pub(crate) fn file_behind(path: &Path) -> io::Result<PathBuf> {
    match destination(path)? {
        Destination::File { path, .. } => Ok(path),
        Destination::Stream(_) => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is a device or a pipe, and what it is to hold is read again",
        )),
    }
}

/// What all names of one file have in common, whether it is there or not; nothing for devices and pipes.
pub fn same_file(path: &Path) -> Option<PathBuf> {
    let file = file_behind(path).ok()?;
    let folder = folder_of(&file).canonicalize().unwrap_or_else(|_| folder_of(&file).to_owned());
    Some(folder.join(file.file_name()?))
}

/// Whether a name is that of a device or a pipe.
pub(crate) fn is_stream(path: &Path) -> bool {
    matches!(destination(path), Ok(Destination::Stream(_)))
}

/// Whether a name is that of this process's standard output.
pub fn is_standard_output(path: &Path) -> bool {
    matches!(destination(path), Ok(Destination::Stream(Stream::Open(1, _))))
}
