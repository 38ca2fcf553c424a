//! Which attributes of meshes the textures of each surface show.

use crate::error::{Error, Result};
use crate::layout::{MATERIAL_BLEND, NONE};
use crate::scene::description::SceneBuilder;
use crate::scene::light::Lamp;
use crate::scene::texture::Pattern;

/// For each surface the attributes that its materials and its mask show, by their indices. Fails where one is to emit: the power of a light is
/// known before its vertices are.
pub(super) fn of_surfaces(description: &SceneBuilder) -> Result<Vec<Vec<usize>>> {
    if description.attributes.is_empty() {
        return Ok(vec![Vec::new(); description.surfaces.len()]);
    }
    let lamps = description.lamps.iter().filter_map(|lamp| match lamp {
        Lamp::Spot { texture, .. } => texture.map(|(texture, _)| texture),
        Lamp::Projector { texture, .. } => Some(*texture),
        _ => None,
    });
    let lit = description.surfaces.iter().filter_map(|surface| surface.emission_texture).chain(lamps);
    for texture in lit {
        let mut shown = Vec::new();
        of_texture(description, texture, &mut shown);
        if let Some(first) = shown.first() {
            let name = &description.attributes[*first];
            let message = format!(
                "a light shows the mesh attribute '{name}': emission may be a number, a colour or a texture of texels"
            );
            return Err(Error::scene(&description.source, message));
        }
    }
    let of_surface = |surface: &crate::scene::SurfaceDescription| {
        let mut shown = Vec::new();
        [surface.front, surface.back].into_iter().flatten().for_each(|side| of_material(description, side, &mut shown));
        if let Some(texture) = surface.mask.and_then(|mask| mask.texture) {
            of_texture(description, texture, &mut shown);
        }
        shown.sort_unstable();
        shown.dedup();
        shown
    };
    Ok(description.surfaces.iter().map(of_surface).collect())
}

fn of_material(description: &SceneBuilder, material: usize, shown: &mut Vec<usize>) {
    let material = &description.materials[material];
    if material.record.kind == MATERIAL_BLEND {
        let blend = &description.blends[material.record.detail as usize];
        of_material(description, blend.first as usize, shown);
        of_material(description, blend.second as usize, shown);
        of_texture(description, blend.weight_texture, shown);
    }
    let maps = &material.textures;
    maps.properties.iter().for_each(|own| of_texture(description, own.texture, shown));
    [maps.normal, maps.bump].into_iter().for_each(|texture| of_texture(description, texture, shown));
}

fn of_texture(description: &SceneBuilder, texture: u32, shown: &mut Vec<usize>) {
    if texture == NONE {
        return;
    }
    let texture = &description.textures[texture as usize];
    if let Pattern::Attribute(index) = texture.pattern {
        shown.push(index);
    }
    texture.squares.into_iter().flatten().for_each(|inner| of_texture(description, inner, shown));
}
