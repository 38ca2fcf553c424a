//! What the extension of a name promises to whoever finds the file.

use std::path::Path;

use super::STANDARD_INPUT;
use crate::error::{Error, Result};

/// What files hold, and the extensions that say so.
const PROMISES: [(&str, &[&str]); 7] = [
    (
        "an image",
        &[
            "exr", "png", "jpg", "jpeg", "jpe", "tif", "tiff", "bmp", "gif", "hdr", "pic", "pfm", "pnm", "ppm", "pgm",
            "pbm", "tga", "webp", "avif", "heic", "jxl", "jp2", "dds", "ktx", "ktx2", "qoi", "psd",
        ],
    ),
    (
        "a scene",
        &[
            "xml",
            "gltf",
            "glb",
            "obj",
            "mtl",
            "ply",
            "serialized",
            "stl",
            "fbx",
            "blend",
            "usd",
            "usda",
            "usdc",
            "usdz",
            "pbrt",
            "abc",
            "dae",
        ],
    ),
    ("JSON", &["json"]),
    ("a drawing", &["svg", "eps", "ps"]),
    ("a document", &["pdf", "html", "htm", "md"]),
    ("a table", &["csv", "tsv"]),
    ("a video", &["mp4", "mov", "avi", "mkv", "webm"]),
];

/// The extension of a name in small letters, and what files of it hold; nothing where it promises nothing.
pub fn promise_of(path: &Path) -> Option<(String, &'static str)> {
    let extension = path.extension()?.to_string_lossy().to_lowercase();
    let (holds, _) = PROMISES.iter().find(|(_, extensions)| extensions.contains(&extension.as_str()))?;
    Some((extension, holds))
}

/// Fails where the name to write to promises something else than `holds`, such as "a checkpoint", whose files may end in `.own`.
pub fn check_promise(path: &Path, holds: &str, own: &str) -> Result<()> {
    match promise_of(path).filter(|(extension, _)| extension != own) {
        None => Ok(()),
        Some((extension, promised)) => Err(Error::Usage(format!(
            "{} would be {holds}, and .{extension} is the extension of {promised}: valid is {}, or a name without extension",
            path.display(),
            path.with_extension(own).display()
        ))),
    }
}

/// Fails where the name of a folder to make is that of a file.
pub fn check_folder_name(path: &Path) -> Result<()> {
    if path == Path::new(STANDARD_INPUT) {
        return Err(Error::Usage(String::from(
            "'-' would be a folder, and stands for standard output: valid is a name",
        )));
    }
    match promise_of(path).filter(|_| !path.is_dir()) {
        None => Ok(()),
        Some((extension, promised)) => Err(Error::Usage(format!(
            "{} would be a folder, and .{extension} is the extension of {promised}: valid is {}",
            path.display(),
            path.with_extension("").display()
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_promise_one_thing() {
        for name in ["out.ckpt", "out", "out.d", ".png", "s1.2", "/dev/stdout"] {
            assert!(check_promise(Path::new(name), "a checkpoint", "ckpt").is_ok(), "{name}");
            assert!(check_folder_name(Path::new(name)).is_ok(), "{name}");
        }
        let said = |name: &str| check_promise(Path::new(name), "JSON", "json").unwrap_err().to_string();
        let valid = "valid is a/out.json, or a name without extension";
        assert_eq!(
            said("a/out.PNG"),
            format!("a/out.PNG would be JSON, and .png is the extension of an image: {valid}")
        );
        assert!(said("scene.xml").contains("a scene") && said("out.csv").contains("a table"));
        assert!(check_promise(Path::new("out.json"), "JSON", "json").is_ok());
        let all: Vec<&str> = PROMISES.iter().flat_map(|(_, extensions)| extensions.iter().copied()).collect();
        assert!(all.iter().all(|one| all.iter().filter(|other| one == *other).count() == 1), "each promises one thing");
    }
}
