//! MTL entries as surfaces.

use std::collections::BTreeMap;
use std::path::Path;

use super::textures::{Texture, Textures, Use};
use crate::error::{Error, Result};
use crate::layout::{NONE, PROPERTY_METALLIC, PROPERTY_REFLECTANCE, PROPERTY_ROUGHNESS};
use crate::scene::material::{self, MaterialDescription, MaterialMaps};
use crate::scene::{Mask, SceneBuilder, SurfaceDescription};

/// Keywords of the extension for physically based materials (exocortex, 2014) that make a material one, with their images.
const PHYSICAL: [&str; 4] = ["Pr", "Pm", "map_Pr", "map_Pm"];
/// Keywords that change nothing here: ambient light is computed, reflections are traced.
const SILENT: [&str; 4] = ["sharpness", "Tr", "Tf", "map_aat"];

/// A surface in the builder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loaded {
    pub surface: usize,
    pub material: usize,
    /// An image colours, masks or tilts it.
    pub is_textured: bool,
    /// It has a normal map.
    pub wants_tangents: bool,
}

/// Adds entries to a builder.
pub(super) struct Materials<'a> {
    pub builder: &'a mut SceneBuilder,
    pub textures: Textures,
    /// Of how many materials each keyword is not read.
    pub left_out: BTreeMap<String, usize>,
}

/// One entry while it is read.
struct Entry<'e> {
    path: &'e Path,
    described: &'e tobj::Material,
    /// Keywords that were of use.
    used: Vec<&'static str>,
    is_textured: bool,
}

impl Entry<'_> {
    fn number(&self, word: &str) -> Option<f32> {
        self.described.unknown_param.get(word).and_then(|text| text.parse().ok())
    }

    fn share(&self, word: &str) -> Option<f32> {
        self.number(word).map(|value| value.clamp(0.0, 1.0))
    }

    fn image(&self, word: &str) -> Option<&str> {
        let described = self.described;
        let typed = match word {
            "map_Ka" => &described.ambient_texture,
            "map_Kd" => &described.diffuse_texture,
            "map_Ks" => &described.specular_texture,
            "map_Ns" => &described.shininess_texture,
            "map_Bump" => &described.normal_texture,
            "map_d" => &described.dissolve_texture,
            _ => return described.unknown_param.get(word).map(String::as_str),
        };
        typed.as_deref()
    }
}

impl Materials<'_> {
    /// Adds an entry of the MTL file `path`.
    pub fn add(&mut self, path: &Path, described: &tobj::Material) -> Result<Loaded> {
        let mut entry = Entry { path, described, used: Vec::new(), is_textured: false };
        let description = self.describe(&mut entry)?;
        let wants_tangents = description.textures.normal != NONE;
        let material = self.builder.material(description);
        self.builder.name_material(material, &described.name);
        let mask = self.mask(&mut entry)?;
        let emission_image = self.texture(&mut entry, "map_Ke", Use::Colour)?;
        let emission = described.emissive.unwrap_or(if emission_image.is_some() { [1.0; 3] } else { [0.0; 3] });
        if emission.iter().any(|channel| !(0.0..=f64::from(f32::MAX)).contains(channel)) {
            return Err(Error::scene(
                path,
                format!("material '{}': Ke is {emission:?}, and must be 0 or more", described.name),
            ));
        }
        let surface = self.builder.surface(SurfaceDescription {
            front: Some(material),
            back: Some(material),
            emission,
            emission_texture: emission_image.map(|image| image.index),
            mask,
            ..SurfaceDescription::default()
        });
        self.note_left_out(&entry);
        Ok(Loaded { surface, material, is_textured: entry.is_textured, wants_tangents })
    }

    fn texture(&mut self, entry: &mut Entry, word: &'static str, used: Use) -> Result<Option<Texture>> {
        let Some(text) = entry.image(word).map(str::to_owned) else { return Ok(None) };
        let what = format!("material '{}': {word}", entry.described.name);
        let texture = self.textures.add(self.builder, entry.path, &what, &text, used)?;
        entry.used.push(word);
        entry.is_textured |= texture.is_some();
        Ok(texture)
    }

    /// `illum` 4, 6, 7 and 9 are glass; a material with `Pr` or `Pm` is physically based; `illum` 3 and 5 are mirrors; everything else is
    /// diffuse.
    fn describe(&mut self, entry: &mut Entry) -> Result<MaterialDescription> {
        let described = entry.described;
        let colour = |value: Option<[f64; 3]>, default: f64| {
            value.unwrap_or([default; 3]).map(|channel| channel.clamp(0.0, 1.0) as f32)
        };
        let index = described.optical_density.filter(|index| *index > 1.0).unwrap_or(1.5) as f32;
        let is_physical = PHYSICAL.iter().any(|word| described.unknown_param.contains_key(*word));
        let mut description = match described.illumination_model {
            Some(4 | 6 | 7 | 9) => {
                let filter = described.unknown_param.get("Tf").and_then(|text| parse_colour(text)).unwrap_or([1.0; 3]);
                MaterialDescription::from(material::dielectric(index, [1.0; 3], filter, None))
            }
            _ if is_physical => {
                entry.used.extend(["Pr", "Pm", "Pc", "Pcr"]);
                // What an image says is not multiplied by less than it, unless the entry says so.
                let metallic = if entry.image("map_Pm").is_some() { 1.0 } else { 0.0 };
                let mut layers = material::plain_layers(entry.share("Pm").unwrap_or(metallic));
                layers.clearcoat = entry.share("Pc").unwrap_or(0.0);
                layers.clearcoat_roughness = entry.share("Pcr").unwrap_or(0.0);
                let rough = if entry.image("map_Pr").is_some() { 1.0 } else { 0.5 };
                let rough = entry.share("Pr").unwrap_or(rough);
                material::layered(colour(described.diffuse, 0.5), rough, index, layers)
            }
            Some(3 | 5) => {
                let specular = colour(described.specular, 1.0);
                MaterialDescription::from(material::conductor([0.0; 3], [1.0; 3], specular, None))
            }
            _ => MaterialDescription::from(material::diffuse(colour(described.diffuse, 0.5))),
        };
        let index_of = |texture: Option<Texture>| texture.map_or(NONE, |texture| texture.index);
        let mut textures = MaterialMaps::default();
        match described.illumination_model {
            Some(4 | 6 | 7 | 9) => {}
            Some(3 | 5) if !is_physical => {
                entry.used.push("Ks");
                textures.multiply(PROPERTY_REFLECTANCE, index_of(self.texture(entry, "map_Ks", Use::Colour)?));
            }
            _ => {
                if described.diffuse.is_none() && described.diffuse_texture.is_some() {
                    description.record.reflectance = [1.0; 3];
                }
                textures.multiply(PROPERTY_REFLECTANCE, index_of(self.texture(entry, "map_Kd", Use::Colour)?));
            }
        }
        if is_physical && !matches!(described.illumination_model, Some(4 | 6 | 7 | 9)) {
            textures.multiply(PROPERTY_ROUGHNESS, index_of(self.texture(entry, "map_Pr", Use::Number)?));
            textures.multiply(PROPERTY_METALLIC, index_of(self.texture(entry, "map_Pm", Use::Number)?));
        }
        self.relief(entry, &mut textures)?;
        description.textures = textures;
        Ok(description)
    }

    /// `norm` is a normal map; `map_Bump` and `bump` are one where their image has colours, as exporters write them, else heights.
    fn relief(&mut self, entry: &mut Entry, textures: &mut MaterialMaps) -> Result<()> {
        if let Some(normal) = self.texture(entry, "norm", Use::Number)? {
            (textures.normal, textures.normal_scale) = (normal.index, normal.bump);
            entry.used.push("map_Bump");
            return Ok(());
        }
        match self.texture(entry, "map_Bump", Use::Number)? {
            Some(bump) if bump.is_grey => (textures.bump, textures.bump_scale) = (bump.index, bump.bump),
            Some(normal) => (textures.normal, textures.normal_scale) = (normal.index, normal.bump),
            None => {}
        }
        Ok(())
    }

    /// `d`, or 1 - `Tr`, and `map_d`. Of glass they say what `illum` says already.
    fn mask(&mut self, entry: &mut Entry) -> Result<Option<Mask>> {
        if matches!(entry.described.illumination_model, Some(4 | 6 | 7 | 9)) {
            entry.used.push("map_d");
            return Ok(None);
        }
        let (opacity, why) = match (entry.described.dissolve, entry.number("Tr")) {
            (Some(opacity), _) => (opacity.clamp(0.0, 1.0), "d is 0"),
            (None, Some(transparency)) => (1.0 - f64::from(transparency).clamp(0.0, 1.0), "Tr is 1, which is d of 0"),
            (None, None) => (1.0, ""),
        };
        if opacity == 0.0 {
            let name = &entry.described.name;
            self.builder.warnings.push(format!("material '{name}': {why}, and nothing of it is seen"));
        }
        let texture = self.texture(entry, "map_d", Use::Opacity)?.map(|texture| texture.index);
        Ok((opacity < 1.0 || texture.is_some()).then_some(Mask { opacity, texture, cutoff: 0.0 }))
    }

    /// Counts what was in an entry and of no use.
    fn note_left_out(&mut self, entry: &Entry) {
        let described = entry.described;
        let shines = described.specular.is_some_and(|specular| specular.iter().any(|channel| *channel > 0.0));
        let is_glossy = shines && !matches!(described.illumination_model, Some(0 | 1 | 4 | 6 | 7 | 9));
        let mut found: Vec<&str> = ["map_Kd", "map_Ks", "map_Ns", "map_Bump", "map_d"].into_iter().collect();
        found.retain(|word| entry.image(word).is_some());
        found.extend(is_glossy.then_some("Ks"));
        found.extend(described.unknown_param.keys().map(String::as_str).filter(|word| !SILENT.contains(word)));
        found.retain(|word| !entry.used.contains(word));
        found.sort_unstable();
        for word in found {
            // Of what nobody knows a few are enough.
            if self.left_out.len() < 16 || self.left_out.contains_key(word) {
                *self.left_out.entry(word.to_owned()).or_default() += 1;
            }
        }
    }
}

fn parse_colour(text: &str) -> Option<[f32; 3]> {
    let numbers: Vec<f32> = text.split_whitespace().map_while(|part| part.parse().ok()).collect();
    numbers.try_into().ok().filter(|rgb: &[f32; 3]| rgb.iter().all(|channel| (0.0..=1.0).contains(channel)))
}
