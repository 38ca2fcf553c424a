//! Materials: metallic-roughness and its extensions, as one layered material.

use std::collections::HashMap;

use gltf::json;
use gltf::json::extensions::material::Volume;
use gltf::json::material::{AlphaMode, NormalTexture};
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use serde::Deserialize;
use serde_json::Map;

use super::buffers::Buffers;
use super::document::Document;
use super::primitives::Wanted;
use super::textures::{ALPHA, BLUE, COLOUR, GREEN, LookUp, RED, Reference, Textures};
use crate::error::Result;
use crate::image::Encoding;
use crate::layout::{
    Layered, MATERIAL_HAS_COLOURS, NONE, PROPERTY_CLEARCOAT, PROPERTY_CLEARCOAT_ROUGHNESS,
    PROPERTY_DIFFUSE_TRANSMISSION, PROPERTY_DIFFUSE_TRANSMISSION_COLOUR, PROPERTY_IRIDESCENCE,
    PROPERTY_IRIDESCENCE_THICKNESS, PROPERTY_LAYERED_ANISOTROPY, PROPERTY_METALLIC, PROPERTY_REFLECTANCE,
    PROPERTY_ROUGHNESS, PROPERTY_SHEEN_COLOUR, PROPERTY_SHEEN_ROUGHNESS, PROPERTY_SPECULAR, PROPERTY_SPECULAR_COLOUR,
    PROPERTY_TRANSMISSION,
};
use crate::scene::material::{MaterialMaps, layered, plain_layers};
use crate::scene::{Mask, SceneBuilder, SurfaceDescription};

/// The strongest absorption, as optical depth over the attenuation distance: where the attenuation colour is black.
const OPAQUE_DEPTH: f32 = 70.0;

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
#[derive(Default)]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<NormalTexture>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
#[derive(Default)]
struct Sheen {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<Info>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<Info>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
#[derive(Default)]
struct Anisotropy {
    anisotropy_strength: f32,
    anisotropy_rotation: f32,
    anisotropy_texture: Option<Info>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Iridescence {
    iridescence_factor: f32,
    iridescence_texture: Option<Info>,
    iridescence_ior: f32,
    iridescence_thickness_minimum: f32,
    iridescence_thickness_maximum: f32,
    iridescence_thickness_texture: Option<Info>,
}

impl Default for Iridescence {
    fn default() -> Self {
        Self {
            iridescence_factor: 0.0,
            iridescence_texture: None,
            iridescence_ior: 1.3,
            iridescence_thickness_minimum: 100.0,
            iridescence_thickness_maximum: 400.0,
            iridescence_thickness_texture: None,
        }
    }
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct DiffuseTransmission {
    diffuse_transmission_factor: f32,
    diffuse_transmission_texture: Option<Info>,
    diffuse_transmission_color_factor: [f32; 3],
    diffuse_transmission_color_texture: Option<Info>,
}

impl Default for DiffuseTransmission {
    fn default() -> Self {
        Self {
            diffuse_transmission_factor: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color_factor: [1.0; 3],
            diffuse_transmission_color_texture: None,
        }
    }
}

#[derive(Deserialize)]
#[serde(default)]
#[derive(Default)]
struct Dispersion {
    dispersion: f32,
}

/// The extensions that change how light is reflected and passed on.
struct Optics {
    anisotropy: Anisotropy,
    film: Iridescence,
    behind: DiffuseTransmission,
    spread: Dispersion,
}

impl Optics {
    fn read(document: &Document, extensions: &Map<String, json::Value>, name: &str) -> Result<Self> {
        Ok(Self {
            anisotropy: document.extension(extensions, "KHR_materials_anisotropy", name)?.unwrap_or_default(),
            film: document.extension(extensions, "KHR_materials_iridescence", name)?.unwrap_or_default(),
            behind: document.extension(extensions, "KHR_materials_diffuse_transmission", name)?.unwrap_or_default(),
            spread: document.extension(extensions, "KHR_materials_dispersion", name)?.unwrap_or_default(),
        })
    }
}

/// A material in the builder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loaded {
    /// What meshes of it are made of.
    pub surface: usize,
    /// It emits: each of its meshes needs a place of its own.
    pub emits: bool,
    /// What it takes of its primitives.
    pub wanted: Wanted,
    material: Option<usize>,
    /// Its mask where vertex colours have an alpha that counts; nothing where that does not count.
    varying: Option<Mask>,
}

/// The materials of a file, each added to the builder when something is first made of it.
pub(super) struct Materials<'a> {
    document: &'a Document,
    textures: Textures<'a>,
    loaded: HashMap<Option<usize>, Loaded>,
}

impl<'a> Materials<'a> {
    pub fn new(document: &'a Document, buffers: &'a Buffers) -> Self {
        Self { document, textures: Textures::new(document, buffers), loaded: HashMap::new() }
    }

    /// The material of that index, or glTF's default, for the primitive that refers to it.
    pub fn get(&mut self, builder: &mut SceneBuilder, index: Option<usize>, element: &str) -> Result<Loaded> {
        if let Some(loaded) = self.loaded.get(&index) {
            return Ok(*loaded);
        }
        let default = json::Material::default();
        let (material, name) = match index {
            None => (&default, String::from("the default material")),
            Some(index) => {
                let material = self.document.get(&self.document.materials, "materials", index, element)?;
                (material, format!("materials[{index}]"))
            }
        };
        let loaded = Reader {
            document: self.document,
            textures: &mut self.textures,
            builder,
            name,
            uv_sets: [0; 2],
            textured: [false; 2],
        }
        .read(material)?;
        self.loaded.insert(index, loaded);
        Ok(loaded)
    }
}

impl Loaded {
    /// Lets vertex colours multiply the base colour, and their alpha its own.
    pub fn with_colours(self, builder: &mut SceneBuilder, has_alpha: bool) {
        if let Some(material) = self.material {
            builder.material_mut(material).record.flags |= MATERIAL_HAS_COLOURS;
        }
        if let Some(mask) = self.varying.filter(|_| has_alpha) {
            let surface = builder.surface_mut(self.surface);
            (surface.mask, surface.has_alpha_colours) = (Some(mask), true);
        }
    }
}

/// A mask where no vertex has an alpha; nothing where it then stops all.
fn constant(mask: Mask) -> Option<Mask> {
    if mask.texture.is_some() {
        return Some(mask);
    }
    let opacity = match mask.cutoff {
        0.0 => mask.opacity,
        cutoff if mask.opacity < cutoff => 0.0,
        _ => 1.0,
    };
    (opacity < 1.0).then_some(Mask { opacity, texture: None, cutoff: 0.0 })
}

/// Reads one material.
struct Reader<'r, 'a> {
    document: &'a Document,
    textures: &'r mut Textures<'a>,
    builder: &'r mut SceneBuilder,
    name: String,
    /// The sets of texture coordinates that its textures are looked up by, and whether any is.
    uv_sets: [u32; 2],
    textured: [bool; 2],
}

/// All textures that a material names.
#[derive(Default)]
struct References {
    base: Option<Reference>,
    metallic_roughness: Option<Reference>,
    normal: Option<Reference>,
    emissive: Option<Reference>,
    transmission: Option<Reference>,
    specular: Option<Reference>,
    specular_colour: Option<Reference>,
    clearcoat: Option<Reference>,
    clearcoat_roughness: Option<Reference>,
    clearcoat_normal: Option<Reference>,
    anisotropy: Option<Reference>,
    iridescence: Option<Reference>,
    iridescence_thickness: Option<Reference>,
    diffuse_transmission: Option<Reference>,
    diffuse_transmission_colour: Option<Reference>,
    sheen_colour: Option<Reference>,
    sheen_roughness: Option<Reference>,
}

impl References {
    /// The sets of texture coordinates to take, of which a surface has two here: first that of the base colour, or else the one that most
    /// textures use; then the one that most others use.
    fn uv_sets(&self) -> [u32; 2] {
        let all = [
            &self.base,
            &self.metallic_roughness,
            &self.normal,
            &self.emissive,
            &self.transmission,
            &self.specular,
            &self.specular_colour,
            &self.clearcoat,
            &self.clearcoat_roughness,
            &self.clearcoat_normal,
            &self.anisotropy,
            &self.iridescence,
            &self.iridescence_thickness,
            &self.diffuse_transmission,
            &self.diffuse_transmission_colour,
            &self.sheen_colour,
            &self.sheen_roughness,
        ];
        let sets: Vec<u32> = all.into_iter().flatten().map(|reference| reference.set).collect();
        let uses = |set: u32| sets.iter().filter(|other| **other == set).count();
        // Of equals, the first one.
        let most = |but: Option<u32>| {
            let others = sets.iter().rev().copied().filter(|set| Some(*set) != but);
            others.max_by_key(|set| uses(*set)).unwrap_or(0)
        };
        let first = self.base.as_ref().map_or_else(|| most(None), |base| base.set);
        [first, most(Some(first))]
    }
}

impl Reader<'_, '_> {
    fn warn(&mut self, message: &str) {
        self.builder.warnings.push(format!("{}: {message}", self.name));
    }

    /// A texture as an index, or [`NONE`].
    fn texture(&mut self, what: &str, reference: &Option<Reference>, encoding: Encoding, channel: u32) -> Result<u32> {
        let Some(reference) = reference else { return Ok(NONE) };
        let Some(place) = self.uv_sets.iter().position(|set| *set == reference.set) else {
            let (set, [first, second]) = (reference.set, self.uv_sets);
            self.warn(&format!(
                "its {what} uses TEXCOORD_{set} and is not read: a material has two sets of texture coordinates here, TEXCOORD_{first} and TEXCOORD_{second}"
            ));
            return Ok(NONE);
        };
        let looked_up = LookUp { encoding, channel, by_second_uvs: place == 1 };
        let added = self.textures.add(self.builder, reference, &format!("{}.{what}", self.name), looked_up)?;
        self.textured[place] |= added.is_some();
        Ok(added.unwrap_or(NONE))
    }

    fn read(mut self, material: &json::Material) -> Result<Loaded> {
        let document = self.document;
        let name = self.name.clone();
        let empty = Default::default();
        let extensions = material.extensions.as_ref().unwrap_or(&empty);
        let clearcoat: Clearcoat =
            document.extension(&extensions.others, "KHR_materials_clearcoat", &name)?.unwrap_or_default();
        let sheen: Sheen = document.extension(&extensions.others, "KHR_materials_sheen", &name)?.unwrap_or_default();
        let specular = extensions.specular.clone().unwrap_or_default();
        let transmission = extensions.transmission.clone().unwrap_or_default();
        let pbr = &material.pbr_metallic_roughness;
        let optics = Optics::read(document, &extensions.others, &name)?;
        let of = |info: &Option<Info>| info.as_ref().map(Reference::new);
        let normal = |info: &Option<NormalTexture>, what: &str| {
            let info = info.as_ref();
            info.map(|info| Reference::normal(document, info, &format!("{name}.{what}"))).transpose()
        };
        let references = References {
            base: of(&pbr.base_color_texture),
            metallic_roughness: of(&pbr.metallic_roughness_texture),
            normal: normal(&material.normal_texture, "normalTexture")?,
            emissive: of(&material.emissive_texture),
            transmission: of(&transmission.transmission_texture),
            specular: of(&specular.specular_texture),
            specular_colour: of(&specular.specular_color_texture),
            clearcoat: of(&clearcoat.clearcoat_texture),
            clearcoat_roughness: of(&clearcoat.clearcoat_roughness_texture),
            clearcoat_normal: normal(&clearcoat.clearcoat_normal_texture, "clearcoatNormalTexture")?,
            anisotropy: of(&optics.anisotropy.anisotropy_texture),
            iridescence: of(&optics.film.iridescence_texture),
            iridescence_thickness: of(&optics.film.iridescence_thickness_texture),
            diffuse_transmission: of(&optics.behind.diffuse_transmission_texture),
            diffuse_transmission_colour: of(&optics.behind.diffuse_transmission_color_texture),
            sheen_colour: of(&sheen.sheen_color_texture),
            sheen_roughness: of(&sheen.sheen_roughness_texture),
        };
        self.uv_sets = references.uv_sets();
        let [red, green, blue, alpha] = document.shares(&name, "baseColorFactor", pbr.base_color_factor.0)?;
        let base = [red, green, blue];
        let base_texture = self.texture("baseColorTexture", &references.base, Encoding::Srgb, COLOUR)?;
        let varying = self.mask(material, alpha, &references.base)?;
        let mask = varying.and_then(constant);
        if extensions.unlit.is_some() {
            self.warn("an unlit material becomes a black surface that emits its base colour at radiance 1, and lights the scene");
            let masks = (mask, varying);
            return Ok(self.finish(None, base, base_texture, masks, material.double_sided));
        }

        let linear = Encoding::Linear;
        let layers = Layered {
            specular: document.share(&name, "specularFactor", specular.specular_factor.0)?,
            specular_colour: self.amounts("specularColorFactor", specular.specular_color_factor.0)?,
            transmission: document.share(&name, "transmissionFactor", transmission.transmission_factor.0)?,
            clearcoat: document.share(&name, "clearcoatFactor", clearcoat.clearcoat_factor)?,
            clearcoat_roughness: document.share(
                &name,
                "clearcoatRoughnessFactor",
                clearcoat.clearcoat_roughness_factor,
            )?,
            sheen_colour: document.shares(&name, "sheenColorFactor", sheen.sheen_color_factor)?,
            sheen_roughness: document.share(&name, "sheenRoughnessFactor", sheen.sheen_roughness_factor)?,
            clearcoat_normal_texture: self.texture(
                "clearcoatNormalTexture",
                &references.clearcoat_normal,
                linear,
                COLOUR,
            )?,
            clearcoat_normal_scale: self.normal_scale(&clearcoat.clearcoat_normal_texture, "clearcoatNormalTexture")?,
            ..plain_layers(document.share(&name, "metallicFactor", pbr.metallic_factor.0)?)
        };
        let layers = self.volume(extensions.volume.as_ref(), layers)?;
        let layers = self.optics(&optics, layers)?;
        let eta =
            self.index_of_refraction(extensions.ior.as_ref().map_or(1.5, |ior| ior.ior.0), layers.transmission)?;
        let roughness = document.share(&name, "roughnessFactor", pbr.roughness_factor.0)?;
        let normal_scale = self.normal_scale(&material.normal_texture, "normalTexture")?;
        let shine = &references.metallic_roughness;
        let mut textures = MaterialMaps {
            normal: self.texture("normalTexture", &references.normal, linear, COLOUR)?,
            normal_scale,
            ..MaterialMaps::default()
        };
        let has_normals = textures.normal != NONE;
        textures.multiply(PROPERTY_REFLECTANCE, base_texture);
        for (property, what, reference, encoding, channel) in [
            (PROPERTY_ROUGHNESS, "metallicRoughnessTexture", shine, linear, GREEN),
            (PROPERTY_METALLIC, "metallicRoughnessTexture", shine, linear, BLUE),
            (PROPERTY_SPECULAR, "specularTexture", &references.specular, linear, ALPHA),
            (PROPERTY_SPECULAR_COLOUR, "specularColorTexture", &references.specular_colour, Encoding::Srgb, COLOUR),
            (PROPERTY_TRANSMISSION, "transmissionTexture", &references.transmission, linear, RED),
            (PROPERTY_CLEARCOAT, "clearcoatTexture", &references.clearcoat, linear, RED),
            (PROPERTY_CLEARCOAT_ROUGHNESS, "clearcoatRoughnessTexture", &references.clearcoat_roughness, linear, GREEN),
            (PROPERTY_LAYERED_ANISOTROPY, "anisotropyTexture", &references.anisotropy, linear, BLUE),
            (PROPERTY_IRIDESCENCE, "iridescenceTexture", &references.iridescence, linear, RED),
            (
                PROPERTY_IRIDESCENCE_THICKNESS,
                "iridescenceThicknessTexture",
                &references.iridescence_thickness,
                linear,
                GREEN,
            ),
            (
                PROPERTY_DIFFUSE_TRANSMISSION,
                "diffuseTransmissionTexture",
                &references.diffuse_transmission,
                linear,
                ALPHA,
            ),
            (
                PROPERTY_DIFFUSE_TRANSMISSION_COLOUR,
                "diffuseTransmissionColorTexture",
                &references.diffuse_transmission_colour,
                Encoding::Srgb,
                COLOUR,
            ),
            (PROPERTY_SHEEN_COLOUR, "sheenColorTexture", &references.sheen_colour, Encoding::Srgb, COLOUR),
            (PROPERTY_SHEEN_ROUGHNESS, "sheenRoughnessTexture", &references.sheen_roughness, linear, ALPHA),
        ] {
            textures.multiply(property, self.texture(what, reference, encoding, channel)?);
        }
        let mut description = layered(base, roughness, eta, layers);
        description.textures = textures;
        let id = self.builder.material(description);
        self.builder.name_material(id, &self.name);

        let strength = extensions.emissive_strength.as_ref().map_or(1.0, |emissive| emissive.emissive_strength.0);
        let strength = document.amount(&name, "emissiveStrength", strength)?;
        let factor = self.amounts("emissiveFactor", material.emissive_factor.0)?;
        let product = factor.map(|channel| f64::from(channel) * f64::from(strength));
        document.computed(&name, "emissiveFactor times emissiveStrength", product)?;
        let emission = factor.map(|channel| channel * strength);
        let emissive = if emission == [0.0; 3] {
            NONE
        } else {
            self.texture("emissiveTexture", &references.emissive, Encoding::Srgb, COLOUR)?
        };
        let sets = self.uv_sets;
        let mut loaded = self.finish(Some(id), emission, emissive, (mask, varying), material.double_sided);
        let maps = [&references.normal, &references.clearcoat_normal, &references.anisotropy];
        let map_set = maps.into_iter().flatten().next().map(|map| map.set);
        let wants_tangents = has_normals || layers.anisotropy > 0.0 || layers.clearcoat_normal_texture != NONE;
        loaded.wanted.tangents = wants_tangents.then_some(map_set == Some(sets[1]) && sets[0] != sets[1]);
        loaded.wanted.colours = true;
        Ok(loaded)
    }

    /// The factor of a normal map.
    fn normal_scale(&self, map: &Option<NormalTexture>, what: &str) -> Result<f32> {
        let scale = map.as_ref().map_or(1.0, |map| map.scale);
        if scale.is_finite() {
            return Ok(scale);
        }
        Err(self.document.wrong(&self.name, format!("{what}.scale is not finite")))
    }

    fn amounts(&self, what: &str, values: [f32; 3]) -> Result<[f32; 3]> {
        values.iter().try_for_each(|value| self.document.amount(&self.name, what, *value).map(drop))?;
        Ok(values)
    }

    /// Adds the surface.
    fn finish(
        self,
        material: Option<usize>,
        emission: [f32; 3],
        emission_texture: u32,
        (mask, varying): (Option<Mask>, Option<Mask>),
        double_sided: bool,
    ) -> Loaded {
        let surface = self.builder.surface(SurfaceDescription {
            front: material,
            back: material.filter(|_| double_sided),
            emission: emission.map(f64::from),
            emission_texture: Some(emission_texture).filter(|texture| *texture != NONE),
            emits_behind: double_sided,
            mask,
            has_alpha_colours: false,
        });
        let emits = emission != [0.0; 3];
        let wanted = Wanted {
            uv_sets: [
                (self.textured[0] || self.textured[1]).then_some(self.uv_sets[0]),
                self.textured[1].then_some(self.uv_sets[1]),
            ],
            opacity: varying.is_some(),
            ..Wanted::default()
        };
        Loaded { surface, emits, wanted, material, varying }
    }

    /// What the alpha of the base colour lets through, where it counts.
    fn mask(&mut self, material: &json::Material, alpha: f32, base: &Option<Reference>) -> Result<Option<Mask>> {
        let cutoff = match material.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => return Ok(None),
            Checked::Valid(AlphaMode::Mask) => {
                let cutoff = material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                self.document.amount(&self.name, "alphaCutoff", cutoff)?
            }
            Checked::Valid(AlphaMode::Blend) => 0.0,
            Checked::Invalid => {
                return Err(self
                    .document
                    .wrong(&self.name, "its alphaMode is unknown: valid are OPAQUE, MASK and BLEND"));
            }
        };
        let is_mask = material.alpha_mode == Checked::Valid(AlphaMode::Mask);
        if is_mask && cutoff == 0.0 {
            return Ok(None); // no alpha is below it
        }
        let texture = self.texture("baseColorTexture", base, Encoding::Srgb, ALPHA)?;
        let texture = Some(texture).filter(|texture| *texture != NONE);
        Ok(Some(Mask { opacity: f64::from(alpha), texture, cutoff: f64::from(cutoff) }))
    }

    /// Puts in what KHR_materials_volume says. Its thickness only says that there is an inside: paths go through the mesh.
    fn volume(&self, volume: Option<&Volume>, layers: Layered) -> Result<Layered> {
        let Some(volume) = volume else { return Ok(layers) };
        let thickness = self.document.amount(&self.name, "thicknessFactor", volume.thickness_factor.0)?;
        let distance = volume.attenuation_distance.0;
        if distance.is_nan() || distance <= 0.0 {
            return Err(self
                .document
                .wrong(&self.name, format!("attenuationDistance is {distance}, and must be above 0")));
        }
        let colour = self.document.shares(&self.name, "attenuationColor", volume.attenuation_color.0)?;
        let depth = |channel: f32| (-channel.ln()).clamp(0.0, OPAQUE_DEPTH);
        let absorption = colour.map(|channel| if distance.is_finite() { depth(channel) / distance } else { 0.0 });
        let what = format!("the absorption of attenuationColor over attenuationDistance ({distance:e})");
        self.document.computed(&self.name, &what, absorption.map(f64::from))?;
        Ok(Layered { absorption, is_volume: u32::from(thickness > 0.0), ..layers })
    }

    /// Puts in anisotropy, iridescence, diffuse transmission and dispersion.
    fn optics(&self, Optics { anisotropy, film, behind, spread }: &Optics, layers: Layered) -> Result<Layered> {
        let (document, name) = (self.document, &self.name);
        let rotation = anisotropy.anisotropy_rotation;
        if !rotation.is_finite() {
            return Err(document.wrong(name, "anisotropyRotation is not finite"));
        }
        let eta = film.iridescence_ior;
        if !(eta.is_finite() && eta >= 1.0) {
            return Err(document.wrong(name, format!("iridescenceIor is {eta}, and must be 1 or more")));
        }
        let amount = |what: &str, value: f32| document.amount(name, what, value);
        let share = |what: &str, value: f32| document.share(name, what, value);
        let colour = behind.diffuse_transmission_color_factor;
        Ok(Layered {
            anisotropy: share("anisotropyStrength", anisotropy.anisotropy_strength)?,
            anisotropy_direction: [rotation.cos(), rotation.sin()],
            iridescence: share("iridescenceFactor", film.iridescence_factor)?,
            iridescence_eta: eta,
            // Without a texture the thickness is the largest.
            iridescence_thickness: amount("iridescenceThicknessMaximum", film.iridescence_thickness_maximum)?,
            iridescence_least: amount("iridescenceThicknessMinimum", film.iridescence_thickness_minimum)?,
            diffuse_transmission: share("diffuseTransmissionFactor", behind.diffuse_transmission_factor)?,
            diffuse_transmission_colour: document.shares(name, "diffuseTransmissionColorFactor", colour)?,
            dispersion: amount("dispersion", spread.dispersion)?,
            ..layers
        })
    }

    fn index_of_refraction(&mut self, index: f32, transmission: f32) -> Result<f32> {
        // 0 stands for a surface that reflects everything at its edge; nothing can be refracted by it.
        if index == 0.0 && transmission > 0.0 {
            self.warn("its index of refraction is 0, which cannot transmit: 1.5 stands in");
            return Ok(1.5);
        }
        if index == 0.0 || (index.is_finite() && index >= 1.0) {
            return Ok(index);
        }
        Err(self.document.wrong(&self.name, format!("ior is {index}, and must be 0, or 1 or more")))
    }
}
