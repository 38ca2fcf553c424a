//! The statements of an OBJ file as tobj takes them: each on a line of its own, with all that files leave out or add.
//!
//! tobj reads numbers and shares vertices. It wants every face of a group to have the same attributes, and every vertex a colour or none;
//! a group here is therefore a part of the file with one name, one material and one kind of face, and called by its number.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Read};
use std::path::Path;

use tobj::LoadError;

use super::lines::{Lines, keyword, read_from, without_comment};
use crate::error::{Error, Result};

/// What a face's index refers to, in the order of `v/vt/vn`.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];
/// What changes nothing here: smoothing groups (faces without normals are flat), display attributes, names of other files.
const SILENT: [&str; 10] =
    ["s", "mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "usemap", "maplib"];
/// Keywords that the warning names at most.
const NAMED: usize = 8;

/// Faces that have a name and a material in common.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Part {
    /// Index into [`Names::groups`].
    pub group: usize,
    /// Index into [`Names::materials`]; nothing where the file names none.
    pub material: Option<usize>,
}

/// What the statements name.
#[derive(Debug, Default)]
pub(super) struct Names {
    /// The parts, by their numbers.
    pub parts: Vec<Part>,
    /// Groups and objects.
    pub groups: Vec<String>,
    /// Materials, in the order of their first use.
    pub materials: Vec<String>,
    /// What stands behind each `mtllib`.
    pub libraries: Vec<String>,
    /// A `usemtl` names nothing.
    pub empty_material: bool,
    /// How often keywords occur that are not read.
    pub skipped: BTreeMap<String, usize>,
    /// Faces of one or two corners.
    pub small_faces: usize,
}

/// Reads statements, for tobj.
pub(super) struct Statements<'p> {
    path: &'p Path,
    lines: Lines,
    /// Groups, materials and colours count; else all faces are one part for each kind of face.
    is_scene: bool,
    /// Every vertex gets a colour.
    pub has_colours: bool,
    /// A vertex has a colour, and one before it got none: to be read again with [`Self::has_colours`].
    pub needs_colours: bool,
    pub names: Names,
    line: Vec<u8>,
    /// So many bytes of it are what tobj is to read next.
    handed_on: Option<usize>,
    /// What tobj is to read next.
    out: Vec<u8>,
    at: usize,
    /// Vertices, texture coordinates and normals so far.
    counts: [i64; 3],
    /// The largest index of each kind that referred to what came later or never, and its line.
    ahead: [(i64, u32); 3],
    part: Part,
    by_name: BTreeMap<String, usize>,
    corners: Vec<[i64; 3]>,
    /// The kind of the faces that are handed on at once; those of the others wait for the end of the part.
    at_once: Option<usize>,
    waiting: [Vec<u8>; 4],
    is_over: bool,
    error: Option<Error>,
}

impl<'p> Statements<'p> {
    /// Opens a file.
    pub fn open(path: &'p Path, is_scene: bool, has_colours: bool) -> Result<Self> {
        Ok(Self {
            path,
            lines: Lines::open(path)?,
            is_scene,
            has_colours,
            needs_colours: false,
            names: Names { groups: vec![String::from("unnamed_object")], ..Names::default() },
            line: Vec::new(),
            handed_on: None,
            out: Vec::new(),
            at: 0,
            counts: [0; 3],
            ahead: [(0, 0); 3],
            part: Part::default(),
            by_name: BTreeMap::new(),
            corners: Vec::new(),
            at_once: None,
            waiting: Default::default(),
            is_over: false,
            error: None,
        })
    }

    /// What tobj's error means.
    pub fn error(&mut self, error: LoadError) -> Error {
        if let Some(error) = self.error.take() {
            return error;
        }
        let at = |line: u32, message: String| Error::scene_line(self.path, line, message);
        let what = match error {
            LoadError::FaceVertexOutOfBounds
            | LoadError::FaceTexCoordOutOfBounds
            | LoadError::FaceNormalOutOfBounds => {
                let missing = (0..3).filter(|kind| self.ahead[*kind].0 > self.counts[*kind]);
                return match missing.min_by_key(|kind| self.ahead[*kind].1) {
                    Some(kind) => {
                        let ((index, line), kind, count) = (self.ahead[kind], KINDS[kind], self.counts[kind]);
                        at(
                            line,
                            format!("the face refers to {kind} {index}, and there are {count} where its group ends"),
                        )
                    }
                    None => at(self.lines.number, format!("not a valid OBJ file: {error}")),
                };
            }
            LoadError::ScalingByZeroError => return at(self.lines.number, String::from("the vertex has a w of 0")),
            LoadError::PositionParseError => "the position",
            LoadError::TexcoordParseError => "the texture coordinate",
            LoadError::NormalParseError => "the normal",
            _ => return at(self.lines.number, format!("not a valid OBJ file: {error}")),
        };
        let line = self.out.trim_ascii_end().rsplit(|byte| *byte == b'\n').next().unwrap_or_default();
        let line = String::from_utf8_lossy(line);
        at(
            self.lines.number,
            format!("{what} has something that is no number: '{line}'; numbers are such as 1, -.5, 1e-3"),
        )
    }

    /// Reads the next line; false at the end.
    fn advance(&mut self) -> io::Result<bool> {
        if self.is_over {
            return Ok(false);
        }
        let mut line = std::mem::take(&mut self.line);
        let is_there = self.lines.next(&mut line);
        self.line = line;
        if !is_there? {
            self.is_over = true;
            self.end_part();
            return Ok(true);
        }
        let mut line = std::mem::take(&mut self.line);
        let read = match std::str::from_utf8(&line) {
            Ok(text) => self.statement(text),
            Err(_) => Err(String::from("the file is not text (UTF-8)")),
        };
        if let Some(length) = self.handed_on.take() {
            line.truncate(length);
            line.push(b'\n');
            std::mem::swap(&mut line, &mut self.out);
        }
        self.line = line;
        read.map_err(|message| {
            self.error = Some(Error::scene_line(self.path, self.lines.number, message));
            io::ErrorKind::InvalidData.into()
        })
    }

    /// Takes a line in; false where no more lines are wanted.
    fn statement(&mut self, line: &str) -> Result<bool, String> {
        // Most lines by far are of these two kinds.
        match line.as_bytes() {
            [b'v', b' ' | b'\t', ..] => return self.vertex(without_comment(line)),
            [b'f', b' ' | b'\t', ..] => return self.face(line, "f").map(|()| true),
            _ => {}
        }
        let (word, rest) = keyword(line);
        match word {
            "v" => return self.vertex(without_comment(line)),
            "vt" => self.attribute(1, without_comment(line))?,
            "vn" => self.attribute(2, without_comment(line))?,
            "f" | "fo" => self.face(line, word)?,
            "g" | "o" if self.is_scene => {
                self.end_part();
                self.part.group = self.names.groups.len();
                self.names.groups.push(String::from(if rest.is_empty() { "unnamed_object" } else { rest }));
            }
            "usemtl" if self.is_scene => self.use_material(rest),
            "mtllib" if self.is_scene => self.names.libraries.push(rest.to_owned()),
            "g" | "o" | "usemtl" | "mtllib" => {}
            word if word.is_empty() || word.starts_with('#') || SILENT.contains(&word) => {}
            word if self.names.skipped.len() < NAMED || self.names.skipped.contains_key(word) => {
                *self.names.skipped.entry(word.to_owned()).or_default() += 1;
            }
            _ => *self.names.skipped.entry(String::from("others")).or_default() += 1,
        }
        Ok(true)
    }

    /// Hands on the beginning of the line that is read, without a copy where nothing else is handed on.
    fn pass(&mut self, beginning: &str) {
        if self.out.is_empty() {
            self.handed_on = Some(beginning.len());
        } else {
            self.push(beginning);
        }
    }

    fn push(&mut self, line: &str) {
        self.out.extend_from_slice(line.as_bytes());
        self.out.push(b'\n');
    }

    /// `v x y z`, with a weight or a colour, or with a colour and its alpha.
    fn vertex(&mut self, line: &str) -> Result<bool, String> {
        let count = line.split_ascii_whitespace().skip(1).count();
        let has_colour = matches!(count, 6 | 7);
        if !has_colour && !matches!(count, 3 | 4) {
            return Err(format!(
                "a position has three numbers, with a weight four, with a colour six: '{line}' has {count}"
            ));
        }
        if has_colour && self.is_scene && !self.has_colours {
            if self.counts[0] > 0 {
                self.needs_colours = true;
                return Ok(false);
            }
            self.has_colours = true;
        }
        self.counts[0] += 1;
        if !has_colour && !self.has_colours {
            self.pass(line);
            return Ok(true);
        }
        let mut words: Vec<&str> = line.split_ascii_whitespace().take(7).collect();
        let mut weighted = String::new();
        if has_colour {
            let is_number = |word: &&str| word.parse::<f64>().is_ok_and(f64::is_finite);
            if !words[4..].iter().all(is_number) {
                return Err(format!("the colour has something that is no number: '{line}'"));
            }
        } else if count == 4 {
            // tobj takes a weight or a colour.
            let number = |index: usize| words[index].parse::<f64>().unwrap_or(f64::NAN);
            let [x, y, z] = [1, 2, 3].map(|index| number(index) / number(4));
            weighted = format!("v {x} {y} {z}");
            words = weighted.split(' ').collect();
        }
        if self.has_colours && !has_colour {
            words.extend(["1"; 3]);
        }
        let wanted = if self.has_colours { 7 } else { 4 };
        let line = words[..wanted].join(" ");
        drop(weighted);
        self.push(&line);
        Ok(true)
    }

    /// `vt u`, `vt u v` or `vt u v w`; `vn x y z`.
    fn attribute(&mut self, kind: usize, line: &str) -> Result<(), String> {
        let needed = if kind == 1 { 1 } else { 3 };
        let count = line.split_ascii_whitespace().skip(1).count();
        if count < needed {
            return Err(format!("a {} has {needed} numbers or more, and '{line}' has {count}", KINDS[kind]));
        }
        self.counts[kind] += 1;
        self.out.extend_from_slice(line.as_bytes());
        self.push(if count == 1 { " 0" } else { "" });
        Ok(())
    }

    fn use_material(&mut self, name: &str) {
        let material = match self.by_name.get(name) {
            _ if name.is_empty() => {
                self.names.empty_material = true;
                None
            }
            Some(known) => Some(*known),
            None => {
                self.by_name.insert(name.to_owned(), self.names.materials.len());
                self.names.materials.push(name.to_owned());
                Some(self.names.materials.len() - 1)
            }
        };
        if material != self.part.material {
            self.end_part();
            self.part.material = material;
        }
    }

    /// `f` with corners `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn face(&mut self, line: &str, word: &str) -> Result<(), String> {
        let text = without_comment(line);
        self.corners.clear();
        // Attributes that every corner has, and that any has.
        let (mut common, mut any) = (3, 0);
        for corner in text.split_ascii_whitespace().skip(1) {
            let mut indices = indices_of(corner).ok_or_else(|| not_a_corner(corner))?;
            for (kind, index) in indices.iter_mut().enumerate() {
                // Most indices are of something before.
                if *index != 0 && !(1..=self.counts[kind]).contains(index) {
                    *index = self.index(kind, *index)?;
                }
            }
            let has = usize::from(indices[1] > 0) | usize::from(indices[2] > 0) << 1;
            (common, any) = (common & has, any | has);
            self.corners.push(indices);
        }
        if self.corners.len() < 3 {
            self.names.small_faces += 1;
            return Ok(());
        }
        let at_once = match self.at_once {
            Some(kind) => kind,
            None => {
                self.begin_part();
                *self.at_once.insert(common)
            }
        };
        if common == at_once && common == any && word == "f" {
            self.pass(text);
            return Ok(());
        }
        let mut face = String::from("f");
        for [v, vt, vn] in &self.corners {
            face += &match common {
                0 => format!(" {v}"),
                1 => format!(" {v}/{vt}"),
                2 => format!(" {v}//{vn}"),
                _ => format!(" {v}/{vt}/{vn}"),
            };
        }
        face.push('\n');
        let to = if common == at_once { &mut self.out } else { &mut self.waiting[common] };
        to.extend_from_slice(face.as_bytes());
        Ok(())
    }

    /// An index from 1.
    fn index(&mut self, kind: usize, index: i64) -> Result<i64, String> {
        let count = self.counts[kind];
        if index == 0 || index < -count || index > i64::from(u32::MAX) {
            let name = KINDS[kind];
            return Err(format!(
                "the face refers to {name} {index}, and there are {count} by here: they count from 1, or backwards from -1"
            ));
        }
        let index = if index < 0 { count + 1 + index } else { index };
        if index > count.max(self.ahead[kind].0) {
            self.ahead[kind] = (index, self.lines.number);
        }
        Ok(index)
    }

    fn begin_part(&mut self) {
        self.out.extend_from_slice(format!("g {}\n", self.names.parts.len()).as_bytes());
        self.names.parts.push(self.part);
    }

    /// Hands on the faces that waited.
    fn end_part(&mut self) {
        for kind in 0..self.waiting.len() {
            if !self.waiting[kind].is_empty() {
                self.begin_part();
                self.out.append(&mut self.waiting[kind]);
            }
        }
        self.at_once = None;
    }
}

/// The indices of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, as they are written; 0 is none.
fn indices_of(corner: &str) -> Option<[i64; 3]> {
    let mut indices = [0i64; 3];
    let mut bytes = corner.as_bytes();
    for (kind, index) in indices.iter_mut().enumerate() {
        let sign = match bytes {
            [b'-', rest @ ..] => {
                bytes = rest;
                -1
            }
            [b'+', rest @ ..] => {
                bytes = rest;
                1
            }
            [b'/', rest @ ..] if kind == 1 => {
                bytes = rest;
                continue;
            }
            [] if kind > 0 => break,
            _ => 1,
        };
        let mut value = 0i64;
        while let [digit @ b'0'..=b'9', rest @ ..] = bytes {
            value = value.saturating_mul(10).saturating_add(i64::from(digit - b'0'));
            bytes = rest;
        }
        if value == 0 {
            return None;
        }
        *index = sign * value;
        match bytes {
            [] => break,
            [b'/', rest @ ..] if kind < 2 => bytes = rest,
            _ => return None,
        }
    }
    bytes.is_empty().then_some(indices)
}

fn not_a_corner(corner: &str) -> String {
    format!(
        "the corner '{corner}' of a face is none of v, v/vt, v//vn and v/vt/vn: indices are integers from 1, or from -1 backwards"
    )
}

impl Read for Statements<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        read_from(self, out)
    }
}

impl BufRead for Statements<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.at == self.out.len() {
            self.out.clear();
            self.at = 0;
            while self.out.is_empty() && self.advance()? {}
        }
        Ok(&self.out[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at += count;
    }
}
