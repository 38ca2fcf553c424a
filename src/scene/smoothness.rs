//! How smooth a scene's materials are: which light some technique cannot find, or finds rarely.

use super::Scene;
use crate::layout::{
    MATERIAL_LAYERED, MATERIAL_PRINCIPLED, MATERIALS, Material, MaterialKind, NARROW_ALPHA, NONE, Trait,
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
            let alpha2 = if kind.has(Trait::PerceptualRoughness) { product * product } else { product };
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
            kind.has(Trait::Rough) && (self.is_roughness_textured(material) || alpha < limit || self.clear_coat(material).is_some())
        };
        self.materials.iter().any(is_below)
    }

    fn is_roughness_textured(&self, material: &Material) -> bool {
        self.material_textures.get(material.textures as usize).is_some_and(|own| own.roughness != NONE)
    }

    /// The least alpha of a material's clear coat, which is there to be smooth; nothing where it has none.
    fn clear_coat(&self, material: &Material) -> Option<f32> {
        let detail = material.detail as usize;
        match material.kind {
            MATERIAL_PRINCIPLED => {
                let own = self.principleds.get(detail).filter(|own| own.clearcoat > 0.0)?;
                Some(0.1 + (0.001 - 0.1) * own.clearcoat_gloss)
            }
            MATERIAL_LAYERED => {
                let own = self.layereds.get(detail).filter(|own| own.clearcoat > 0.0)?;
                Some(if own.clearcoat_roughness_texture == NONE { own.clearcoat_roughness.powi(2) } else { 0.0 })
            }
            _ => None, // the parameters of the others have none
        }
    }
}
