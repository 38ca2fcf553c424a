//! Objects and their typed properties. A property that nobody asked for is an error that lists what was asked for.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use glam::{DAffine3, DVec3};

use super::document::{Element, resolve};
use super::numbers::{number, numbers, vector};
use super::spectrum::{EQUAL_ENERGY_WHITE, Illuminant, Spectrum, decode_srgb};
use super::transform;
use crate::error::{Error, Result, all_of, one_of};
use crate::scene::load::limits::DEPTH;

/// Elements that are objects: they have a `type` and can be referred to by `id`.
const OBJECTS: [&str; 10] =
    ["scene", "shape", "bsdf", "texture", "emitter", "sensor", "film", "sampler", "rfilter", "integrator"];

/// One object of the scene.
#[derive(Debug)]
pub(super) struct Object {
    pub tag: String,
    pub plugin: String,
    pub id: Option<String>,
    file: Rc<Path>,
    line: u32,
    properties: BTreeMap<String, Property>,
    children: Vec<Child>,
    /// Objects below it on the longest way down, references included.
    depth: usize,
    asked: RefCell<Vec<&'static str>>,
    warnings: Warnings,
}

/// What the user should know about the scene; all of its objects share it.
type Warnings = Rc<RefCell<Vec<String>>>;

#[derive(Debug)]
struct Property {
    value: Value,
    line: u32,
    used: Cell<bool>,
}

#[derive(Debug)]
struct Child {
    name: Option<String>,
    object: Rc<Object>,
    used: Cell<bool>,
}

#[derive(Clone, Debug)]
enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Vector(DVec3),
    Rgb([f64; 3]),
    Uniform(f64),
    /// A spectrum's colours; its samples could be many times the text that names their file.
    Spectrum(SpectrumColours),
    Transform(DAffine3),
}

/// A spectrum as linear sRGB.
#[derive(Clone, Copy, Debug)]
struct SpectrumColours {
    /// Of what emits.
    emission: [f64; 3],
    /// Of what reflects, and of pure numbers.
    reflectance: [f64; 3],
}

impl From<Spectrum> for SpectrumColours {
    fn from(spectrum: Spectrum) -> Self {
        Self {
            emission: spectrum.linear_srgb(Illuminant::EqualEnergy),
            reflectance: spectrum.linear_srgb(Illuminant::D65),
        }
    }
}

impl Value {
    fn kind(&self) -> &'static str {
        match self {
            Self::Float(_) => "a float",
            Self::Integer(_) => "an integer",
            Self::Boolean(_) => "a boolean",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a point or vector",
            Self::Rgb(_) => "an rgb colour",
            Self::Uniform(_) | Self::Spectrum(_) => "a spectrum",
            Self::Transform(_) => "a transform",
        }
    }
}

/// What a colour stands for, which says how a spectrum becomes one: a uniform spectrum is grey as a reflectance or as an
/// unbounded number (an index of refraction), but as an emission it is equal-energy white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Colour {
    Reflectance,
    Unbounded,
    Emission,
}

/// Turns the document into objects, with references resolved.
pub(super) fn parse(root: &Element) -> Result<Rc<Object>> {
    parse_object(root, &mut HashMap::new(), &Warnings::default())
}

type Ids = HashMap<String, Rc<Object>>;

fn parse_object(element: &Element, ids: &mut Ids, warnings: &Warnings) -> Result<Rc<Object>> {
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
        tag: element.tag.clone(),
        plugin: plugin.to_owned(),
        id: element.attributes.get("id").cloned(),
        file: element.file.clone(),
        line: element.line,
        properties: BTreeMap::new(),
        children: Vec::new(),
        depth: 0,
        asked: RefCell::default(),
        warnings: warnings.clone(),
    };
    for child in &element.children {
        if OBJECTS.contains(&child.tag.as_str()) && child.tag != "scene" {
            let name = child.attributes.get("name").cloned();
            object.children.push(Child { name, object: parse_object(child, ids, warnings)?, used: Cell::new(false) });
        } else if child.tag == "ref" {
            let id = child.attribute("id")?;
            let found = ids.get(id).ok_or_else(|| {
                let known = if ids.is_empty() {
                    String::from("none is defined before it")
                } else {
                    format!("defined before it are {}", all_of(sorted(ids)))
                };
                child.error(format!("<ref> to the unknown id '{id}'; {known}"))
            })?;
            let name = child.attributes.get("name").cloned();
            object.children.push(Child { name, object: found.clone(), used: Cell::new(false) });
        } else {
            let (name, value) = parse_property(child)?;
            let property = Property { value, line: child.line, used: Cell::new(false) };
            if object.properties.insert(name.clone(), property).is_some() {
                return Err(child.error(format!("the property '{name}' is given twice")));
            }
        }
    }
    // References make chains that are as long as the file.
    object.depth = object.children.iter().map(|child| child.object.depth + 1).max().unwrap_or(0);
    if object.depth > DEPTH {
        return Err(element.error(format!("objects are nested more than {DEPTH} deep, references included")));
    }
    let object = Rc::new(object);
    if let Some(id) = &object.id
        && ids.insert(id.clone(), object.clone()).is_some()
    {
        return Err(element.error(format!("the id '{id}' is given twice")));
    }
    Ok(object)
}

fn sorted(ids: &Ids) -> Vec<&String> {
    let mut names: Vec<_> = ids.keys().collect();
    names.sort();
    names
}

fn parse_property(element: &Element) -> Result<(String, Value)> {
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
        "boolean" => match element.attribute("value")?.trim() {
            "true" => Value::Boolean(true),
            "false" => Value::Boolean(false),
            _ => return Err(wrong("true or false")),
        },
        "string" => Value::Text(element.attribute("value")?.to_owned()),
        "point" | "vector" => Value::Vector(vector(element, 0.0)?),
        "rgb" => {
            let text = element.attribute("value")?;
            if text.trim_start().starts_with('#') {
                return Err(wrong("one or three linear numbers; give a hexadecimal colour as <srgb>"));
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
        "transform" => Value::Transform(transform::parse(element)?),
        tag => {
            return Err(element.error(format!(
                "<{tag}> is not supported here; supported are {} and {supported}",
                OBJECTS[1..].join(", ")
            )));
        }
    };
    Ok((element.attribute("name")?.to_owned(), value))
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
            let file = resolve(&element.file, name);
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

impl Object {
    /// An error about this object.
    pub fn error(&self, message: impl Into<String>) -> Error {
        Error::scene_line(&self.file, self.line, message)
    }

    /// "bsdf 'diffuse'", for messages.
    pub fn title(&self) -> String {
        match &self.id {
            Some(id) => format!("{} '{}' (id '{id}')", self.tag, self.plugin),
            None if self.plugin.is_empty() => self.tag.clone(),
            None => format!("{} '{}'", self.tag, self.plugin),
        }
    }

    /// An error that the plugin is unknown.
    pub fn unknown_plugin(&self, valid: &[&str]) -> Error {
        self.error(format!("{} '{}' is not supported; supported are {}", self.tag, self.plugin, one_of(valid)))
    }

    fn find(&self, name: &'static str) -> Option<&Property> {
        self.asked.borrow_mut().push(name);
        let found = self.properties.get(name)?;
        found.used.set(true);
        Some(found)
    }

    fn wrong_kind(&self, name: &str, property: &Property, expected: &str) -> Error {
        Error::scene_line(
            &self.file,
            property.line,
            format!("'{name}' of {} is {}, and must be {expected}", self.title(), property.value.kind()),
        )
    }

    /// An error about one of its properties.
    pub fn property_error(&self, name: &str, message: impl Into<String>) -> Error {
        let line = self.properties.get(name).map_or(self.line, |property| property.line);
        Error::scene_line(&self.file, line, format!("'{name}' of {}: {}", self.title(), message.into()))
    }

    /// Whether the property is given.
    pub fn has(&self, name: &str) -> bool {
        self.properties.contains_key(name)
    }

    /// A number, if it is given.
    pub fn optional_float(&self, name: &'static str) -> Result<Option<f64>> {
        self.find(name)
            .map(|property| match property.value {
                Value::Float(value) => Ok(value),
                Value::Integer(value) => Ok(value as f64),
                _ => Err(self.wrong_kind(name, property, "a float")),
            })
            .transpose()
    }

    /// A number.
    pub fn float(&self, name: &'static str, default: f64) -> Result<f64> {
        Ok(self.optional_float(name)?.unwrap_or(default))
    }

    /// A number above zero.
    pub fn positive_float(&self, name: &'static str, default: f64) -> Result<f64> {
        let value = self.float(name, default)?;
        if value > 0.0 { Ok(value) } else { Err(self.property_error(name, format!("{value} is not above 0"))) }
    }

    /// An integer, if it is given.
    pub fn optional_integer(&self, name: &'static str) -> Result<Option<i64>> {
        self.find(name)
            .map(|property| match property.value {
                Value::Integer(value) => Ok(value),
                _ => Err(self.wrong_kind(name, property, "an integer")),
            })
            .transpose()
    }

    /// A truth value.
    pub fn boolean(&self, name: &'static str, default: bool) -> Result<bool> {
        self.find(name).map_or(Ok(default), |property| match property.value {
            Value::Boolean(value) => Ok(value),
            _ => Err(self.wrong_kind(name, property, "a boolean")),
        })
    }

    /// A text, if it is given.
    pub fn optional_text(&self, name: &'static str) -> Result<Option<&str>> {
        self.find(name)
            .map(|property| match &property.value {
                Value::Text(value) => Ok(value.as_str()),
                _ => Err(self.wrong_kind(name, property, "a string")),
            })
            .transpose()
    }

    /// A file that must be named, relative to the scene file.
    pub fn file(&self, name: &'static str) -> Result<PathBuf> {
        let text = self.optional_text(name)?.ok_or_else(|| self.error(format!("{} needs '{name}'", self.title())))?;
        Ok(resolve(&self.file, text))
    }

    /// A point or vector, if it is given.
    pub fn optional_vector(&self, name: &'static str) -> Result<Option<DVec3>> {
        self.find(name)
            .map(|property| match property.value {
                Value::Vector(value) => Ok(value),
                _ => Err(self.wrong_kind(name, property, "a point or vector")),
            })
            .transpose()
    }

    /// A transform; the identity where it is not given.
    pub fn transform(&self, name: &'static str) -> Result<DAffine3> {
        self.find(name).map_or(Ok(DAffine3::IDENTITY), |property| match property.value {
            Value::Transform(value) => Ok(value),
            _ => Err(self.wrong_kind(name, property, "a transform")),
        })
    }

    /// A colour in linear sRGB, if it is given.
    pub fn optional_colour(&self, name: &'static str, role: Colour) -> Result<Option<[f64; 3]>> {
        let Some(property) = self.find(name) else { return Ok(None) };
        let colour = match &property.value {
            Value::Rgb(rgb) => *rgb,
            Value::Float(grey) => [*grey; 3],
            Value::Integer(grey) => [*grey as f64; 3],
            Value::Uniform(level) if role == Colour::Emission => EQUAL_ENERGY_WHITE.map(|channel| channel * level),
            Value::Uniform(level) => [*level; 3],
            Value::Spectrum(spectrum) => self.clamped(name, property, spectrum, role),
            _ => return Err(self.wrong_kind(name, property, "a colour (rgb, spectrum or float)")),
        };
        if colour.iter().any(|channel| *channel < 0.0) {
            return Err(self.property_error(name, format!("{colour:?} is negative")));
        }
        Ok(Some(colour))
    }

    /// A spectrum's colour; what linear sRGB cannot hold is clamped, as Mitsuba does, with a warning.
    fn clamped(&self, name: &str, property: &Property, spectrum: &SpectrumColours, role: Colour) -> [f64; 3] {
        let most = if role == Colour::Reflectance { 1.0 } else { f64::INFINITY };
        let colour = if role == Colour::Emission { spectrum.emission } else { spectrum.reflectance };
        let clamped = colour.map(|channel| channel.clamp(0.0, most));
        if clamped != colour {
            let ([r, g, b], range) = (colour, if most == 1.0 { "0 to 1" } else { "0 or more" });
            self.warnings.borrow_mut().push(format!(
                "{}:{}: '{name}' of {}: the spectrum's colour in linear sRGB is ({r:.4}, {g:.4}, {b:.4}); it was clamped to {range}",
                self.file.display(),
                property.line,
                self.title()
            ));
        }
        clamped
    }

    /// What the user should know about the scene that this object belongs to.
    pub fn take_warnings(&self) -> Vec<String> {
        self.warnings.take()
    }

    /// A colour in linear sRGB.
    pub fn colour(&self, name: &'static str, role: Colour, default: f64) -> Result<[f64; 3]> {
        Ok(self.optional_colour(name, role)?.unwrap_or([default; 3]))
    }

    /// A reflectance, which must lie in 0 to 1.
    pub fn reflectance(&self, name: &'static str, default: f64) -> Result<[f32; 3]> {
        let colour = self.colour(name, Colour::Reflectance, default)?;
        if colour.iter().any(|channel| *channel > 1.0) {
            return Err(
                self.property_error(name, format!("{colour:?} is above 1: a surface cannot reflect more than it gets"))
            );
        }
        Ok(colour.map(|channel| channel as f32))
    }

    /// All objects within, in order.
    pub fn objects(&self) -> Vec<Rc<Object>> {
        self.children
            .iter()
            .map(|child| {
                child.used.set(true);
                child.object.clone()
            })
            .collect()
    }

    /// The objects within of one kind, in order.
    pub fn objects_of(&self, tag: &str) -> Vec<Rc<Object>> {
        self.children
            .iter()
            .filter(|child| child.object.tag == tag)
            .map(|child| {
                child.used.set(true);
                child.object.clone()
            })
            .collect()
    }

    /// The texture that stands for a property, if there is one.
    pub fn texture(&self, name: &'static str) -> Option<Rc<Object>> {
        self.asked.borrow_mut().push(name);
        let child =
            self.children.iter().find(|child| child.object.tag == "texture" && child.name.as_deref() == Some(name))?;
        child.used.set(true);
        Some(child.object.clone())
    }

    /// At most one object within of one kind.
    pub fn object_of(&self, tag: &str) -> Result<Option<Rc<Object>>> {
        let mut found = self.objects_of(tag);
        match found.len() {
            0 | 1 => Ok(found.pop()),
            count => Err(self.error(format!("{} has {count} <{tag}>, and may have one", self.title()))),
        }
    }

    /// Fails if something was given that nobody asked for.
    pub fn finish(&self) -> Result<()> {
        if let Some((name, property)) = self.properties.iter().find(|(_, property)| !property.used.get()) {
            let mut asked = self.asked.borrow().clone();
            asked.sort_unstable();
            asked.dedup();
            let valid =
                if asked.is_empty() { String::from("it has none") } else { format!("valid are {}", all_of(asked)) };
            return Err(Error::scene_line(
                &self.file,
                property.line,
                format!("{} has no parameter '{name}'; {valid}", self.title()),
            ));
        }
        match self.children.iter().find(|child| !child.used.get()) {
            Some(Child { name: Some(name), object, .. }) if object.tag == "texture" => {
                Err(self.error(format!("'{name}' of {} is a texture, and must be a value", self.title())))
            }
            Some(child) => {
                Err(child.object.error(format!("<{}> is not supported within {}", child.object.tag, self.title())))
            }
            None => Ok(()),
        }
    }
}
