//! `<emitter>`: lights that stand on their own. Area lights belong to their shape.

use glam::{DAffine3, DMat3, DVec3};

use super::loader::Loader;
use super::object::Object;
use super::value::Colour;
use crate::error::Result;
use crate::image::Encoding;
use crate::scene::Camera;
use crate::scene::light::{Falloff, Lamp};
use crate::scene::single;
use crate::scene::texture::{Pattern, TextureDescription, Wrap};

const SUPPORTED: [&str; 6] = ["point", "spot", "directional", "projector", "constant", "envmap"];

impl Loader {
    pub(super) fn add_emitter(&mut self, object: &Object) -> Result<()> {
        sampling_weight(object)?;
        match object.plugin.as_str() {
            "point" => {
                let position = match object.optional_vector("position")? {
                    Some(_) if object.has("to_world") => {
                        return Err(object.error("a point light has 'position' or 'to_world', not both"));
                    }
                    Some(position) => position,
                    None => object.transform("to_world")?.translation,
                };
                let intensity = object.colour("intensity", Colour::Emission, 1.0)?;
                self.builder.lamps.push(Lamp::Point { position, intensity });
            }
            "spot" => {
                let to_world = object.transform("to_world")?;
                let cutoff = object.positive_float("cutoff_angle", 20.0)?;
                let beam_width = object.positive_float("beam_width", cutoff * 0.75)?;
                if beam_width > cutoff || cutoff > 180.0 {
                    return Err(object.error(format!("a spot's beam_width ({beam_width}) must not exceed its cutoff_angle ({cutoff}), nor that 180 degrees")));
                }
                let texture = match object.texture("texture") {
                    Some(texture) => Some((self.make_texture(&texture)?, axes_of(&to_world))),
                    None => None,
                };
                self.builder.lamps.push(Lamp::Spot {
                    position: to_world.translation,
                    direction: to_world.transform_vector3(DVec3::Z).normalize(),
                    intensity: object.colour("intensity", Colour::Emission, 1.0)?,
                    cutoff: cutoff.to_radians(),
                    beam_width: beam_width.to_radians(),
                    falloff: Falloff::Angle,
                    texture,
                });
            }
            "directional" => {
                let direction = match object.optional_vector("direction")? {
                    Some(_) if object.has("to_world") => {
                        return Err(object.error("a directional light has 'direction' or 'to_world', not both"));
                    }
                    Some(direction) => direction,
                    None => object.transform("to_world")?.transform_vector3(DVec3::Z),
                };
                let direction =
                    direction.try_normalize().ok_or_else(|| object.property_error("direction", "it has no length"))?;
                let irradiance = object.colour("irradiance", Colour::Emission, 1.0)?;
                self.builder.lamps.push(Lamp::Directional { direction, irradiance });
            }
            "projector" => {
                let to_world = object.transform("to_world")?;
                let texture = match object.texture("irradiance") {
                    Some(texture) => self.make_texture(&texture)?,
                    None => self.constant_texture(object.colour("irradiance", Colour::Emission, 1.0)?),
                };
                let (fov, axis) = super::sensor::field_of_view(object)?;
                let [width, height] = self.builder.texture_size(texture);
                let half_width =
                    Camera::new("projector", to_world, fov, axis).tan_half_width(f64::from(width), f64::from(height));
                // What Mitsuba makes of it.
                let irradiance = std::f64::consts::PI * object.float("scale", 1.0)?;
                single::check([irradiance])
                    .map_err(|message| object.property_error("scale", format!("pi times it: {message}")))?;
                self.builder.lamps.push(Lamp::Projector {
                    position: to_world.translation,
                    axes: axes_of(&to_world),
                    texture,
                    irradiance: [irradiance; 3],
                    tangents: [half_width, half_width * f64::from(height) / f64::from(width)],
                });
            }
            "envmap" => {
                self.only_environment(object)?;
                let image = self.image(object, Encoding::Srgb)?;
                let mut texture = TextureDescription::new(Pattern::Image(image));
                texture.wrap = [Wrap::Repeat, Wrap::Clamp];
                // As in Mitsuba, the centres of the first and of the last row are the poles.
                let rows = self.builder.image_size(image)[1] as f32;
                texture.map[1] = [0.0, (rows - 1.0) / rows, 0.5 / rows];
                let scale = object.float("scale", 1.0)?;
                object.boolean("mis_compensation", false)?; // how it is sampled changes no mean
                let axes = object.transform("to_world")?.matrix3;
                let texture = self.builder.texture(texture);
                self.builder.background = Some([scale; 3]);
                self.builder.environment = Some((texture, axes));
            }
            "constant" => {
                self.only_environment(object)?;
                self.builder.background = Some(object.colour("radiance", Colour::Emission, 1.0)?);
            }
            // A shape may refer to it.
            "area" if object.id.is_some() => {
                self.radiance(object)?;
                return Ok(());
            }
            "area" => return Err(object.error("an area light must be inside the shape that emits")),
            _ => return Err(object.unknown_plugin(&SUPPORTED)),
        }
        object.finish()
    }

    /// What an area light emits: a radiance, and the texture that multiplies it.
    pub(super) fn radiance(&mut self, object: &Object) -> Result<([f64; 3], Option<u32>)> {
        sampling_weight(object)?;
        let emission = match object.texture("radiance") {
            Some(texture) => ([1.0; 3], Some(self.make_texture(&texture)?)),
            None => (object.colour("radiance", Colour::Emission, 1.0)?, None),
        };
        object.finish()?;
        Ok(emission)
    }

    fn only_environment(&self, object: &Object) -> Result<()> {
        if self.builder.background.is_some() {
            return Err(object.error("the scene has two environments, and may have one"));
        }
        Ok(())
    }
}

/// How often a light is chosen changes no mean.
fn sampling_weight(object: &Object) -> Result<()> {
    object.optional_float("sampling_weight").map(|_| ())
}

/// The axes of a light's own space in the world, unit.
fn axes_of(to_world: &DAffine3) -> DMat3 {
    let m = to_world.matrix3;
    DMat3::from_cols(m.x_axis.normalize(), m.y_axis.normalize(), m.z_axis.normalize())
}
