//! Screenshots: the picture as it is shown, and as it is.

use std::path::{Path, PathBuf};

use super::display::Display;
use super::news::{Facts, Picture};
use crate::error::Result;
use crate::image::{self, write_picture};

/// Writes the picture to the working folder, as a PNG of what is shown and an EXR of its values; their names, which no file had before.
pub fn write(picture: &Picture, display: &Display, facts: &Facts) -> Result<[PathBuf; 2]> {
    let stem = facts.scene.file_stem().unwrap_or_else(|| "view".as_ref()).to_string_lossy();
    let stem = if stem == "-" { "view".into() } else { stem };
    let paths = free_names(Path::new(""), &stem);
    let header = [
        ("scene", facts.scene.display().to_string()),
        ("integrator", facts.settings.technique.describe()),
        ("backend", facts.settings.backend.name().to_owned()),
        ("layer", picture.layer.name()),
        ("spp", format!("{:.2}", picture.spp)),
        ("exposure", display.exposure.to_string()),
    ];
    let header = header.into_iter().map(|(name, value)| (format!("lumbre.{name}"), value)).collect();
    let file = |image, header| image::Picture { image, layers: Vec::new(), header };
    write_picture(&paths[0], &file(display.tone(&picture.image, picture.layer.scale()), Vec::new()))?;
    write_picture(&paths[1], &file(picture.image.clone(), header))?;
    Ok(paths)
}

/// The first names `STEM-view-NUMBER` of a folder that neither file has.
fn free_names(folder: &Path, stem: &str) -> [PathBuf; 2] {
    let mut number = 1u64;
    loop {
        let names = ["png", "exr"].map(|extension| folder.join(format!("{stem}-view-{number:03}.{extension}")));
        if names.iter().all(|path| path.symlink_metadata().is_err()) {
            return names;
        }
        number += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_no_file_has() {
        let folder = tempfile::tempdir().unwrap();
        let names = free_names(folder.path(), "a");
        assert_eq!(names, [folder.path().join("a-view-001.png"), folder.path().join("a-view-001.exr")]);
        std::fs::write(folder.path().join("a-view-001.exr"), "").unwrap();
        std::fs::write(folder.path().join("a-view-002.png"), "").unwrap();
        assert_eq!(free_names(folder.path(), "a")[1], folder.path().join("a-view-003.exr"));
    }
}
