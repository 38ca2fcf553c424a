//! Reading files that anyone may have written: regular files only, and no more bytes than a limit.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::standard_input::standard_input;
use crate::error::{Error, Result};

/// Bytes of a file that is read whole: an image, a buffer, a .glb.
pub(crate) const FILE_BYTES: u64 = 4 << 30;
/// Bytes that one byte of a DEFLATE stream stands for at most: one bit for 258 bytes and one more for their distance.
pub(crate) const DEFLATE_RATIO: u64 = 1032;

/// Opens a file; folders, devices and pipes, which may have no end, are refused. `-` is standard input where that was taken.
pub(crate) fn open(path: &Path) -> Result<File> {
    if let Some(file) = standard_input(path).map_err(|error| Error::read(path, error))? {
        return Ok(file);
    }
    let meta = std::fs::metadata(path).map_err(|error| Error::read(path, error))?;
    if !meta.is_file() {
        return Err(Error::read(path, "it is not a file"));
    }
    File::open(path).map_err(|error| Error::read(path, error))
}

/// The bytes of a file, unless it has more than `most`.
pub(crate) fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    let file = open(path)?;
    let size = file.metadata().map_err(|error| Error::read(path, error))?.len();
    let mut bytes = Vec::new();
    // What is read counts, for a file may grow.
    if size <= most {
        bytes.reserve(size as usize);
        file.take(most + 1).read_to_end(&mut bytes).map_err(|error| Error::read(path, error))?;
    }
    let size = size.max(bytes.len() as u64);
    if size > most {
        return Err(Error::scene(path, format!("the file has {size} bytes, and {most} is the most that is read")));
    }
    Ok(bytes)
}

/// The text of a file, unless it has more than `most` bytes.
pub(crate) fn read_text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read_bytes(path, most)?).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|byte| **byte == b'\n').count() as u32 + 1;
        Error::scene_line(path, line, format!("the file is not text: byte {} is not UTF-8", good.len()))
    })
}
