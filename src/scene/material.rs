//! Materials as the shaders take them, made from physical parameters.

use crate::layout::{
    MATERIAL_CONDUCTOR, MATERIAL_DIELECTRIC, MATERIAL_DIFFUSE, MATERIAL_ROUGH_CONDUCTOR, MATERIAL_ROUGH_DIELECTRIC,
    Material,
};

/// Lambertian reflection of this albedo.
pub fn diffuse(reflectance: [f32; 3]) -> Material {
    Material { kind: MATERIAL_DIFFUSE, reflectance, ..Material::default() }
}

/// A metal of complex relative index `eta + i k`; a mirror where `alpha` is nothing, else GGX of that roughness along
/// both tangents.
pub fn conductor(eta: [f32; 3], k: [f32; 3], reflectance: [f32; 3], alpha: Option<[f32; 2]>) -> Material {
    let [alpha_u, alpha_v] = alpha.unwrap_or_default();
    let kind = if alpha.is_some() { MATERIAL_ROUGH_CONDUCTOR } else { MATERIAL_CONDUCTOR };
    Material { kind, alpha_u, alpha_v, conductor_eta: eta, conductor_k: k, reflectance, ..Material::default() }
}

/// Glass of relative index `eta` (inside over outside); smooth where `alpha` is nothing, else GGX of that roughness.
pub fn dielectric(eta: f32, reflectance: [f32; 3], transmittance: [f32; 3], alpha: Option<[f32; 2]>) -> Material {
    let [alpha_u, alpha_v] = alpha.unwrap_or_default();
    let kind = if alpha.is_some() { MATERIAL_ROUGH_DIELECTRIC } else { MATERIAL_DIELECTRIC };
    Material { kind, alpha_u, alpha_v, eta, reflectance, transmittance, ..Material::default() }
}

/// Whether light passes through it, so that it is the same material seen from both sides.
pub fn transmits(material: &Material) -> bool {
    matches!(material.kind, MATERIAL_DIELECTRIC | MATERIAL_ROUGH_DIELECTRIC)
}
