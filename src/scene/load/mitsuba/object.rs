//! Objects and their typed properties. A property that nobody asked for is an error that lists what was asked for.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;

use glam::{DAffine3, DVec3};

use super::document::SourceFile;
use super::refused;
use super::spectrum::EQUAL_ENERGY_WHITE;
use super::value::{Colour, SpectrumColours, Value};
use crate::error::{Error, Result, all_of, one_of};
use crate::scene::luminance::luminance;
use crate::scene::single;

/// One object of the scene.
#[derive(Debug)]
pub(super) struct Object {
    pub tag: String,
    pub plugin: String,
    pub id: Option<String>,
    pub file: Rc<SourceFile>,
    pub line: u32,
    pub properties: BTreeMap<String, Property>,
    pub children: Vec<Child>,
    /// Objects below it on the longest way down, references included.
    pub depth: usize,
    /// Its value, if it is a texture that is the same everywhere.
    pub constant: Option<Value>,
    pub asked: RefCell<Vec<&'static str>>,
    pub warnings: Warnings,
}

/// What the user should know about the scene; all of its objects share it.
pub(super) type Warnings = Rc<RefCell<Vec<String>>>;

/// A value that an object was given.
#[derive(Debug)]
pub(super) struct Property {
    pub value: Value,
    pub line: u32,
    pub used: Cell<bool>,
}

/// An object that another one holds or refers to.
#[derive(Debug)]
pub(super) struct Child {
    pub name: Option<String>,
    pub object: Rc<Object>,
    pub used: Cell<bool>,
}

impl Object {
    /// An error about this object.
    pub fn error(&self, message: impl Into<String>) -> Error {
        Error::scene_line(&self.file.path, self.line, message)
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
        if let Some(reason) = refused::reason(&self.tag, &self.plugin) {
            return self.error(format!("{} cannot be read: {reason}", self.title()));
        }
        self.error(format!("{} '{}' is not supported; supported are {}", self.tag, self.plugin, one_of(valid)))
    }

    /// Takes note of what was asked for. An object that is used in many places is asked again each time.
    fn note(&self, name: &'static str) {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&name) {
            asked.push(name);
        }
    }

    fn find(&self, name: &'static str) -> Option<&Property> {
        self.note(name);
        let found = self.properties.get(name)?;
        found.used.set(true);
        Some(found)
    }

    fn wrong_kind(&self, name: &str, property: &Property, expected: &str) -> Error {
        Error::scene_line(
            &self.file.path,
            property.line,
            format!("'{name}' of {} is {}, and must be {expected}", self.title(), property.value.kind()),
        )
    }

    /// An error about one of its properties.
    pub fn property_error(&self, name: &str, message: impl Into<String>) -> Error {
        let line = self.properties.get(name).map_or(self.line, |property| property.line);
        Error::scene_line(&self.file.path, line, format!("'{name}' of {}: {}", self.title(), message.into()))
    }

    /// Whether the property is given.
    pub fn has(&self, name: &str) -> bool {
        self.properties.contains_key(name)
    }

    /// Accepts whatever is given.
    pub fn ignore(&self, name: &'static str) {
        self.find(name);
        self.children.iter().filter(|child| child.name.as_deref() == Some(name)).for_each(|child| child.used.set(true));
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

    /// A number that stands for a texture, if it is given: a float, a grey spectrum, or the luminance of a colour.
    pub fn optional_scalar(&self, name: &'static str) -> Result<Option<f64>> {
        match self.properties.get(name).map(|property| &property.value) {
            Some(Value::Uniform(_) | Value::Spectrum(_) | Value::Rgb(_)) => {
                let colour = self.optional_colour(name, Colour::Unbounded)?;
                Ok(colour.map(luminance))
            }
            _ => self.optional_float(name),
        }
    }

    /// A number or three, as they are.
    pub fn raw(&self, name: &'static str) -> Result<Value> {
        let property = self.find(name).ok_or_else(|| self.error(format!("{} needs '{name}'", self.title())))?;
        match &property.value {
            Value::Float(_) | Value::Rgb(_) => Ok(property.value.clone()),
            Value::Integer(value) => Ok(Value::Float(*value as f64)),
            Value::Vector(value) => Ok(Value::Rgb(value.to_array())),
            _ => Err(self.wrong_kind(name, property, "a float or a vector")),
        }
    }

    /// A spectrum, as it is.
    pub fn spectrum(&self, name: &'static str) -> Result<Value> {
        let property = self.find(name).ok_or_else(|| self.error(format!("{} needs '{name}'", self.title())))?;
        match &property.value {
            Value::Uniform(_) | Value::Spectrum(_) => Ok(property.value.clone()),
            _ => Err(self.wrong_kind(name, property, "a spectrum")),
        }
    }

    /// A number.
    pub fn float(&self, name: &'static str, default: f64) -> Result<f64> {
        Ok(self.optional_float(name)?.unwrap_or(default))
    }

    /// A number above zero, in single precision, too.
    pub fn positive_float(&self, name: &'static str, default: f64) -> Result<f64> {
        let value = self.float(name, default)?;
        match value {
            value if value >= f64::from(f32::MIN_POSITIVE) => Ok(value),
            value if value > 0.0 => {
                Err(self.property_error(name, format!("{value:?} is too small: it must be 1.2e-38 or more")))
            }
            value => Err(self.property_error(name, format!("{value} is not above 0"))),
        }
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
        Ok(self.file.resolve(text))
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
        let colour = self.colour_of(name, &property.value, property.line, role);
        let colour = colour.ok_or_else(|| self.wrong_kind(name, property, "a colour (rgb, spectrum or float)"))?;
        if colour.iter().any(|channel| *channel < 0.0) {
            return Err(self.property_error(name, format!("{colour:?} is negative")));
        }
        single::check(colour).map_err(|message| self.property_error(name, message))?;
        Ok(Some(colour))
    }

    /// The colour of this texture, which is the same everywhere.
    pub fn constant_colour(&self, role: Colour) -> Result<[f64; 3]> {
        let colour = self.constant.as_ref().and_then(|value| self.colour_of("value", value, self.line, role));
        let colour = colour.ok_or_else(|| self.error(format!("{} has no colour", self.title())))?;
        single::check(colour).map_err(|message| self.error(format!("{}: {message}", self.title())))?;
        Ok(colour)
    }

    /// A value as a colour, if it can be one.
    fn colour_of(&self, name: &str, value: &Value, line: u32, role: Colour) -> Option<[f64; 3]> {
        Some(match value {
            Value::Rgb(rgb) => *rgb,
            Value::Float(grey) => [*grey; 3],
            Value::Integer(grey) => [*grey as f64; 3],
            Value::Uniform(level) if role == Colour::Emission => EQUAL_ENERGY_WHITE.map(|channel| channel * level),
            Value::Uniform(level) => [*level; 3],
            Value::Spectrum(spectrum) => self.clamped(name, line, spectrum, role),
            _ => return None,
        })
    }

    /// A spectrum's colour; what linear sRGB cannot hold is clamped, as Mitsuba does, with a warning.
    fn clamped(&self, name: &str, line: u32, spectrum: &SpectrumColours, role: Colour) -> [f64; 3] {
        let most = if role == Colour::Reflectance { 1.0 } else { f64::INFINITY };
        let colour = if role == Colour::Emission { spectrum.emission } else { spectrum.reflectance };
        let clamped = colour.map(|channel| channel.clamp(0.0, most));
        if clamped != colour {
            let ([r, g, b], range) = (colour, if most == 1.0 { "0 to 1" } else { "0 or more" });
            self.warnings.borrow_mut().push(format!(
                "{}:{}: '{name}' of {}: the spectrum's colour in linear sRGB is ({r:.4}, {g:.4}, {b:.4}); it was clamped to {range}",
                self.file.path.display(),
                line,
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
        self.note(name);
        let child =
            self.children.iter().find(|child| child.object.tag == "texture" && child.name.as_deref() == Some(name))?;
        child.used.set(true);
        Some(child.object.clone())
    }

    /// The only texture within, whatever its name.
    pub fn only_texture(&self) -> Result<Rc<Object>> {
        self.object_of("texture")?.ok_or_else(|| self.error(format!("{} needs a texture within", self.title())))
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
        self.unasked().into_iter().next().map_or(Ok(()), Err)
    }

    /// An error for all that was given and that nobody asked for.
    pub fn unasked(&self) -> Vec<Error> {
        if self.properties.values().all(|property| property.used.get())
            && self.children.iter().all(|child| child.used.get())
        {
            return Vec::new();
        }
        let mut asked = self.asked.borrow().clone();
        asked.sort_unstable();
        let valid = if asked.is_empty() { String::from("it has none") } else { format!("valid are {}", all_of(asked)) };
        let properties = self.properties.iter().filter(|(_, property)| !property.used.get()).map(|(name, property)| {
            let message = format!("{} has no parameter '{name}'; {valid}", self.title());
            Error::scene_line(&self.file.path, property.line, message)
        });
        let children = self.children.iter().filter(|child| !child.used.get()).map(|child| match child {
            Child { name: Some(name), object, .. } if object.tag == "texture" => {
                self.error(format!("'{name}' of {} is a texture, and must be a value", self.title()))
            }
            Child { object, .. } if refused::reason(&object.tag, &object.plugin).is_some() => {
                object.unknown_plugin(&[])
            }
            child => child.object.error(format!("<{}> is not supported within {}", child.object.tag, self.title())),
        });
        properties.chain(children).collect()
    }
}
