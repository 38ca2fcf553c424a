//! `<bsdf>`: materials.

use std::rc::Rc;

use super::loader::{Loader, Sides};
use super::metals;
use super::object::Object;
use super::value::Colour;
use crate::error::{Result, all_of, one_of};
use crate::layout::{MaterialTextures, NONE, Principled};
use crate::scene::material::MaterialDescription;
use crate::scene::{Mask, Side, material};

const SUPPORTED: [&str; 15] = [
    "diffuse",
    "conductor",
    "roughconductor",
    "dielectric",
    "roughdielectric",
    "thindielectric",
    "plastic",
    "roughplastic",
    "principled",
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
                let (albedo, texture) = self.reflectance(object, "reflectance", 0.5)?;
                let mut made = MaterialDescription::from(material::diffuse(albedo));
                made.textures.reflectance = texture;
                Ok(made)
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
                let eta = relative_index(object, "bk7")?;
                let (reflectance, first) = self.reflectance(object, "specular_reflectance", 1.0)?;
                let (transmittance, second) = self.reflectance(object, "specular_transmittance", 1.0)?;
                let mut made = MaterialDescription::from(material::thin_dielectric(eta, reflectance, transmittance));
                (made.textures.reflectance, made.textures.transmittance) = (first, second);
                Ok(made)
            }
            "plastic" => self.plastic(object, None),
            "roughplastic" => {
                let roughness = self.roughness(object)?;
                if roughness.alpha[0] != roughness.alpha[1] || roughness.texture != NONE {
                    return Err(object.property_error("alpha", "the roughness of a roughplastic is one number"));
                }
                self.plastic(object, Some(roughness))
            }
            "principled" => self.principled(object),
            _ => Err(object.unknown_plugin(&SUPPORTED)),
        }
    }

    fn conductor(&mut self, object: &Object, roughness: Option<Roughness>) -> Result<MaterialDescription> {
        let (eta, k) = conductor_indices(object)?;
        let (reflectance, texture) = self.reflectance(object, "specular_reflectance", 1.0)?;
        let made = material::conductor(eta, k, reflectance, roughness.map(|roughness| roughness.alpha));
        let mut made = MaterialDescription::from(made);
        made.textures.reflectance = texture;
        Ok(with_roughness(made, roughness))
    }

    fn dielectric(&mut self, object: &Object, roughness: Option<Roughness>) -> Result<MaterialDescription> {
        let eta = relative_index(object, "bk7")?;
        let (reflectance, first) = self.reflectance(object, "specular_reflectance", 1.0)?;
        let (transmittance, second) = self.reflectance(object, "specular_transmittance", 1.0)?;
        let made = material::dielectric(eta, reflectance, transmittance, roughness.map(|roughness| roughness.alpha));
        let mut made = MaterialDescription::from(made);
        (made.textures.reflectance, made.textures.transmittance) = (first, second);
        Ok(with_roughness(made, roughness))
    }

    fn plastic(&mut self, object: &Object, roughness: Option<Roughness>) -> Result<MaterialDescription> {
        let eta = relative_index(object, "polypropylene")?;
        let (diffuse, first) = self.reflectance(object, "diffuse_reflectance", 0.5)?;
        let (specular, second) = self.reflectance(object, "specular_reflectance", 1.0)?;
        let nonlinear = object.boolean("nonlinear", false)?;
        let mut made =
            material::plastic(eta, diffuse, specular, nonlinear, roughness.map(|roughness| roughness.alpha[0]));
        (made.textures.reflectance, made.textures.transmittance) = (first, second);
        Ok(with_roughness(made, roughness))
    }

    fn principled(&mut self, object: &Object) -> Result<MaterialDescription> {
        let unit = [0.0, 1.0];
        let (base, first) = self.reflectance(object, "base_color", 0.5)?;
        let (roughness, second) = self.scalar(object, "roughness", 0.5, unit)?;
        let (metallic, third) = self.scalar(object, "metallic", 0.0, unit)?;
        let share = |name: &'static str| {
            let value = object.float(name, 0.0)?;
            if unit[0] <= value && value <= unit[1] {
                Ok(value as f32)
            } else {
                Err(object.property_error(name, format!("{value} is not in 0 to 1")))
            }
        };
        let eta = match object.optional_float("eta")? {
            Some(_) if object.has("specular") => {
                return Err(object.error("a principled BSDF has 'eta' or 'specular', not both"));
            }
            Some(eta) if eta >= 1.0 => eta,
            Some(eta) => return Err(object.property_error("eta", format!("{eta} is below 1"))),
            None => 2.0 / (1.0 - (0.08 * object.float("specular", 0.5)?.clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        for ignored in ["main_specular_sampling", "clearcoat_sampling", "diffuse_reflectance_sampling"] {
            object.optional_float(ignored)?; // how lobes are sampled changes no mean
        }
        let parameters = Principled {
            metallic: metallic as f32,
            anisotropic: share("anisotropic")?,
            spec_trans: share("spec_trans")?,
            spec_tint: share("spec_tint")?,
            sheen: share("sheen")?,
            sheen_tint: share("sheen_tint")?,
            flatness: share("flatness")?,
            clearcoat: share("clearcoat")?,
            clearcoat_gloss: share("clearcoat_gloss")?,
        };
        let mut made = material::principled(base, roughness as f32, (eta as f32).max(1.001), parameters);
        (made.textures.reflectance, made.textures.roughness, made.textures.metallic) = (first, second, third);
        Ok(made)
    }

    fn two_sided(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let nested = object.objects_of("bsdf");
        if nested.is_empty() || nested.len() > 2 {
            return Err(object.error(format!("twosided holds {} BSDFs, and needs one or two", nested.len())));
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

    fn blend(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let nested = object.objects_of("bsdf");
        let [first, second] = &nested[..] else {
            return Err(object.error(format!("blendbsdf holds {} BSDFs, and needs two", nested.len())));
        };
        let (weight, texture) = self.scalar(object, "weight", 0.5, [0.0, 1.0])?;
        let texture = Some(texture).filter(|texture| *texture != NONE);
        let (a, b) = (self.material(first)?, self.material(second)?);
        if a.mask.is_some() || b.mask.is_some() {
            return Err(object.error("a blendbsdf cannot hold a mask: put the blend into the mask"));
        }
        let mut of = |a: Side, b: Side| match (a, b) {
            (Some(a), Some(b)) => Ok(Some(self.builder.blend(a, b, weight, texture))),
            (None, None) => Ok(None),
            _ => Err(object.error("the two BSDFs of a blendbsdf must both be two-sided, or neither")),
        };
        Ok(Sides { front: of(a.front, b.front)?, back: of(a.back, b.back)?, mask: None })
    }

    fn mask(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let inner = self.only_bsdf(object)?;
        let (opacity, texture) = self.scalar(object, "opacity", 0.5, [0.0, 1.0])?;
        let sides = self.material(&inner)?;
        if sides.mask.is_some() {
            return Err(object.error("a mask cannot hold another mask"));
        }
        let texture = Some(texture).filter(|texture| *texture != NONE);
        Ok(Sides { mask: Some(Mask { opacity, texture, cutoff: 0.0 }), ..sides })
    }

    fn normal_map(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let inner = self.only_bsdf(object)?;
        let texture = match (object.texture("normalmap"), object.optional_colour("normalmap", Colour::Unbounded)?) {
            (Some(texture), _) => self.make_texture(&texture)?,
            (None, Some(constant)) => self.constant_texture(constant),
            (None, None) => return Err(object.error("a normalmap needs the texture 'normalmap'")),
        };
        for name in ["flip_invalid_normals", "use_shadowing_function"] {
            if object.boolean(name, true)? {
                self.builder
                    .warnings
                    .push(format!("{}: '{name}' is true in Mitsuba, and is not modelled", object.title()));
            }
        }
        let sides = self.material(&inner)?;
        Ok(self.map_sides(sides, |textures| textures.normal = texture))
    }

    fn bump_map(&mut self, object: &Rc<Object>) -> Result<Sides> {
        let inner = self.only_bsdf(object)?;
        let [texture] = &object.objects_of("texture")[..] else {
            return Err(object.error("a bumpmap needs one texture"));
        };
        let texture = self.make_texture(texture)?;
        let scale = object.float("scale", 1.0)? as f32;
        let sides = self.material(&inner)?;
        Ok(self.map_sides(sides, |textures| (textures.bump, textures.bump_scale) = (texture, scale)))
    }

    fn only_bsdf(&self, object: &Rc<Object>) -> Result<Rc<Object>> {
        object.object_of("bsdf")?.ok_or_else(|| object.error(format!("{} needs a BSDF within", object.title())))
    }

    /// These sides with copies of their materials whose textures are changed.
    fn map_sides(&mut self, sides: Sides, change: impl Fn(&mut MaterialTextures) + Copy) -> Sides {
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
        if let Some(texture) = object.texture("alpha") {
            return Ok(Roughness { alpha: [1.0; 2], texture: self.make_texture(&texture)?, beckmann });
        }
        let both = object.positive_float("alpha", 0.1)?;
        let alpha = [object.positive_float("alpha_u", both)?, object.positive_float("alpha_v", both)?];
        // Mitsuba's own lower limit.
        Ok(Roughness { alpha: alpha.map(|alpha| (alpha as f32).max(1e-4)), texture: NONE, beckmann })
    }
}

/// The microfacets of a rough material.
#[derive(Clone, Copy)]
struct Roughness {
    alpha: [f32; 2],
    texture: u32,
    beckmann: bool,
}

fn with_roughness(mut made: MaterialDescription, roughness: Option<Roughness>) -> MaterialDescription {
    if let Some(roughness) = roughness {
        made.textures.roughness = roughness.texture;
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
    Ok((inside / outside) as f32)
}

/// The complex index of refraction of a metal.
fn conductor_indices(object: &Object) -> Result<([f32; 3], [f32; 3])> {
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
            let (eta, k) = metals::MIRROR;
            (
                object.optional_colour("eta", Colour::Unbounded)?.unwrap_or(eta),
                object.optional_colour("k", Colour::Unbounded)?.unwrap_or(k),
            )
        }
    };
    let [eta, k] = [eta, k].map(|index| index.map(|channel| channel as f32));
    Ok((eta, k))
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
