//! `<emitter>`: lights that stand on their own. Area lights belong to their shape.

use glam::DVec3;

use super::Loader;
use super::object::{Colour, Object};
use crate::error::Result;
use crate::scene::light::{Falloff, Lamp};

const SUPPORTED: [&str; 4] = ["point", "spot", "directional", "constant"];

impl Loader {
    pub(super) fn add_emitter(&mut self, object: &Object) -> Result<()> {
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
                self.builder.lamps.push(Lamp::Spot {
                    position: to_world.translation,
                    direction: to_world.transform_vector3(DVec3::Z).normalize(),
                    intensity: object.colour("intensity", Colour::Emission, 1.0)?,
                    cutoff: cutoff.to_radians(),
                    beam_width: beam_width.to_radians(),
                    falloff: Falloff::Angle,
                    texture: None,
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
            "constant" => {
                if self.builder.background.is_some() {
                    return Err(object.error("the scene has two environments, and may have one"));
                }
                self.builder.background = Some(object.colour("radiance", Colour::Emission, 1.0)?);
            }
            "area" => return Err(object.error("an area light must be inside the shape that emits")),
            _ => return Err(object.unknown_plugin(&SUPPORTED)),
        }
        object.finish()
    }
}
