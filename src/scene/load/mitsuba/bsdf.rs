//! `<bsdf>`: materials.

use std::rc::Rc;

use super::loader::{Loader, Sides};
use super::metals;
use super::object::Object;
use super::value::Colour;
use crate::error::{Result, all_of, one_of};
use crate::layout::{
    MATERIAL_PRINCIPLED_THIN, MATERIAL_THIN_DIELECTRIC, NONE, PROPERTY_ALPHA_U, PROPERTY_ALPHA_V, PROPERTY_ANISOTROPIC,
    PROPERTY_CLEARCOAT_GLOSS, PROPERTY_CONDUCTOR_ETA, PROPERTY_CONDUCTOR_K, PROPERTY_DIFF_TRANS, PROPERTY_ETA,
    PROPERTY_FLATNESS, PROPERTY_METALLIC, PROPERTY_PRINCIPLED_CLEARCOAT, PROPERTY_REFLECTANCE, PROPERTY_ROUGHNESS,
    PROPERTY_SHEEN, PROPERTY_SHEEN_TINT, PROPERTY_SPEC_TINT, PROPERTY_SPEC_TRANS, PROPERTY_TRANSMITTANCE, Principled,
    PropertyTexture,
};
use crate::scene::material::{MaterialDescription, MaterialMaps};
use crate::scene::{Mask, Side, material};

const SUPPORTED: [&str; 16] = [
    "diffuse",
    "conductor",
    "roughconductor",
    "dielectric",
    "roughdielectric",
    "thindielectric",
    "plastic",
    "roughplastic",
    "principled",
    "principledthin",
    "blendbsdf",
    "mask",
    "null",
    "normalmap",
    "bumpmap",
    "twosided",
];

/// Indices of refraction by name, as Mitsuba names them (values at the sodium line, from its documentation's table).
const INDICES: [(&str, f64); 22] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water ice", 1.31),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("fused quartz", 1.458),
    ("carbon tetrachloride", 1.461),
    ("pyrex", 1.470),
    ("glycerol", 1.4729),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("benzene", 1.501),
    ("bk7", 1.5046),
    ("silicone oil", 1.520_45),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("bromine", 1.661),
    ("diamond", 2.419),
];

impl Loader {
    /// What a BSDF stands for.
    pub(super) fn material(&mut self, object: &Rc<Object>) -> Result<Sides> {
        if let Some(made) = self.materials.get(&Rc::as_ptr(object)) {
            return Ok(*made);
        }
        let sides = match object.plugin.as_str() {
            "twosided" => self.two_sided(object)?,
            "blendbsdf" => self.blend(object)?,
            "mask" => self.mask(object)?,
            "null" => Sides { mask: Some(Mask { opacity: 0.0, texture: None, cutoff: 0.0 }), ..Sides::default() },
            "normalmap" => self.normal_map(object)?,
            "bumpmap" => self.bump_map(object)?,
            _ => {
                let made = self.leaf(object)?;
                let made = if self.energy_compensation { made.compensated() } else { made };
                Sides { front: Some(self.builder.material(made)), ..Sides::default() }
            }
        };
        object.finish()?;
        if let Some(id) = &object.id {
            [sides.front, sides.back].into_iter().flatten().for_each(|side| self.builder.name_material(side, id));
        }
        self.materials.insert(Rc::as_ptr(object), sides);
        Ok(sides)
    }

    /// A BSDF that holds no other.
    fn leaf(&mut self, object: &Rc<Object>) -> Result<MaterialDescription> {
        match object.plugin.as_str() {
            "diffuse" => {
                let mut maps = MaterialMaps::default();
                let albedo = self.colour(object, "reflectance", 0.5, PROPERTY_REFLECTANCE, &mut maps)?;
                Ok(MaterialDescription { textures: maps, ..material::diffuse(albedo).into() })
            }
            "conductor" => self.conductor(object, None),
            "roughconductor" => {
                let roughness = self.roughness(object)?;
                self.conductor(object, Some(roughness))
            }
            "dielectric" => self.dielectric(object, None),
            "roughdielectric" => {
                let roughness = self.roughness(object)?;
                self.dielectric(object, Some(roughness))
            }
            "thindielectric" => {
                let (eta, [reflectance, transmittance], maps) = self.glass(object)?;
                let made = material::thin_dielectric(eta, reflectance, transmittance);
                Ok(MaterialDescription { textures: maps, ..made.into() })
            }
            "plastic" => self.plastic(object, None),
            "roughplastic" => {
                let roughness = self.roughness(object)?;
                if roughness.alpha[0] != roughness.alpha[1] || !roughness.textures.is_empty() {
                    return Err(object.property_error("alpha", "the roughness of a roughplastic is one number"));
                }
                self.plastic(object, Some(roughness))
            }
            "principled" => self.principled(object),
            "principledthin" => self.principled_thin(object),
            _ => Err(object.unknown_plugin(&SUPPORTED)),
        }
    }

    /// A colour in 0 to 1, and the texture that multiplies it.
    fn colour(
        &mut self,
        object: &Object,
        name: &'static str,
        default: f64,
        property: u32,
        maps: &mut MaterialMaps,
    ) -> Result<[f32; 3]> {
        let (colour, texture) = self.reflectance(object, name, default)?;
        maps.multiply(property, texture);
        Ok(colour)
    }

    /// A number in 0 to `most`, and the texture that multiplies it.
    fn number(
        &mut self,
        object: &Object,
        name: &'static str,
        [default, most]: [f64; 2],
        property: u32,
        maps: &mut MaterialMaps,
    ) -> Result<f32> {
        let (value, texture) = self.scalar(object, name, default, [0.0, most])?;
        maps.multiply(property, texture);
        Ok(value as f32)
    }

    fn conductor(&mut self, object: &Object, roughness: Option<Roughness>) -> Result<MaterialDescription> {
        let mut maps = MaterialMaps::default();
        let (eta, k) = self.conductor_indices(object, &mut maps)?;
        let reflectance = self.colour(object, "specular_reflectance", 1.0, PROPERTY_REFLECTANCE, &mut maps)?;
        let alpha = roughness.as_ref().map(|roughness| roughness.alpha);
        let made = MaterialDescription { textures: maps, ..material::conductor(eta, k, reflectance, alpha).into() };
        Ok(with_roughness(made, roughness))
    }

    /// The relative index of glass, the factors on what it reflects and transmits, and their textures.
    fn glass(&mut self, object: &Object) -> Result<(f32, [[f32; 3]; 2], MaterialMaps)> {
        let eta = relative_index(object, "bk7")?;
        let mut maps = MaterialMaps::default();
        let reflectance = self.colour(object, "specular_reflectance", 1.0, PROPERTY_REFLECTANCE, &mut maps)?;
        let transmittance = self.colour(object, "specular_transmittance", 1.0, PROPERTY_TRANSMITTANCE, &mut maps)?;
        Ok((eta, [reflectance, transmittance], maps))
    }

    fn dielectric(&mut self, object: &Object, roughness: Option<Roughness>) -> Result<MaterialDescription> {
        let (eta, [reflectance, transmittance], maps) = self.glass(object)?;
        let alpha = roughness.as_ref().map(|roughness| roughness.alpha);
        let made = material::dielectric(eta, reflectance, transmittance, alpha);
        Ok(with_roughness(MaterialDescription { textures: maps, ..made.into() }, roughness))
    }

    fn plastic(&mut self, object: &Object, roughness: Option<Roughness>) -> Result<MaterialDescription> {
        let eta = relative_index(object, "polypropylene")?;
        let mut maps = MaterialMaps::default();
        let diffuse = self.colour(object, "diffuse_reflectance", 0.5, PROPERTY_REFLECTANCE, &mut maps)?;
        let specular = self.colour(object, "specular_reflectance", 1.0, PROPERTY_TRANSMITTANCE, &mut maps)?;
        let nonlinear = object.boolean("nonlinear", false)?;
        let alpha = roughness.as_ref().map(|roughness| roughness.alpha[0]);
        let made = material::plastic(eta, diffuse, specular, nonlinear, alpha);
        Ok(with_roughness(MaterialDescription { textures: maps, ..made }, roughness))
    }

    fn principled(&mut self, object: &Object) -> Result<MaterialDescription> {
        let mut maps = MaterialMaps::default();
        let base = self.colour(object, "base_color", 0.5, PROPERTY_REFLECTANCE, &mut maps)?;
        let roughness = self.number(object, "roughness", [0.5, 1.0], PROPERTY_ROUGHNESS, &mut maps)?;
        let eta = match object.optional_float("eta")? {
            Some(_) if object.has("specular") => {
                return Err(object.error("a principled BSDF has 'eta' or 'specular', not both"));
            }
            Some(eta) if eta >= 1.0 => eta,
            Some(eta) => return Err(object.property_error("eta", format!("{eta} is below 1"))),
            None => 2.0 / (1.0 - (0.08 * object.float("specular", 0.5)?.clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        // How lobes are sampled changes no mean.
        for ignored in [
            "main_specular_sampling",
            "clearcoat_sampling",
            "diffuse_reflectance_sampling",
            "main_specular_sampling_rate",
            "clearcoat_sampling_rate",
            "diffuse_reflectance_sampling_rate",
        ] {
            object.optional_float(ignored)?;
        }
        let mut share = |name, property| self.number(object, name, [0.0, 1.0], property, &mut maps);
        let parameters = Principled {
            metallic: share("metallic", PROPERTY_METALLIC)?,
            anisotropic: share("anisotropic", PROPERTY_ANISOTROPIC)?,
            spec_trans: share("spec_trans", PROPERTY_SPEC_TRANS)?,
            spec_tint: share("spec_tint", PROPERTY_SPEC_TINT)?,
            sheen: share("sheen", PROPERTY_SHEEN)?,
            sheen_tint: share("sheen_tint", PROPERTY_SHEEN_TINT)?,
            flatness: share("flatness", PROPERTY_FLATNESS)?,
            clearcoat: share("clearcoat", PROPERTY_PRINCIPLED_CLEARCOAT)?,
            clearcoat_gloss: share("clearcoat_gloss", PROPERTY_CLEARCOAT_GLOSS)?,
            ..Principled::default()
        };
        let made = material::principled(base, roughness, (eta as f32).max(1.001), parameters);
        Ok(MaterialDescription { textures: maps, ..made })
    }

    fn principled_thin(&mut self, object: &Object) -> Result<MaterialDescription> {
        let mut maps = MaterialMaps::default();
        let base = self.colour(object, "base_color", 0.5, PROPERTY_REFLECTANCE, &mut maps)?;
        let roughness = self.number(object, "roughness", [0.5, 1.0], PROPERTY_ROUGHNESS, &mut maps)?;
        let eta = self.number(object, "eta", [1.5, f64::INFINITY], PROPERTY_ETA, &mut maps)?;
        // How lobes are sampled changes no mean.
        for ignored in [
            "diffuse_reflectance_sampling_rate",
            "specular_reflectance_sampling_rate",
            "specular_transmittance_sampling_rate",
            "diffuse_transmittance_sampling_rate",
        ] {
            object.optional_float(ignored)?;
        }
        let mut share = |name, most, property| self.number(object, name, [0.0, most], property, &mut maps);
        let parameters = Principled {
            anisotropic: share("anisotropic", 1.0, PROPERTY_ANISOTROPIC)?,
            spec_trans: share("spec_trans", 1.0, PROPERTY_SPEC_TRANS)?,
            spec_tint: share("spec_tint", 1.0, PROPERTY_SPEC_TINT)?,
            sheen: share("sheen", 1.0, PROPERTY_SHEEN)?,
            sheen_tint: share("sheen_tint", 1.0, PROPERTY_SHEEN_TINT)?,
            flatness: share("flatness", 1.0, PROPERTY_FLATNESS)?,
            diff_trans: share("diff_trans", 2.0, PROPERTY_DIFF_TRANS)?,
            ..Principled::default()
        };
        if eta < 1.0 {
            return Err(object.property_error("eta", format!("{eta} is below 1")));
        }
        let made = material::principled_thin(base, roughness, eta, parameters);
        Ok(MaterialDescription { textures: maps, ..made })
    }

    fn two_sided(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let nested = object.objects_of("bsdf");
        if nested.is_empty() || nested.len() > 2 {
            return Err(object.error(format!("twosided holds {} BSDFs, and needs one or two", nested.len())));
        }
        let transmission = object.boolean("allow_transmission", false)?;
        if let [inner] = &nested[..]
            && transmission
        {
            let made = self.material(inner)?;
            let [front, back] = [made.front, made.back].map(|side| side.map(|side| self.passage(side)));
            match (front, back) {
                // The same from both sides as it is.
                (None | Some(Passage::Alike), _) => return Ok(made),
                (Some(Passage::None), None) => return Ok(Sides { back: made.front, ..made }),
                _ => {}
            }
            return Err(inner.error(format!(
                "{} has two sides that differ: within a twosided that allows transmission, what transmits is to be the same from both (principledthin, thindielectric, mask, null)",
                inner.title()
            )));
        }
        let mut sides = Vec::new();
        for inner in &nested {
            let made = self.material(inner)?;
            let transmits = made.front.is_some_and(|front| self.builder.material_mut(front).transmits());
            if transmits || made.back.is_some() || made.mask.is_some() {
                return Err(
                    inner.error(format!("{} cannot be made two-sided: it has two sides already", inner.title()))
                );
            }
            sides.push(made.front);
        }
        Ok(Sides { front: sides[0], back: sides[sides.len() - 1], mask: None })
    }

    /// How a material lets light through.
    fn passage(&mut self, material: usize) -> Passage {
        let made = self.builder.material_mut(material);
        match made.record.kind {
            MATERIAL_THIN_DIELECTRIC | MATERIAL_PRINCIPLED_THIN => Passage::Alike,
            _ if made.transmits() => Passage::Differs,
            _ => Passage::None,
        }
    }

    /// A blend of two BSDFs, of which either may let light straight through.
    fn blend(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let nested = object.objects_of("bsdf");
        let [first, second] = &nested[..] else {
            return Err(object.error(format!("blendbsdf holds {} BSDFs, and needs two", nested.len())));
        };
        let (mut weight, texture) = self.scalar(object, "weight", 0.5, [0.0, 1.0])?;
        let texture = Some(texture).filter(|texture| *texture != NONE);
        let (a, b) = (self.material(first)?, self.material(second)?);
        let mut mask = None;
        if a.mask.is_some() || b.mask.is_some() {
            let plain = |mask: Option<Mask>| match mask {
                None => Some(1.0),
                Some(Mask { opacity, texture: None, .. }) => Some(opacity),
                Some(_) => None,
            };
            let stopped = |opacity, texture| Some(Mask { opacity, texture, cutoff: 0.0 });
            match (plain(a.mask), plain(b.mask), texture) {
                // What is stopped is as likely to be the second as that stops of it.
                (Some(p), Some(q), None) => {
                    let opacity = (1.0 - weight) * p + weight * q;
                    weight = if opacity > 0.0 { weight * q / opacity } else { weight };
                    mask = stopped(opacity, None);
                    if p == 0.0 || q == 0.0 {
                        return Ok(Sides { mask, ..if p == 0.0 { b } else { a } });
                    }
                }
                (Some(0.0), Some(1.0), Some(texture)) => {
                    return Ok(Sides { mask: stopped(weight, Some(texture)), ..b });
                }
                (Some(1.0), Some(0.0), Some(texture)) => {
                    let rest = self.builder.rest_of_texture(texture, weight as f32).ok_or_else(|| {
                        object.error("the weight of a blendbsdf of a null BSDF cannot be a checkerboard of textures")
                    })?;
                    return Ok(Sides { mask: stopped(1.0, Some(rest)), ..a });
                }
                _ => {
                    return Err(object.error(
                        "a blendbsdf can hold masks where its weight and their opacities are numbers, or a null BSDF beside one that stops all light",
                    ));
                }
            }
        }
        let mut of = |a: Side, b: Side| match (a, b) {
            (Some(a), Some(b)) => Ok(Some(self.builder.blend(a, b, weight, texture))),
            (None, None) => Ok(None),
            _ => Err(object.error("the two BSDFs of a blendbsdf must both be two-sided, or neither")),
        };
        Ok(Sides { front: of(a.front, b.front)?, back: of(a.back, b.back)?, mask })
    }

    fn mask(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let inner = self.only_bsdf(object)?;
        let (opacity, texture) = self.scalar(object, "opacity", 0.5, [0.0, 1.0])?;
        let sides = self.material(&inner)?;
        let texture = Some(texture).filter(|texture| *texture != NONE);
        let mask = match sides.mask {
            None => Mask { opacity, texture, cutoff: 0.0 },
            Some(inside) if texture.is_none() || inside.texture.is_none() => {
                Mask { opacity: opacity * inside.opacity, texture: texture.or(inside.texture), cutoff: 0.0 }
            }
            Some(_) => return Err(object.error("of a mask and the mask within it one opacity can be a texture")),
        };
        Ok(Sides { mask: Some(mask), ..sides })
    }

    /// The sides of a shape that emits. Emission does not depend on the BSDF, so that a path must stop there: what a mask lets pass goes on from
    /// there by a material of its own.
    pub(super) fn emitting(&mut self, sides: Sides) -> Sides {
        let Some(mask) = sides.mask else { return sides };
        let through = self.builder.material(material::thin_dielectric(1.0, [1.0; 3], [1.0; 3]));
        if mask.opacity == 0.0 {
            return Sides { front: Some(through), ..Sides::default() };
        }
        let mut of = |side: Side| {
            let solid = side.unwrap_or_else(|| self.builder.material(material::diffuse([0.0; 3])));
            Some(self.builder.blend(through, solid, mask.opacity, mask.texture))
        };
        Sides { front: of(sides.front), back: of(sides.back), mask: None }
    }

    fn normal_map(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let inner = self.only_bsdf(object)?;
        let texture = match (object.texture("normalmap"), object.optional_colour("normalmap", Colour::Unbounded)?) {
            (Some(texture), _) => self.make_texture(&texture)?,
            (None, Some(constant)) => self.constant_texture(constant),
            (None, None) => return Err(object.error("a normalmap needs the texture 'normalmap'")),
        };
        let (flips, shadows) = mapping(object)?;
        let sides = self.material(&inner)?;
        Ok(self.map_sides(sides, |maps| (maps.normal, maps.flips, maps.shadows) = (texture, flips, shadows)))
    }

    fn bump_map(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let inner = self.only_bsdf(object)?;
        let [texture] = &object.objects_of("texture")[..] else {
            return Err(object.error("a bumpmap needs one texture"));
        };
        let texture = self.make_texture(texture)?;
        let scale = object.float("scale", 1.0)? as f32;
        let (flips, shadows) = mapping(object)?;
        let sides = self.material(&inner)?;
        Ok(self.map_sides(sides, |maps| {
            (maps.bump, maps.bump_scale, maps.flips, maps.shadows) = (texture, scale, flips, shadows);
        }))
    }

    fn only_bsdf(&self, object: &Rc<Object>) -> Result<Rc<Object>> {
        object.object_of("bsdf")?.ok_or_else(|| object.error(format!("{} needs a BSDF within", object.title())))
    }

    /// These sides with copies of their materials whose textures are changed.
    fn map_sides(&mut self, sides: Sides, change: impl Fn(&mut MaterialMaps) + Copy) -> Sides {
        let front = sides.front.map(|front| self.builder.changed_material(front, change));
        let back = if sides.back == sides.front {
            front
        } else {
            sides.back.map(|back| self.builder.changed_material(back, change))
        };
        Sides { front, back, mask: sides.mask }
    }

    /// The microfacets of a rough material.
    fn roughness(&mut self, object: &Object) -> Result<Roughness> {
        let beckmann = match object.optional_text("distribution")?.unwrap_or("beckmann") {
            "beckmann" => true,
            "ggx" => false,
            other => {
                let message = format!("'{other}' is not {}", one_of(["beckmann", "ggx"]));
                return Err(object.property_error("distribution", message));
            }
        };
        object.boolean("sample_visible", true)?; // how normals are sampled changes no mean
        let mut textures = Vec::new();
        let mut alpha = [0.0; 2];
        // Both directions take the common one where they have none of their own.
        for (index, (name, property)) in
            [("alpha_u", PROPERTY_ALPHA_U), ("alpha_v", PROPERTY_ALPHA_V)].iter().enumerate()
        {
            let own = object.texture(name).is_some() || object.has(name);
            let (value, texture) = self.scalar(object, if own { name } else { "alpha" }, 0.1, [0.0, f64::INFINITY])?;
            alpha[index] = (value as f32).max(LEAST_ALPHA);
            if texture != NONE {
                textures.push(PropertyTexture { property: *property, texture });
            }
        }
        // One texture for both.
        if let [u, v] = &textures[..]
            && u.texture == v.texture
        {
            textures = vec![PropertyTexture { property: PROPERTY_ROUGHNESS, texture: u.texture }];
        }
        Ok(Roughness { alpha, textures, beckmann })
    }

    /// The complex index of refraction of a metal.
    fn conductor_indices(&mut self, object: &Object, maps: &mut MaterialMaps) -> Result<([f32; 3], [f32; 3])> {
        let (eta, k) = match object.optional_text("material")?.filter(|name| *name != "none") {
            Some(name) => {
                if object.has("eta") || object.has("k") {
                    return Err(object.error(format!("{} has 'material' or 'eta' and 'k', not both", object.title())));
                }
                metals::index_of_refraction(name).ok_or_else(|| {
                    object.property_error(
                        "material",
                        format!("'{name}' is not known; give 'eta' and 'k', or one of {}", all_of(metals::names())),
                    )
                })?
            }
            None => {
                let mut index = |name, default, property| match object.texture(name) {
                    Some(texture) => {
                        maps.multiply(property, self.make_texture(&texture)?);
                        Ok([1.0; 3])
                    }
                    None => Ok(object.optional_colour(name, Colour::Unbounded)?.unwrap_or(default)),
                };
                let (eta, k) = metals::MIRROR;
                (index("eta", eta, PROPERTY_CONDUCTOR_ETA)?, index("k", k, PROPERTY_CONDUCTOR_K)?)
            }
        };
        let [eta, k] = [eta, k].map(|index| index.map(|channel| channel as f32));
        Ok((eta, k))
    }
}

/// Whether mapped normals are flipped to where the camera sees them, and shadow each other.
fn mapping(object: &Object) -> Result<(bool, bool)> {
    Ok((object.boolean("flip_invalid_normals", true)?, object.boolean("use_shadowing_function", true)?))
}

/// How a material lets light through.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Passage {
    /// Not at all.
    None,
    /// From both sides alike.
    Alike,
    /// Into something, or out of it.
    Differs,
}

/// Mitsuba's own lower limit of roughness: a lobe of that alpha is as good as a mirror's.
const LEAST_ALPHA: f32 = 1e-4;

/// The microfacets of a rough material.
struct Roughness {
    alpha: [f32; 2],
    textures: Vec<PropertyTexture>,
    beckmann: bool,
}

fn with_roughness(mut made: MaterialDescription, roughness: Option<Roughness>) -> MaterialDescription {
    if let Some(roughness) = roughness {
        made.textures.properties.extend(roughness.textures);
        if roughness.beckmann {
            return made.beckmann();
        }
    }
    made
}

/// Index of the inside, which has a default, over that of the outside.
fn relative_index(object: &Object, inside: &str) -> Result<f32> {
    let inside = index_of_refraction(object, "int_ior", inside)?;
    let outside = index_of_refraction(object, "ext_ior", "air")?;
    let eta = (inside / outside) as f32;
    if !eta.is_normal() {
        let message =
            format!("over 'ext_ior' ({outside:?}) it is {:?}, and must be 1.2e-38 to 3.4e38", inside / outside);
        return Err(object.property_error("int_ior", message));
    }
    Ok(eta)
}

fn index_of_refraction(object: &Object, name: &'static str, default: &str) -> Result<f64> {
    let by_name = |wanted: &str| INDICES.iter().find(|(known, _)| *known == wanted).map(|(_, value)| *value);
    if let Ok(Some(text)) = object.optional_text(name) {
        return by_name(text).ok_or_else(|| {
            object.property_error(
                name,
                format!("'{text}' is not known; give a number, or {}", one_of(INDICES.map(|row| row.0))),
            )
        });
    }
    object.positive_float(name, by_name(default).unwrap_or(1.0))
}
