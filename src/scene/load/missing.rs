//! What of a scene would be refused or left out.

use std::path::{Path, PathBuf};

use super::{LoadOptions, SceneFormat, format_of, load, mitsuba};
use crate::error::{Error, Result};

/// What loading a scene has to say against it.
#[derive(Clone, Debug, Default)]
pub struct Missing {
    /// Errors, any of which keeps it from loading.
    pub refused: Vec<String>,
    /// What is left out or changed.
    pub warnings: Vec<String>,
    /// Files that a Mitsuba scene includes or reads.
    pub names: Vec<PathBuf>,
}

/// Everything that would be refused of a Mitsuba scene; of other formats, which end at the first error, that one.
pub fn missing(path: &Path, options: &LoadOptions) -> Missing {
    if path.is_file() && matches!(format_of(path, options), Ok(SceneFormat::Xml)) {
        return mitsuba::missing(path, options);
    }
    match load(path, options) {
        Ok(scene) => Missing { warnings: scene.warnings, ..Missing::default() },
        Err(error) => Missing { refused: vec![error.to_string()], ..Missing::default() },
    }
}

/// The scene files of a folder and of those in it, in order; a file is itself.
pub fn scene_files(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let (mut files, mut left) = (Vec::new(), vec![path.to_owned()]);
    while let Some(folder) = left.pop() {
        for entry in std::fs::read_dir(&folder).map_err(|error| Error::read(&folder, error))? {
            let entry = entry.map_err(|error| Error::read(&folder, error))?;
            let kind = entry.file_type().map_err(|error| Error::read(&folder, error))?;
            let path = entry.path();
            // Links may lead round in a circle.
            match kind.is_dir() {
                true => left.push(path),
                false if SceneFormat::by_extension(&path).is_some() => files.push(path),
                false => {}
            }
        }
    }
    files.sort();
    Ok(files)
}
