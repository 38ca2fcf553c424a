//! The text of a scene file: XML, with `<include>`, `<default>` and `$name` resolved.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::error::{Error, Result, all_of};
use crate::files::read_text;
use crate::scene::load::limits::{DEPTH, INCLUDES, PARAMETER_BYTES, XML_BYTES, XML_ELEMENTS};

/// One XML element; parameters are already replaced in its attributes.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub tag: String,
    pub attributes: BTreeMap<String, String>,
    pub children: Vec<Element>,
    pub file: Rc<Path>,
    pub line: u32,
}

impl Element {
    /// An error about this element.
    pub fn error(&self, message: impl Into<String>) -> Error {
        Error::scene_line(&self.file, self.line, message)
    }

    /// An attribute that must be there.
    pub fn attribute(&self, name: &str) -> Result<&str> {
        self.attributes
            .get(name)
            .map(String::as_str)
            .ok_or_else(|| self.error(format!("<{}> needs the attribute '{name}'", self.tag)))
    }
}

/// The parameters of a scene: what the caller defines, then what `<default>` gives.
struct Parameters {
    values: BTreeMap<String, String>,
    declared: BTreeSet<String>,
    used: RefCell<BTreeSet<String>>,
    /// Bytes that they stood for so far.
    bytes: Cell<usize>,
}

/// Parameters of the scene that the caller sets: `-D name=value`.
pub(super) type Defines = [(String, String)];

/// Reads a file and all that it includes.
pub(super) fn read(path: &Path, defines: &Defines) -> Result<Element> {
    let parameters = Parameters {
        values: defines.iter().cloned().collect(),
        declared: BTreeSet::new(),
        used: RefCell::default(),
        bytes: Cell::new(0),
    };
    let mut reader = Reader { parameters, bytes: 0, elements: 0 };
    let root = reader.read_file(path, 0)?;
    let parameters = reader.parameters;
    let known: BTreeSet<String> = parameters.declared.union(&parameters.used.borrow()).cloned().collect();
    for (name, _) in defines {
        if !known.contains(name) {
            let valid =
                if known.is_empty() { String::from("it has none") } else { format!("it has {}", all_of(&known)) };
            return Err(Error::Usage(format!("-D {name}: {} has no parameter of that name; {valid}", path.display())));
        }
    }
    Ok(root)
}

/// What the files of a scene share while they are read.
struct Reader {
    parameters: Parameters,
    /// Bytes so far. Files that include two others each become very many.
    bytes: u64,
    /// Elements so far.
    elements: u32,
}

/// One file while it is read.
struct File<'a> {
    path: Rc<Path>,
    text: &'a str,
    /// A byte of the text, and the line that it is in.
    at: (usize, u32),
    /// Files that led to this one.
    includes: usize,
}

impl File<'_> {
    /// The line of a byte that is not before the last one that was asked for.
    fn line(&mut self, byte: usize) -> u32 {
        let (before, line) = self.at;
        let more = self.text.as_bytes()[before..byte].iter().filter(|byte| **byte == b'\n').count();
        self.at = (byte, line + more as u32);
        self.at.1
    }
}

impl Reader {
    fn read_file(&mut self, path: &Path, includes: usize) -> Result<Element> {
        let text = read_text(path, XML_BYTES)?;
        self.bytes += text.len() as u64;
        if self.bytes > XML_BYTES {
            let message = format!("with all files that were included the scene has more than {XML_BYTES} bytes of XML");
            return Err(Error::scene(path, message));
        }
        // Text between elements counts as nodes of its own.
        let options = roxmltree::ParsingOptions { nodes_limit: 4 * XML_ELEMENTS, ..Default::default() };
        let document = roxmltree::Document::parse_with_options(&text, options).map_err(|error| match error {
            roxmltree::Error::NodesLimitReached => too_many(path),
            roxmltree::Error::DtdDetected => {
                Error::scene(path, "a document type (<!DOCTYPE>) and its entities are not read")
            }
            error => {
                let text = error.to_string();
                let at = format!(" at {}", error.pos());
                let message = format!("not well-formed XML: {}", text.trim_end_matches(&at));
                Error::scene_line(path, error.pos().row, message)
            }
        })?;
        let mut file = File { path: Rc::from(path), text: &text, at: (0, 1), includes };
        let mut elements = self.read_node(document.root_element(), &mut file, 0)?;
        match (elements.pop(), elements.is_empty()) {
            (Some(root), true) => Ok(root),
            _ => Err(Error::scene(path, "the root element must be an object such as <scene>")),
        }
    }

    /// An element; an `<include>` stands for what the other file's root holds, a `<default>` for nothing.
    fn read_node(&mut self, node: roxmltree::Node<'_, '_>, file: &mut File<'_>, depth: usize) -> Result<Vec<Element>> {
        let mut element = Element {
            tag: node.tag_name().name().to_owned(),
            attributes: BTreeMap::new(),
            children: Vec::new(),
            file: file.path.clone(),
            line: file.line(node.range().start),
        };
        if depth > DEPTH {
            return Err(element.error(format!("elements are nested more than {DEPTH} deep")));
        }
        self.elements += 1;
        if self.elements > XML_ELEMENTS {
            return Err(too_many(&file.path));
        }
        for attribute in node.attributes() {
            let value = self.parameters.replace(attribute.value()).map_err(|message| element.error(message))?;
            element.attributes.insert(attribute.name().to_owned(), value);
        }
        match element.tag.as_str() {
            "default" => {
                let (name, value) = (element.attribute("name")?.to_owned(), element.attribute("value")?.to_owned());
                self.parameters.declared.insert(name.clone());
                self.parameters.values.entry(name).or_insert(value);
                return Ok(Vec::new());
            }
            "include" => return self.include(&element, file),
            _ => {}
        }
        for child in node.children().filter(roxmltree::Node::is_element) {
            element.children.extend(self.read_node(child, file, depth + 1)?);
        }
        Ok(vec![element])
    }

    fn include(&mut self, element: &Element, file: &File<'_>) -> Result<Vec<Element>> {
        if file.includes >= INCLUDES {
            return Err(element.error(format!("files include each other more than {INCLUDES} deep: is this a cycle?")));
        }
        let included = resolve(&file.path, element.attribute("filename")?);
        let root = self.read_file(&included, file.includes + 1).map_err(|error| match error {
            Error::File { cause, .. } => {
                element.error(format!("cannot read the included file {}: {cause}", included.display()))
            }
            other => other,
        })?;
        Ok(if root.tag == "scene" { root.children } else { vec![root] })
    }
}

fn too_many(path: &Path) -> Error {
    Error::scene(path, format!("with all files that were included the scene has more than {XML_ELEMENTS} elements"))
}

/// A path in a scene file is relative to that file.
pub(super) fn resolve(file: &Path, name: &str) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(name)
}

impl Parameters {
    /// The text with each `$name` replaced.
    fn replace(&self, text: &str) -> Result<String, String> {
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            out.push_str(&rest[..at]);
            rest = &rest[at + 1..];
            let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
            // The longest known name wins, so that "$size_x" may mean "$size" followed by "_x".
            let name = (1..=end).rev().map(|end| &rest[..end]).find(|name| self.values.contains_key(*name));
            let Some(name) = name else {
                let known = if self.values.is_empty() {
                    String::from("none is defined")
                } else {
                    format!("defined are {}", all_of(self.values.keys()))
                };
                return Err(format!(
                    "the parameter '${}' is not defined; {known}. Give it with -D name=value or <default>",
                    &rest[..end]
                ));
            };
            self.used.borrow_mut().insert(name.to_owned());
            let value = &self.values[name];
            self.bytes.set(self.bytes.get() + value.len());
            if self.bytes.get() > PARAMETER_BYTES {
                return Err(format!(
                    "by '${name}' parameters have stood for more than {PARAMETER_BYTES} bytes of text"
                ));
            }
            out.push_str(value);
            rest = &rest[name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }
}
