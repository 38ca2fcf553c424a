//! The text of a scene file: XML, with `<include>`, `<default>` and `$name` resolved.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::Defines;
use crate::error::{Error, Result, all_of};
use crate::input::read_text;

/// Files that include each other more deeply than this are taken for a cycle.
const MAX_INCLUDES: usize = 16;
/// Elements nested more deeply than this are refused: no scene needs them, and the reader is recursive.
const MAX_DEPTH: usize = 64;
/// Bytes of the largest XML file.
const MAX_BYTES: u64 = 256 << 20;

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
}

/// Reads a file and all that it includes.
pub(super) fn read(path: &Path, defines: &Defines) -> Result<Element> {
    let mut parameters =
        Parameters { values: defines.iter().cloned().collect(), declared: BTreeSet::new(), used: RefCell::default() };
    let root = read_file(path, &mut parameters, 0)?;
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

fn read_file(path: &Path, parameters: &mut Parameters, includes: usize) -> Result<Element> {
    let text = read_text(path, MAX_BYTES)?;
    let document = roxmltree::Document::parse(&text).map_err(|error| {
        let text = error.to_string();
        let at = format!(" at {}", error.pos());
        Error::scene_line(path, error.pos().row, format!("not well-formed XML: {}", text.trim_end_matches(&at)))
    })?;
    let file: Rc<Path> = Rc::from(path);
    let mut elements = read_node(document.root_element(), &file, parameters, includes, 0)?;
    match (elements.pop(), elements.is_empty()) {
        (Some(root), true) => Ok(root),
        _ => Err(Error::scene(path, "the root element must be an object such as <scene>")),
    }
}

/// An element; an `<include>` stands for what the other file's root holds, a `<default>` for nothing.
fn read_node(
    node: roxmltree::Node<'_, '_>,
    file: &Rc<Path>,
    parameters: &mut Parameters,
    includes: usize,
    depth: usize,
) -> Result<Vec<Element>> {
    let line = node.document().text_pos_at(node.range().start).row;
    let mut element = Element {
        tag: node.tag_name().name().to_owned(),
        attributes: BTreeMap::new(),
        children: Vec::new(),
        file: file.clone(),
        line,
    };
    if depth > MAX_DEPTH {
        return Err(element.error(format!("elements are nested more than {MAX_DEPTH} deep")));
    }
    for attribute in node.attributes() {
        let value = parameters.replace(attribute.value()).map_err(|message| element.error(message))?;
        element.attributes.insert(attribute.name().to_owned(), value);
    }
    match element.tag.as_str() {
        "default" => {
            let (name, value) = (element.attribute("name")?.to_owned(), element.attribute("value")?.to_owned());
            parameters.declared.insert(name.clone());
            parameters.values.entry(name).or_insert(value);
            return Ok(Vec::new());
        }
        "include" => {
            if includes >= MAX_INCLUDES {
                return Err(
                    element.error(format!("files include each other more than {MAX_INCLUDES} deep: is this a cycle?"))
                );
            }
            let included = resolve(file, element.attribute("filename")?);
            let root = read_file(&included, parameters, includes + 1).map_err(|error| match error {
                Error::File { cause, .. } => {
                    element.error(format!("cannot read the included file {}: {cause}", included.display()))
                }
                other => other,
            })?;
            return Ok(if root.tag == "scene" { root.children } else { vec![root] });
        }
        _ => {}
    }
    for child in node.children().filter(roxmltree::Node::is_element) {
        element.children.extend(read_node(child, file, parameters, includes, depth + 1)?);
    }
    Ok(vec![element])
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
            out.push_str(&self.values[name]);
            rest = &rest[name.len()..];
        }
        out.push_str(rest);
        Ok(out)
    }
}
