//! `<texture>`: values over texture coordinates.

use std::rc::Rc;

use glam::DAffine3;

use super::loader::Loader;
use super::object::Object;
use super::value::Colour;
use crate::error::{Error, Result, one_of};
use crate::image::{Encoding, read_texture};
use crate::layout::NONE;
use crate::scene::texture::{Pattern, TextureDescription, Wrap};

const SUPPORTED: [&str; 3] = ["bitmap", "checkerboard", "mesh_attribute"];
const WRAPS: [(&str, Wrap); 3] = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];

impl Loader {
    /// The texture that a `<texture>` stands for.
    pub(super) fn make_texture(&mut self, object: &Rc<Object>) -> Result<u32> {
        if let Some(made) = self.textures.get(&Rc::as_ptr(object)) {
            return Ok(*made);
        }
        let mut texture = match object.plugin.as_str() {
            "bitmap" => self.bitmap(object)?,
            "checkerboard" => {
                let mut colours = [[1.0; 3]; 2];
                let mut squares = [None; 2];
                for (index, (name, default)) in [("color0", 0.4), ("color1", 0.2)].into_iter().enumerate() {
                    match object.texture(name) {
                        Some(texture) => squares[index] = Some(self.make_texture(&texture)?),
                        None => {
                            let colour = object.colour(name, Colour::Reflectance, default)?;
                            colours[index] = colour.map(|channel| channel as f32);
                        }
                    }
                }
                let pattern = Pattern::Checkerboard(colours[0], colours[1]);
                TextureDescription { squares, ..TextureDescription::new(pattern) }
            }
            "mesh_attribute" => self.mesh_attribute(object)?,
            _ if object.constant.is_some() => TextureDescription::constant(object.constant_colour(Colour::Unbounded)?),
            _ => return Err(object.unknown_plugin(&SUPPORTED)),
        };
        texture.map = uv_map(&object.transform("to_uv")?);
        object.finish()?;
        let made = self.builder.texture(texture);
        self.textures.insert(Rc::as_ptr(object), made);
        Ok(made)
    }

    /// A texture that is the same everywhere.
    pub(super) fn constant_texture(&mut self, colour: [f64; 3]) -> u32 {
        self.builder.texture(TextureDescription::constant(colour))
    }

    fn mesh_attribute(&mut self, object: &Rc<Object>) -> Result<TextureDescription> {
        let name = object
            .optional_text("name")?
            .ok_or_else(|| object.error("a mesh_attribute needs the 'name' of an attribute, vertex_... or face_..."))?;
        if !name.starts_with("vertex_") && !name.starts_with("face_") {
            return Err(object.property_error("name", format!("'{name}' begins neither with vertex_ nor with face_")));
        }
        let scale = object.float("scale", 1.0)? as f32;
        let attribute = self.builder.attribute(name);
        Ok(TextureDescription { scale: [scale; 4], ..TextureDescription::new(Pattern::Attribute(attribute)) })
    }

    fn bitmap(&mut self, object: &Rc<Object>) -> Result<TextureDescription> {
        let encoding = if object.boolean("raw", false)? { Encoding::Linear } else { Encoding::Srgb };
        let image = self.image(object, encoding)?;
        let mut texture = TextureDescription::new(Pattern::Image(image));
        texture.nearest = match object.optional_text("filter_type")?.unwrap_or("bilinear") {
            "bilinear" => false,
            "nearest" => true,
            other => {
                let message = format!("'{other}' is not {}", one_of(["bilinear", "nearest"]));
                return Err(object.property_error("filter_type", message));
            }
        };
        let wrap = object.optional_text("wrap_mode")?.unwrap_or("repeat");
        let found = WRAPS.iter().find(|(name, _)| *name == wrap).map(|(_, wrap)| *wrap);
        texture.wrap = [found.ok_or_else(|| {
            object.property_error("wrap_mode", format!("'{wrap}' is not {}", one_of(WRAPS.map(|row| row.0))))
        })?; 2];
        object.optional_text("format")?; // how Mitsuba stores it changes no value that is seen
        object.boolean("accel", true)?;
        Ok(texture)
    }

    /// The image file that an object names; each is read once per encoding.
    pub(super) fn image(&mut self, object: &Object, encoding: Encoding) -> Result<usize> {
        let file = object.file("filename")?;
        if let Some(made) = self.images.get(&(file.clone(), encoding)) {
            return Ok(*made);
        }
        let image = read_texture(&file, encoding).map_err(|error| match error {
            Error::File { cause, .. } => {
                object.property_error("filename", format!("cannot read {}: {cause}", file.display()))
            }
            other => other,
        })?;
        let made = self.builder.image(image);
        self.builder.within_limits()?;
        self.images.insert((file, encoding), made);
        Ok(made)
    }

    /// A reflectance and the texture that multiplies it, or [`NONE`].
    pub(super) fn reflectance(&mut self, object: &Object, name: &'static str, default: f64) -> Result<([f32; 3], u32)> {
        match object.texture(name) {
            Some(texture) => Ok(([1.0; 3], self.make_texture(&texture)?)),
            None => Ok((object.reflectance(name, default)?, NONE)),
        }
    }

    /// A number and the texture that multiplies it; a number must lie within `range`.
    pub(super) fn scalar(
        &mut self,
        object: &Object,
        name: &'static str,
        default: f64,
        range: [f64; 2],
    ) -> Result<(f64, u32)> {
        if let Some(texture) = object.texture(name) {
            let made = self.make_texture(&texture)?;
            // Of a number, Mitsuba's checkerboard shows `color1` where it shows `color0` of a colour.
            return Ok((1.0, self.builder.with_squares_exchanged(made)));
        }
        let value = object.optional_scalar(name)?.unwrap_or(default);
        if !(range[0]..=range[1]).contains(&value) {
            return Err(object.property_error(name, format!("{value} is not in {} to {}", range[0], range[1])));
        }
        Ok((value, NONE))
    }
}

/// Rows of the map of texture coordinates that a transform stands for: what it does to the first two.
fn uv_map(map: &DAffine3) -> [[f32; 3]; 2] {
    let m = map.matrix3;
    let row = |x: f64, y: f64, shift: f64| [x as f32, y as f32, shift as f32];
    [row(m.x_axis.x, m.y_axis.x, map.translation.x), row(m.x_axis.y, m.y_axis.y, map.translation.y)]
}
