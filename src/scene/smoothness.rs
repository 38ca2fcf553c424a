//! How smooth a scene's materials are: which light some technique cannot find, or finds rarely.

use super::Scene;
use crate::layout::{
    MATERIAL_LAYERED, MATERIAL_PRINCIPLED, MATERIAL_PRINCIPLED_THIN, MATERIALS, Material, MaterialKind, NARROW_ALPHA,
    PROPERTY_ALPHA_U, PROPERTY_ALPHA_V, PROPERTY_CLEARCOAT_GLOSS, PROPERTY_CLEARCOAT_ROUGHNESS, PROPERTY_ROUGHNESS,
    Trait,
};

/// Roughness (alpha) below which a surface is nearly smooth.
const NEAR_SMOOTH: f32 = 0.05;
/// Roughness (alpha) below which it is glossy.
const GLOSSY: f32 = 0.2;

impl Scene {
    /// Whether some material is a mirror or smooth glass, or is coated so.
    pub fn has_smooth(&self) -> bool {
        let is_smooth = |kind: &MaterialKind| kind.has(Trait::AllDelta) || kind.has(Trait::SomeDelta);
        self.materials.iter().any(|material| is_smooth(&MATERIALS[material.kind as usize]))
    }

    /// Whether some material reflects or refracts nearly like a mirror or smooth glass, somewhere: light that it throws elsewhere is found by a
    /// path from there only by chance.
    pub fn has_specular(&self) -> bool {
        self.has_smooth() || self.has_rough_below(NEAR_SMOOTH)
    }

    /// Whether some material has a lobe that is narrow ([`NARROW_ALPHA`]) somewhere, and is no mirror's.
    pub fn has_narrow(&self) -> bool {
        let is_narrow = |material: &Material| {
            let kind = &MATERIALS[material.kind as usize];
            let product = material.alpha_u * material.alpha_v;
            let mut alpha2 = if kind.has(Trait::PerceptualRoughness) { product * product } else { product };
            if material.kind == MATERIAL_PRINCIPLED_THIN {
                alpha2 *= (0.65 * material.eta - 0.35).min(1.0).powi(4); // what passes is spread by less
            }
            kind.has(Trait::Rough)
                && (self.is_roughness_textured(material)
                    || alpha2 < NARROW_ALPHA * NARROW_ALPHA
                    || self.clear_coat(material).is_some_and(|alpha| alpha < NARROW_ALPHA))
        };
        self.materials_in_use().into_iter().any(|index| is_narrow(&self.materials[index]))
    }

    /// Whether some material has a glossy lobe that is no mirror's: what it shows of caustics is found only by chance by who gathers photons
    /// around points.
    pub fn has_glossy(&self) -> bool {
        self.has_rough_below(GLOSSY)
    }

    /// Whether some material is rough, and somewhere less so than this alpha.
    fn has_rough_below(&self, limit: f32) -> bool {
        let is_below = |material: &Material| {
            let kind = &MATERIALS[material.kind as usize];
            let least = material.alpha_u.min(material.alpha_v);
            let alpha = if kind.has(Trait::PerceptualRoughness) { least * least } else { least };
            kind.has(Trait::Rough)
                && (self.is_roughness_textured(material) || alpha < limit || self.clear_coat(material).is_some())
        };
        self.materials.iter().any(is_below)
    }

    fn is_textured(&self, material: &Material, properties: &[u32]) -> bool {
        self.textures_of(material).iter().any(|own| properties.contains(&own.property))
    }

    fn is_roughness_textured(&self, material: &Material) -> bool {
        self.is_textured(material, &[PROPERTY_ROUGHNESS, PROPERTY_ALPHA_U, PROPERTY_ALPHA_V])
    }

    /// The least alpha of a material's clear coat, which is there to be smooth; nothing where it has none.
    fn clear_coat(&self, material: &Material) -> Option<f32> {
        let detail = material.detail as usize;
        match material.kind {
            MATERIAL_PRINCIPLED => {
                let own = self.principleds.get(detail).filter(|own| own.clearcoat > 0.0)?;
                let gloss =
                    if self.is_textured(material, &[PROPERTY_CLEARCOAT_GLOSS]) { 1.0 } else { own.clearcoat_gloss };
                Some(0.1 + (0.001 - 0.1) * gloss)
            }
            MATERIAL_LAYERED => {
                let own = self.layereds.get(detail).filter(|own| own.clearcoat > 0.0)?;
                let textured = self.is_textured(material, &[PROPERTY_CLEARCOAT_ROUGHNESS]);
                Some(if textured { 0.0 } else { own.clearcoat_roughness.powi(2) })
            }
            _ => None, // the parameters of the others have none
        }
    }
}
