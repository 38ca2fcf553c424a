//! Turning a document into objects, with references, aliases and the spelling of old versions resolved.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use glam::{DAffine3, DVec3};

use super::constant;
use super::document::Element;
use super::numbers::{number, numbers, vector};
use super::object::{Child, Object, Property, Warnings};
use super::spectrum::{Spectrum, decode_srgb, hexadecimal};
use super::transform;
use super::value::Value;
use crate::error::{Error, Result, one_of, some_of};
use crate::scene::load::limits::DEPTH;

/// Elements that are objects: they have a `type` and can be referred to by `id`. A `<spectrum>` with a `type` is one, too: a texture.
const OBJECTS: [&str; 13] = [
    "scene",
    "shape",
    "bsdf",
    "texture",
    "emitter",
    "sensor",
    "film",
    "sampler",
    "rfilter",
    "integrator",
    "medium",
    "phase",
    "volume",
];

/// Turns the document into objects. References may go to what comes later.
pub(super) fn parse(root: &Element) -> Result<Rc<Object>> {
    let mut parser = Parser::default();
    parser.collect(root)?;
    parser.object(root, 0)
}

/// As [`parse`], but properties that are wrong are left out; returns the errors as well.
pub(super) fn parse_what_is_right(root: &Element) -> Result<(Rc<Object>, Vec<Error>)> {
    let mut parser = Parser { wrong: Some(Vec::new()), ..Parser::default() };
    parser.collect(root)?;
    let object = parser.object(root, 0)?;
    Ok((object, parser.wrong.unwrap_or_default()))
}

#[derive(Default)]
struct Parser<'a> {
    /// Elements with an id, and what aliases of them stand for.
    elements: HashMap<&'a str, &'a Element>,
    /// Elements that are objects already, by their places in the document.
    made: HashMap<*const Element, Rc<Object>>,
    /// Elements that are being made.
    under_way: HashSet<*const Element>,
    warnings: Warnings,
    /// Where errors of children are gathered, if they do not end it all.
    wrong: Option<Vec<Error>>,
}

fn is_object(element: &Element) -> bool {
    OBJECTS.contains(&element.tag.as_str()) || element.tag == "spectrum" && element.attributes.contains_key("type")
}

impl<'a> Parser<'a> {
    /// Finds all that can be referred to; aliases, which are rare, after what they stand for.
    fn collect(&mut self, root: &'a Element) -> Result<()> {
        let mut aliases = Vec::new();
        let mut left = vec![root];
        while let Some(element) = left.pop() {
            if element.tag == "alias" {
                aliases.push(element);
            } else if is_object(element)
                && let Some(id) = element.attributes.get("id")
                && self.elements.insert(id, element).is_some()
            {
                return Err(element.error(format!("the id '{id}' is given twice")));
            }
            left.extend(element.children.iter().rev());
        }
        for alias in aliases {
            let (id, name) = (alias.attribute("id")?, alias.attribute("as")?);
            let found = self.named(alias, id)?;
            if self.elements.insert(name, found).is_some() {
                return Err(alias.error(format!("<alias>: the id '{name}' is given twice")));
            }
        }
        Ok(())
    }

    /// The element of an id.
    fn named(&self, by: &Element, id: &str) -> Result<&'a Element> {
        self.elements.get(id).copied().ok_or_else(|| {
            let known = some_of(self.elements.keys().copied(), "ids", id);
            by.error(format!("<{}> to the unknown id '{id}'; the scene has {known}", by.tag))
        })
    }

    /// The object that an element is, `depth` objects and references below the root.
    fn object(&mut self, element: &'a Element, depth: usize) -> Result<Rc<Object>> {
        if let Some(made) = self.made.get(&std::ptr::from_ref(element)) {
            return Ok(made.clone());
        }
        if depth > DEPTH {
            return Err(element.error(format!("objects are nested more than {DEPTH} deep, references included")));
        }
        if !self.under_way.insert(element) {
            return Err(element.error(format!("<{}> refers to itself, by way of what is in it", element.tag)));
        }
        let made = self.make(element, depth);
        self.under_way.remove(&std::ptr::from_ref(element));
        let made = made?;
        self.made.insert(element, made.clone());
        Ok(made)
    }

    /// Makes an object with what is in it.
    fn make(&mut self, element: &'a Element, depth: usize) -> Result<Rc<Object>> {
        let allowed: &[&str] = if element.tag == "scene" { &["version"] } else { &["type", "id", "name", "version"] };
        if let Some(unknown) = element.attributes.keys().find(|name| !allowed.contains(&name.as_str())) {
            return Err(element.error(format!(
                "<{}> has no attribute '{unknown}'; valid are {}",
                element.tag,
                one_of(allowed)
            )));
        }
        let plugin = if element.tag == "scene" { "" } else { element.attribute("type")? };
        let mut object = Object {
            tag: if element.tag == "spectrum" { String::from("texture") } else { element.tag.clone() },
            plugin: plugin.to_owned(),
            id: element.attributes.get("id").cloned(),
            file: element.file.clone(),
            line: element.line,
            properties: BTreeMap::new(),
            children: Vec::new(),
            depth: 0,
            constant: None,
            asked: RefCell::default(),
            warnings: self.warnings.clone(),
        };
        for child in &element.children {
            match (self.child(&mut object, child, depth), &mut self.wrong) {
                (Err(error), Some(wrong)) => wrong.push(error),
                (read, _) => read?,
            }
        }
        if element.file.is_legacy {
            upgrade(&mut object)?;
        }
        if element.tag != "scene" && object.plugin == "d65" && !object.children.is_empty() {
            // Light of the colour of daylight is white in RGB, whatever it is multiplied by.
            let of_daylight = object.only_texture()?;
            object.finish()?;
            return Ok(of_daylight);
        }
        object.constant = constant::value_of(&object)?;
        if let Some(constant) = &object.constant {
            constant.check().map_err(|message| object.error(format!("{}: {message}", object.title())))?;
        }
        // References make chains that are as long as the file.
        object.depth = object.children.iter().map(|child| child.object.depth + 1).max().unwrap_or(0);
        if object.depth > DEPTH {
            return Err(element.error(format!("objects are nested more than {DEPTH} deep, references included")));
        }
        Ok(Rc::new(object))
    }

    /// Adds what an element within an object stands for.
    fn child(&mut self, object: &mut Object, child: &'a Element, depth: usize) -> Result<()> {
        if child.tag == "alias" {
            return Ok(());
        }
        if !is_object(child) && child.tag != "ref" {
            let (name, value) = parse_property(child, &self.warnings)?;
            return insert(object, child, name, value);
        }
        let meant = if child.tag == "ref" { self.named(child, child.attribute("id")?)? } else { child };
        let made = self.object(meant, depth + 1)?;
        let name = child.attributes.get("name").map(|name| modern_name(name, child));
        match (name, &made.constant) {
            // What is the same everywhere is a value like any other.
            (Some(name), Some(constant)) => insert(object, child, name, constant.clone()),
            (name, _) => {
                object.children.push(Child { name, object: made, used: Cell::new(false) });
                Ok(())
            }
        }
    }
}

/// Gives an object a property, all numbers of which must fit single precision, products of several included.
fn insert(object: &mut Object, element: &Element, name: String, value: Value) -> Result<()> {
    value.check().map_err(|message| element.error(format!("<{}> '{name}': {message}", element.tag)))?;
    let property = Property { value, line: element.line, used: Cell::new(false) };
    match object.properties.insert(name.clone(), property) {
        Some(_) => Err(element.error(format!("the property '{name}' is given twice"))),
        None => Ok(()),
    }
}

/// A property's name as it is spelled since version 2: `toWorld` became `to_world`, `intIOR` `int_ior`.
fn modern_name(name: &str, element: &Element) -> String {
    if !element.file.is_legacy {
        return name.to_owned();
    }
    let mut modern = String::with_capacity(name.len() + 4);
    let (mut before, mut begins_word) = (' ', false);
    for letter in name.chars() {
        begins_word = letter.is_ascii_uppercase() && (begins_word || before.is_ascii_lowercase());
        if begins_word && before.is_ascii_lowercase() {
            modern.push('_');
        }
        modern.push(if begins_word { letter.to_ascii_lowercase() } else { letter });
        before = letter;
    }
    modern
}

/// Renames what version 2 has renamed, and gathers the map of texture coordinates.
fn upgrade(object: &mut Object) -> Result<()> {
    if object.plugin == "diffuse" {
        if let Some(property) = object.properties.remove("diffuse_reflectance") {
            object.properties.insert(String::from("reflectance"), property);
        }
        for child in &mut object.children {
            if child.name.as_deref() == Some("diffuse_reflectance") {
                child.name = Some(String::from("reflectance"));
            }
        }
    }
    let mut line = None;
    let mut take = |name: &str, default: f64| match object.properties.get(name) {
        Some(Property { value: Value::Float(value), line: at, .. }) => {
            let value = *value;
            line = Some(*at);
            object.properties.remove(name);
            value
        }
        _ => default,
    };
    let offset = DVec3::new(take("uoffset", 0.0), take("voffset", 0.0), 0.0);
    let scale = DVec3::new(take("uscale", 1.0), take("vscale", 1.0), 1.0);
    if let Some(line) = line {
        let map = DAffine3::from_scale(scale) * DAffine3::from_translation(offset);
        let value = Value::Transform(map);
        value.check().map_err(|message| {
            object.error(format!("'uoffset', 'voffset', 'uscale' and 'vscale' of {}: {message}", object.title()))
        })?;
        object.properties.insert(String::from("to_uv"), Property { value, line, used: Cell::new(false) });
    }
    Ok(())
}

fn parse_property(element: &Element, warnings: &Warnings) -> Result<(String, Value)> {
    let supported =
        "float, integer, boolean, string, point, vector, rgb, srgb, spectrum, transform, ref, default and include";
    let wrong = |what: &str| {
        element.error(format!(
            "<{}> '{}': '{}' is not {what}",
            element.tag,
            name_of(element),
            element.attributes.get("value").map_or("", String::as_str)
        ))
    };
    let value = match element.tag.as_str() {
        "float" => Value::Float(number(element.attribute("value")?).ok_or_else(|| wrong("a number"))?),
        "integer" => Value::Integer(element.attribute("value")?.trim().parse().map_err(|_| wrong("an integer"))?),
        "boolean" => match element.attribute("value")?.trim().to_ascii_lowercase().as_str() {
            "true" => Value::Boolean(true),
            "false" => Value::Boolean(false),
            _ => return Err(wrong("true or false")),
        },
        "string" => Value::Text(element.attribute("value")?.to_owned()),
        "point" | "vector" => Value::Vector(vector(element, 0.0)?),
        "rgb" => {
            let text = element.attribute("value")?;
            if text.trim_start().starts_with('#') {
                let bytes = hexadecimal(text).filter(|_| element.file.is_legacy).map(Value::Rgb);
                let wrong = || wrong("one or three linear numbers; give a hexadecimal colour as <srgb>");
                return Ok((property_name(element)?, bytes.ok_or_else(wrong)?));
            }
            match numbers(text).as_deref() {
                Some([grey]) => Value::Rgb([*grey; 3]),
                Some([r, g, b]) => Value::Rgb([*r, *g, *b]),
                _ => return Err(wrong("one or three numbers")),
            }
        }
        "srgb" => {
            let decoded = decode_srgb(element.attribute("value")?);
            Value::Rgb(decoded.ok_or_else(|| wrong("a colour such as #a0b1c2, or three numbers in 0 to 1"))?)
        }
        "spectrum" => parse_spectrum(element)?,
        "transform" => Value::Transform(transform::parse(element, warnings)?),
        tag => {
            return Err(element.error(format!(
                "<{tag}> is not supported here; supported are {} and {supported}",
                OBJECTS[1..].join(", ")
            )));
        }
    };
    Ok((property_name(element)?, value))
}

fn property_name(element: &Element) -> Result<String> {
    Ok(modern_name(element.attribute("name")?, element))
}

/// A uniform spectrum or `wavelength:value` pairs as `value`, or a file of them as `filename`.
fn parse_spectrum(element: &Element) -> Result<Value> {
    let wrong = |message: String| element.error(format!("<spectrum> '{}': {message}", name_of(element)));
    match (element.attributes.get("value"), element.attributes.get("filename")) {
        (Some(text), None) => match number(text) {
            Some(level) => Ok(Value::Uniform(level)),
            None if text.contains(':') => {
                Spectrum::parse(text).map(|spectrum| Value::Spectrum(spectrum.into())).map_err(wrong)
            }
            None => {
                Err(wrong(format!("'{text}' is neither a number nor wavelength:value pairs such as 400:0.1, 700:0.5")))
            }
        },
        (None, Some(name)) => {
            let file = element.file.resolve(name);
            Spectrum::read(&file).map(|spectrum| Value::Spectrum(spectrum.into())).map_err(|error| match error {
                Error::File { cause, .. } => wrong(format!("cannot read {}: {cause}", file.display())),
                other => other,
            })
        }
        _ => Err(wrong(String::from("it needs the attribute 'value' or 'filename', one of the two"))),
    }
}

fn name_of(element: &Element) -> &str {
    element.attributes.get("name").map_or("?", String::as_str)
}
