//! MTL files: what `mtllib` names, and their statements as tobj takes them.

use std::io::{self, BufRead, Read};
use std::path::{Path, PathBuf};

use tobj::LoadError;

use super::lines::{Lines, keyword, read_from, without_comment};
use crate::error::{Error, Result};
use crate::scene::single;

/// Keywords with a colour.
const COLOURS: [&str; 5] = ["Ka", "Kd", "Ks", "Ke", "Tf"];
/// Keywords with a number.
const NUMBERS: [&str; 13] =
    ["Ns", "Ni", "d", "Tr", "illum", "sharpness", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor"];
/// Keywords with an image.
const IMAGES: [&str; 18] = [
    "map_Ka", "map_Kd", "map_Ks", "map_Ke", "map_Ns", "map_d", "map_Tr", "map_Bump", "bump", "norm", "disp", "decal",
    "refl", "map_refl", "map_Pr", "map_Pm", "map_Ps", "map_aat",
];

/// The files that the text behind `mtllib` names: names may hold blanks, and several may stand side by side. A name that no file has is among
/// them as it is.
pub(super) fn libraries(folder: &Path, text: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut rest = text;
    while !rest.is_empty() && !rest.starts_with('#') && found.len() <= MAX_LIBRARIES {
        // The longest name that a file has.
        let ends = rest.char_indices().filter(|(_, c)| c.is_ascii_whitespace()).map(|(at, _)| at).chain([rest.len()]);
        let ends: Vec<usize> = ends.take(MAX_WORDS).collect();
        let known = ends.iter().rev().find_map(|end| Some((*end, file(folder, &rest[..*end])?)));
        let (end, path) = known.unwrap_or_else(|| (ends[0], folder.join(&rest[..ends[0]])));
        found.push(path);
        rest = rest[end..].trim_ascii_start();
    }
    found
}

/// Words of a name at the most.
const MAX_WORDS: usize = 16;
/// Names of libraries that are looked for, in all.
pub(super) const MAX_LIBRARIES: usize = 256;

/// The file of that name, as files name each other: relative to a folder, perhaps in quotes, with the separators of any system, or with
/// the folders of another machine before its name.
pub(super) fn file(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.trim_ascii();
    let bare = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name);
    let slashes = bare.replace('\\', "/");
    let last = slashes.rsplit('/').next().unwrap_or_default();
    let is_file = |name: &str| Some(folder.join(name)).filter(|path| !name.is_empty() && path.is_file());
    [name, bare, &slashes, last].into_iter().find_map(is_file)
}

/// The materials of an MTL file, and whether one of them had no name and was left out.
pub(super) fn read(path: &Path) -> Result<(Vec<tobj::Material>, bool)> {
    let mut statements = Statements {
        lines: Lines::open(path)?,
        out: Vec::new(),
        at: 0,
        is_nameless: false,
        has_nameless: false,
        wrong: None,
    };
    match tobj::load_mtl_buf(&mut statements) {
        Ok((materials, _)) => Ok((materials, statements.has_nameless)),
        Err(error) => {
            let message = statements.wrong.take().unwrap_or_else(|| match error {
                LoadError::ReadError => String::from("the file cannot be read"),
                error => error.to_string(),
            });
            Err(Error::scene_line(path, statements.lines.number, format!("not a valid MTL file: {message}")))
        }
    }
}

/// Reads statements, for tobj.
struct Statements {
    lines: Lines,
    out: Vec<u8>,
    at: usize,
    /// The material here has no name.
    is_nameless: bool,
    /// Some material has none.
    has_nameless: bool,
    wrong: Option<String>,
}

impl Statements {
    fn statement(&mut self, line: &str) -> Result<String, String> {
        let (word, rest) = keyword(line);
        if word.eq_ignore_ascii_case("newmtl") {
            self.is_nameless = rest.is_empty();
            self.has_nameless |= self.is_nameless;
            return Ok(if self.is_nameless { String::new() } else { format!("newmtl {rest}") });
        }
        if self.is_nameless || word.is_empty() || word.starts_with('#') {
            return Ok(String::new());
        }
        let known = |all: &[&'static str]| all.iter().copied().find(|known| known.eq_ignore_ascii_case(word));
        let number = |word: &str, text: &str| match text.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                single::check([value]).map(|()| value).map_err(|message| format!("{word}: {message}"))
            }
            _ => Err(format!("{word} needs a number such as 0.5, 1 or 1e-3, and '{text}' is none")),
        };
        if let Some(word) = known(&COLOURS) {
            let words: Vec<&str> = without_comment(rest).split_ascii_whitespace().collect();
            let [r, g, b] = match words[..] {
                [r, g, b, ..] => [r, g, b],
                [grey] => [grey; 3],
                _ => return Err(format!("{word} needs three numbers, or one for all channels")),
            };
            for text in [r, g, b] {
                number(word, text)?;
            }
            return Ok(format!("{word} {r} {g} {b}"));
        }
        if let Some(word) = known(&NUMBERS) {
            let mut words = without_comment(rest).split_ascii_whitespace().filter(|text| *text != "-halo");
            let value = number(word, words.next().unwrap_or_default())?;
            if word == "illum" && !(value.fract() == 0.0 && (0.0..256.0).contains(&value)) {
                return Err(format!("illum is {value}, and must be an integer from 0 to 255"));
            }
            return Ok(format!("{word} {value}"));
        }
        match known(&IMAGES) {
            Some(word) if rest.is_empty() => Err(format!("{word} names no file")),
            Some(word) => Ok(format!("{word} {rest}")),
            None => Ok(line.to_owned()),
        }
    }
}

impl Read for Statements {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        read_from(self, out)
    }
}

impl BufRead for Statements {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let mut line = Vec::new();
        while self.at == self.out.len() && self.lines.next(&mut line)? {
            self.at = 0;
            let statement = match std::str::from_utf8(&line) {
                Ok(text) => self.statement(text),
                Err(_) => Err(String::from("the file is not text (UTF-8)")),
            };
            self.out = statement
                .map_err(|message| {
                    self.wrong = Some(message);
                    io::Error::from(io::ErrorKind::InvalidData)
                })?
                .into_bytes();
            if !self.out.is_empty() {
                self.out.push(b'\n');
            }
        }
        Ok(&self.out[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at += count;
    }
}
