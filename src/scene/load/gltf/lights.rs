//! Lights of KHR_lights_punctual.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use serde::Deserialize;

use super::document::{Cones, Document};
use super::nodes::Placement;
use crate::error::Result;
use crate::scene::SceneBuilder;
use crate::scene::light::{Falloff, Lamp};

#[derive(Deserialize)]
struct Punctual {
    light: usize,
}

/// Adds the lights that nodes carry. Candela and lux count as W/sr and W/m² of each channel.
pub(super) fn load(document: &Document, placements: &[Placement], builder: &mut SceneBuilder) -> Result<()> {
    for placement in placements {
        let (node, at) = (&document.nodes[placement.node], placement.element());
        let Some(Punctual { light: index }) = document.extension(&node.extensions, "KHR_lights_punctual", &at)? else {
            continue;
        };
        let light = document.get(&document.lights, "lights", index, &at)?;
        let name = format!("lights[{index}]");
        let amount = |what: &str, value: f64| document.amount(&name, what, value as f32).map(|_| value);
        let intensity = amount("intensity", light.intensity)?;
        let mut colour = [0.0; 3];
        for (channel, value) in colour.iter_mut().zip(light.color) {
            *channel = intensity * amount("color", value)?;
        }
        let colour = document.computed(&name, "intensity times color", colour)?;
        if light.range.is_some() {
            builder.warnings.push(format!("{name}: its range is not read: light falls with the distance squared only"));
        }
        let position = placement.to_world.translation;
        let direction = || {
            let direction = placement.to_world.transform_vector3(DVec3::NEG_Z).try_normalize();
            direction.ok_or_else(|| document.wrong(&at, "is scaled to nothing, and its light has no direction"))
        };
        builder.lamps.push(match light.kind.as_str() {
            "directional" => Lamp::Directional { direction: direction()?, irradiance: colour },
            "point" => Lamp::Point { position, intensity: colour },
            "spot" => {
                // In double precision: what differs by less than single precision is a hard edge, and valid.
                let Cones { inner, outer } = light.spot;
                if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2 * (1.0 + f64::from(f32::EPSILON))) {
                    return Err(document.wrong(
                        &name,
                        format!("its cone angles are {inner} and {outer}: the inner one must be 0 or more and less than the outer one, and that at most pi / 2"),
                    ));
                }
                Lamp::Spot {
                    position,
                    direction: direction()?,
                    intensity: colour,
                    cutoff: outer.min(FRAC_PI_2),
                    beam_width: inner,
                    falloff: Falloff::Cosine,
                    texture: None,
                }
            }
            _ => return Err(document.wrong(&name, "its type is unknown: valid are directional, point and spot")),
        });
    }
    Ok(())
}
