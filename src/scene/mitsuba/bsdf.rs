//! `<bsdf>`: materials.

use std::rc::Rc;

use super::Loader;
use super::object::{Colour, Object};
use crate::error::{Result, all_of, one_of};
use crate::scene::builder::Side;
use crate::scene::{material, metals};

const SUPPORTED: [&str; 6] = ["diffuse", "conductor", "roughconductor", "dielectric", "roughdielectric", "twosided"];

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
    /// The materials of the front and of the back that a BSDF stands for.
    pub(super) fn material(&mut self, object: &Rc<Object>) -> Result<(Side, Side)> {
        if let Some(made) = self.materials.get(&Rc::as_ptr(object)) {
            return Ok(*made);
        }
        let made = match object.plugin.as_str() {
            "diffuse" => material::diffuse(object.reflectance("reflectance", 0.5)?),
            "conductor" => conductor(object, None)?,
            "roughconductor" => conductor(object, Some(roughness(object)?))?,
            "dielectric" => dielectric(object, None)?,
            "roughdielectric" => dielectric(object, Some(roughness(object)?))?,
            "twosided" => {
                let sides = self.two_sided(object)?;
                self.materials.insert(Rc::as_ptr(object), sides);
                return Ok(sides);
            }
            _ => return Err(object.unknown_plugin(&SUPPORTED)),
        };
        object.finish()?;
        let sides = (Some(self.builder.material(made)), None);
        self.materials.insert(Rc::as_ptr(object), sides);
        Ok(sides)
    }

    fn two_sided(&mut self, object: &Rc<Object>) -> Result<(Side, Side)> {
        let nested = object.objects_of("bsdf");
        if nested.is_empty() || nested.len() > 2 {
            return Err(object.error(format!("twosided holds {} BSDFs, and needs one or two", nested.len())));
        }
        for inner in &nested {
            if matches!(inner.plugin.as_str(), "dielectric" | "roughdielectric" | "twosided") {
                return Err(
                    inner.error(format!("{} cannot be made two-sided: it has two sides already", inner.title()))
                );
            }
        }
        let (front, _) = self.material(&nested[0])?;
        let (back, _) = self.material(&nested[nested.len() - 1])?;
        object.finish()?;
        Ok((front, back))
    }
}

fn conductor(object: &Object, alpha: Option<[f32; 2]>) -> Result<crate::layout::Material> {
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
    let reflectance = object.reflectance("specular_reflectance", 1.0)?;
    Ok(material::conductor(eta, k, reflectance, alpha))
}

fn dielectric(object: &Object, alpha: Option<[f32; 2]>) -> Result<crate::layout::Material> {
    let inside = index_of_refraction(object, "int_ior", "bk7")?;
    let outside = index_of_refraction(object, "ext_ior", "air")?;
    let reflectance = object.reflectance("specular_reflectance", 1.0)?;
    let transmittance = object.reflectance("specular_transmittance", 1.0)?;
    Ok(material::dielectric((inside / outside) as f32, reflectance, transmittance, alpha))
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

/// GGX roughness along both tangents.
fn roughness(object: &Object) -> Result<[f32; 2]> {
    let distribution = object.optional_text("distribution")?;
    if distribution != Some("ggx") {
        let found =
            distribution.map_or(String::from("it defaults to 'beckmann' in Mitsuba"), |name| format!("it is '{name}'"));
        return Err(object.property_error("distribution", format!("{found}, and only 'ggx' is supported")));
    }
    if !object.boolean("sample_visible", true)? {
        return Err(
            object.property_error("sample_visible", "only true is supported: visible normals are always sampled")
        );
    }
    let both = object.positive_float("alpha", 0.1)?;
    let alpha = [object.positive_float("alpha_u", both)?, object.positive_float("alpha_v", both)?];
    Ok(alpha.map(|alpha| (alpha as f32).max(1e-4))) // Mitsuba's own lower limit
}
