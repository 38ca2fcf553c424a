//! The text of a scene file: XML, with `<include>`, `<default>`, `<path>` and `$name` resolved.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::error::{Error, Result, some_of};
use crate::files::read_text;
use crate::scene::load::limits::{DEPTH, INCLUDES, PARAMETER_BYTES, XML_BYTES, XML_ELEMENTS};

/// One XML element; parameters are already replaced in its attributes.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub tag: String,
    pub attributes: BTreeMap<String, String>,
    pub children: Vec<Element>,
    pub file: Rc<SourceFile>,
    pub line: u32,
}

/// A file of the scene, and what it says of how it is to be read.
#[derive(Debug)]
pub(super) struct SourceFile {
    pub path: PathBuf,
    /// Its version is below 2: names are spelled `likeThis`, and colours may be hexadecimal.
    pub is_legacy: bool,
    /// The folders of all `<path>` elements that were read so far.
    folders: Rc<RefCell<Vec<PathBuf>>>,
    /// The folder of the scene that includes this file.
    scene_folder: Rc<Path>,
    /// All files that the scene has named so far.
    named: Named,
}

/// The files that a scene names.
pub(super) type Named = Rc<RefCell<Vec<PathBuf>>>;

impl SourceFile {
    /// The file that a scene means by a name. It is looked for in the folders of `<path>`, the last one first, beside the file that names
    /// it, beside the scene, and in the working directory. Where there is none it is the one beside the file that names it.
    pub fn resolve(&self, name: &str) -> PathBuf {
        let beside = folder_of(&self.path).join(name);
        let folders = self.folders.borrow();
        let places = folders.iter().rev().map(PathBuf::as_path).map(|folder| folder.join(name));
        let mut places = places.chain([beside.clone(), self.scene_folder.join(name), PathBuf::from(name)]);
        let found = places.find(|place| place.exists()).unwrap_or(beside);
        self.named.borrow_mut().push(found.clone());
        found
    }

    /// All files that the scene has named so far.
    pub fn named(&self) -> Vec<PathBuf> {
        self.named.borrow().clone()
    }
}

/// The folder that a file lies in; empty for the working directory.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

impl Element {
    /// An error about this element.
    pub fn error(&self, message: impl Into<String>) -> Error {
        Error::scene_line(&self.file.path, self.line, message)
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
    let scene_folder = Rc::from(folder_of(path));
    let mut reader =
        Reader { parameters, folders: Rc::default(), scene_folder, named: Rc::default(), bytes: 0, elements: 0 };
    let root = reader.read_file(path, 0)?;
    let parameters = reader.parameters;
    let known: BTreeSet<String> = parameters.declared.union(&parameters.used.borrow()).cloned().collect();
    for (name, _) in defines {
        if !known.contains(name) {
            let known = some_of(known.iter().map(String::as_str), "parameters", name);
            let message = format!("-D {name}: {} has no parameter of that name; it has {known}", path.display());
            return Err(Error::Usage(message));
        }
    }
    Ok(root)
}

/// What the files of a scene share while they are read.
struct Reader {
    parameters: Parameters,
    folders: Rc<RefCell<Vec<PathBuf>>>,
    scene_folder: Rc<Path>,
    named: Named,
    /// Bytes so far. Files that include two others each become very many.
    bytes: u64,
    /// Elements so far.
    elements: u32,
}

/// One file while it is read.
struct File<'a> {
    source: Rc<SourceFile>,
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
        let version = document.root_element().attribute("version");
        let is_legacy = is_legacy(version).map_err(|message| Error::scene(path, message))?;
        let (folders, scene_folder, named) = (self.folders.clone(), self.scene_folder.clone(), self.named.clone());
        let source = SourceFile { path: path.to_owned(), is_legacy, folders, scene_folder, named };
        let mut file = File { source: Rc::new(source), text: &text, at: (0, 1), includes };
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
            file: file.source.clone(),
            line: file.line(node.range().start),
        };
        if depth > DEPTH {
            return Err(element.error(format!("elements are nested more than {DEPTH} deep")));
        }
        self.elements += 1;
        if self.elements > XML_ELEMENTS {
            return Err(too_many(&file.source.path));
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
            "path" => {
                self.add_folder(&element)?;
                return Ok(Vec::new());
            }
            _ => {}
        }
        for child in node.children().filter(roxmltree::Node::is_element) {
            element.children.extend(self.read_node(child, file, depth + 1)?);
        }
        Ok(vec![element])
    }

    /// Adds a folder in which files are looked for.
    fn add_folder(&mut self, element: &Element) -> Result<()> {
        let name = element.attribute("value")?;
        let folder = element.file.resolve(name);
        if !folder.is_dir() {
            return Err(element.error(format!("<path>: there is no folder {}", folder.display())));
        }
        self.folders.borrow_mut().push(folder);
        Ok(())
    }

    fn include(&mut self, element: &Element, file: &File<'_>) -> Result<Vec<Element>> {
        if file.includes >= INCLUDES {
            return Err(element.error(format!("files include each other more than {INCLUDES} deep: is this a cycle?")));
        }
        let included = element.file.resolve(element.attribute("filename")?);
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

/// Whether a scene's version is below 2, which was written otherwise: versions 0.5 and 0.6 are those of the first Mitsuba. A file without
/// a version is taken for a new one.
fn is_legacy(version: Option<&str>) -> Result<bool, String> {
    let Some(text) = version else { return Ok(false) };
    let major = text.trim().split('.').next().and_then(|major| major.parse::<u32>().ok());
    major.map(|major| major < 2).ok_or_else(|| format!("the version '{text}' is not a version such as 3.0.0"))
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
                let name = &rest[..end];
                let known = some_of(self.values.keys().map(String::as_str), "parameters", name);
                return Err(format!(
                    "the parameter '${name}' is not defined; defined: {known}. Give it with -D name=value or <default>"
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
