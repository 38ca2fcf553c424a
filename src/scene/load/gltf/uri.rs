//! What URIs stand for: data of their own, or a file beside the scene.

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::document::shown;

/// What a URI stands for.
#[derive(Debug)]
pub(super) enum Resource<'a> {
    /// The bytes that it holds, still encoded.
    Data(Encoded<'a>),
    /// A file.
    File(PathBuf),
}

/// The bytes of a data URI (RFC 2397), without its scheme.
#[derive(Clone, Copy)]
pub(super) struct Encoded<'a>(&'a str);

impl std::fmt::Debug for Encoded<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} characters", self.0.len())
    }
}

/// Some writers leave the padding out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Resolves a URI of a file in this folder; the message says what is wrong with it. Files are found in the folder and below
/// it only: a scene from elsewhere must not make its reader open what it likes.
pub(super) fn resolve<'a>(folder: &Path, uri: &'a str) -> Result<Resource<'a>, String> {
    if let Some(rest) = uri.strip_prefix("data:") {
        return Ok(Resource::Data(Encoded(rest)));
    }
    let scheme = uri.find(':').filter(|end| !uri[..*end].contains(['/', '\\', '?', '#']));
    if scheme.is_some() {
        return Err(format!(
            "the URI '{}' is not a relative path: files beside the scene and data: are read",
            shown(uri)
        ));
    }
    let path = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("the URI '{}' is not UTF-8 once its percent signs are decoded", shown(uri)))?;
    let escapes =
        |why: &str| Err(format!("the URI '{}' {why}: files must lie beside the scene or below it", shown(uri)));
    if path.starts_with(['/', '\\']) {
        return escapes("is an absolute path");
    }
    let mut file = folder.to_owned();
    let mut is_empty = true;
    for part in path.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => return escapes("leaves the scene's folder"),
            // A percent sign can hide a drive or a device of Windows, and nothing may hide an end of text.
            _ if part.contains([':', '\0']) => return escapes("has a character that no path may have"),
            _ => {
                file.push(part);
                is_empty = false;
            }
        }
    }
    if is_empty {
        return Err(format!("the URI '{}' names no file", shown(uri)));
    }
    Ok(Resource::File(file))
}

impl Encoded<'_> {
    /// Decodes them, which takes its time where they are many: to be done once for each buffer or image. The message says what is wrong.
    pub fn decode(self) -> Result<Vec<u8>, String> {
        let (media, data) = self.0.split_once(',').ok_or("the data URI has no comma")?;
        let bytes: Vec<u8> = percent_decode_str(data).collect();
        if !media.ends_with(";base64") {
            return Ok(bytes);
        }
        BASE64.decode(bytes).map_err(|error| format!("the data URI is not valid base64: {error}"))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn file(uri: &str) -> Result<PathBuf, String> {
        match resolve(Path::new("/scenes"), uri)? {
            Resource::File(path) => Ok(path),
            Resource::Data(_) => Err(String::from("data")),
        }
    }

    #[test]
    fn paths_stay_below_the_scene() {
        assert_eq!(file("a%20b/./c.png").unwrap(), Path::new("/scenes/a b/c.png"));
        assert_eq!(file("maps\\c.png").unwrap(), Path::new("/scenes/maps/c.png"));
        assert_eq!(file("a:b.png").unwrap_err().split(": ").nth(1).unwrap(), "files beside the scene and data");
        for bad in [
            "../a",
            "a/../../b",
            "%2e%2e/a",
            "a\\..\\..\\b",
            "/etc/passwd",
            "%2Fetc/passwd",
            "\\\\host\\a",
            "C:/a",
            "C%3A/a",
            "http://host/a",
            "file:///a",
            "",
            ".",
            "a%00b",
            "%ff",
        ] {
            assert!(file(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn data_is_decoded() {
        let data = |uri: &str| match resolve(Path::new(""), uri) {
            Ok(Resource::Data(encoded)) => encoded.decode().ok(),
            _ => None,
        };
        assert_eq!(data("data:application/octet-stream;base64,AAEC/w==").unwrap(), [0, 1, 2, 255]);
        assert_eq!(data("data:;base64,AAEC/w").unwrap(), [0, 1, 2, 255]);
        assert_eq!(data("data:text/plain,a%20b").unwrap(), b"a b");
        assert!(data("data:;base64").is_none() && data("data:;base64,@@@@").is_none());
    }
}
