//! Lights of KHR_lights_punctual.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::DVec3;
use gltf::json::extensions::scene::khr_lights_punctual::Type;
use gltf::json::validation::Checked;
use serde::Deserialize;

use super::document::Document;
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
        let Checked::Valid(kind) = light.type_ else {
            return Err(document.wrong(&name, "its type is unknown: valid are directional, point and spot"));
        };
        let intensity = f64::from(document.amount(&name, "intensity", light.intensity)?);
        let mut colour = [0.0; 3];
        for (channel, value) in colour.iter_mut().zip(light.color) {
            *channel = intensity * f64::from(document.amount(&name, "color", value)?);
        }
        if light.range.is_some() {
            builder.warnings.push(format!("{name}: its range is not read: light falls with the distance squared only"));
        }
        let position = placement.to_world.translation;
        let direction = || {
            let direction = placement.to_world.transform_vector3(DVec3::NEG_Z).try_normalize();
            direction.ok_or_else(|| document.wrong(&at, "is scaled to nothing, and its light has no direction"))
        };
        builder.lamps.push(match kind {
            Type::Directional => Lamp::Directional { direction: direction()?, irradiance: colour },
            Type::Point => Lamp::Point { position, intensity: colour },
            Type::Spot => {
                let spot = light.spot.as_ref();
                let inner = spot.map_or(0.0, |spot| spot.inner_cone_angle);
                let outer = spot.map_or(FRAC_PI_4, |spot| spot.outer_cone_angle);
                if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2) {
                    return Err(document.wrong(
                        &name,
                        format!("its cone angles are {inner} and {outer}: the inner one must be 0 or more and less than the outer one, and that at most pi / 2"),
                    ));
                }
                Lamp::Spot {
                    position,
                    direction: direction()?,
                    intensity: colour,
                    cutoff: f64::from(outer),
                    beam_width: f64::from(inner),
                    falloff: Falloff::Cosine,
                    texture: None,
                }
            }
        });
    }
    Ok(())
}
