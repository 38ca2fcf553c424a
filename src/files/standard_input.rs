//! Standard input in the place of a file.

use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::error::{Error, Result};

/// The name that stands for standard input, or output.
pub const STANDARD_INPUT: &str = "-";

/// All of it, once somebody has taken it: a file without a name, which can be read again.
static TAKEN: Mutex<Option<File>> = Mutex::new(None);

/// Reads standard input to its end, or one byte more than `most`, which readers refuse. From here on [`super::open`] knows it as `-`.
pub(crate) fn take_standard_input(most: u64) -> Result<()> {
    let failed = |error: io::Error| Error::read(Path::new("standard input"), error);
    let mut taken = TAKEN.lock().unwrap_or_else(PoisonError::into_inner);
    if taken.is_none() {
        let mut file = tempfile::tempfile().map_err(failed)?;
        io::copy(&mut io::stdin().lock().take(most.saturating_add(1)), &mut file).map_err(failed)?;
        *taken = Some(file);
    }
    Ok(())
}

/// What was taken of standard input, from its beginning; nothing where `path` is another name, or it was not taken. One reader at a time.
pub(super) fn standard_input(path: &Path) -> io::Result<Option<File>> {
    let taken = TAKEN.lock().unwrap_or_else(PoisonError::into_inner);
    match &*taken {
        Some(file) if path == Path::new(STANDARD_INPUT) => {
            let mut file = file.try_clone()?;
            file.rewind()?;
            Ok(Some(file))
        }
        _ => Ok(None),
    }
}
