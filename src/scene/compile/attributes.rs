//! Which attributes of meshes the textures of each surface show.

use std::collections::HashSet;

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
    // What emits has masks without them as well: a light sample knows no attributes.
    let masks = description.surfaces.iter().filter(|surface| surface.emission != [0.0; 3]);
    let masks = masks.filter_map(|surface| surface.mask.and_then(|mask| mask.texture));
    let lit = description.surfaces.iter().filter_map(|surface| surface.emission_texture).chain(masks).chain(lamps);
    for texture in lit {
        let mut walk = Walk::new(description);
        walk.texture(texture);
        if let Some(first) = walk.shown.first() {
            let name = &description.attributes[*first];
            let message = format!(
                "a light shows the mesh attribute '{name}': its emission and its mask may be a number, a colour or a texture of texels"
            );
            return Err(Error::scene(&description.source, message));
        }
    }
    let of_surface = |surface: &crate::scene::SurfaceDescription| {
        let mut walk = Walk::new(description);
        [surface.front, surface.back].into_iter().flatten().for_each(|side| walk.material(side));
        if let Some(texture) = surface.mask.and_then(|mask| mask.texture) {
            walk.texture(texture);
        }
        walk.shown.sort_unstable();
        walk.shown
    };
    Ok(description.surfaces.iter().map(of_surface).collect())
}

/// What materials and textures show, each looked at once: they may share what they hold, and then have far more ways down than there are of them.
struct Walk<'a> {
    description: &'a SceneBuilder,
    materials: HashSet<usize>,
    textures: HashSet<u32>,
    shown: Vec<usize>,
}

impl<'a> Walk<'a> {
    fn new(description: &'a SceneBuilder) -> Self {
        Self { description, materials: HashSet::new(), textures: HashSet::new(), shown: Vec::new() }
    }

    fn material(&mut self, material: usize) {
        if !self.materials.insert(material) {
            return;
        }
        let material = &self.description.materials[material];
        if material.record.kind == MATERIAL_BLEND {
            let blend = &self.description.blends[material.record.detail as usize];
            self.material(blend.first as usize);
            self.material(blend.second as usize);
            self.texture(blend.weight_texture);
        }
        let maps = &material.textures;
        maps.properties.iter().for_each(|own| self.texture(own.texture));
        [maps.normal, maps.bump].into_iter().for_each(|texture| self.texture(texture));
    }

    fn texture(&mut self, texture: u32) {
        if texture == NONE || !self.textures.insert(texture) {
            return;
        }
        let texture = &self.description.textures[texture as usize];
        if let Pattern::Attribute(index) = texture.pattern
            && !self.shown.contains(&index)
        {
            self.shown.push(index);
        }
        texture.squares.into_iter().flatten().for_each(|inner| self.texture(inner));
    }
}
