//! Materials as the shaders take them, made from physical parameters.

use crate::layout::{
    Layered, MATERIAL_CONDUCTOR, MATERIAL_DIELECTRIC, MATERIAL_DIFFUSE, MATERIAL_HAS_ABSORPTION, MATERIAL_HAS_TANGENTS,
    MATERIAL_HAS_TRANSMISSION, MATERIAL_IS_COMPENSATED, MATERIAL_LAYERED, MATERIAL_PLASTIC, MATERIAL_PRINCIPLED,
    MATERIAL_PRINCIPLED_THIN, MATERIAL_ROUGH_CONDUCTOR, MATERIAL_ROUGH_DIELECTRIC, MATERIAL_ROUGH_PLASTIC,
    MATERIAL_THIN_DIELECTRIC, MICROFACET_BECKMANN, Material, NONE, Plastic, Principled, PropertyTexture,
};

/// A material with what its record has no room for; [`SceneBuilder::finish`](super::SceneBuilder::finish) files each part where it belongs.
#[derive(Clone, Debug)]
pub struct MaterialDescription {
    /// The record; its `detail` and `textures` are filled in by the builder.
    pub record: Material,
    /// What its kind needs besides.
    pub detail: Detail,
    /// Its textures.
    pub textures: MaterialMaps,
}

/// The textures of a material, by their indices.
#[derive(Clone, Debug)]
pub struct MaterialMaps {
    /// What multiplies a property, one of the `PROPERTY_*` constants.
    pub properties: Vec<PropertyTexture>,
    /// Tangent-space normals, or [`NONE`].
    pub normal: u32,
    /// Factor on the first two components of those normals.
    pub normal_scale: f32,
    /// Height that displaces the surface (bump map), or [`NONE`].
    pub bump: u32,
    /// Factor on that height, in scene units.
    pub bump_scale: f32,
    /// A mapped normal that the camera's side is below of is mirrored at the shading normal.
    pub flips: bool,
    /// The slopes of a mapped surface shadow each other.
    pub shadows: bool,
}

impl Default for MaterialMaps {
    fn default() -> Self {
        Self {
            properties: Vec::new(),
            normal: NONE,
            normal_scale: 1.0,
            bump: NONE,
            bump_scale: 1.0,
            flips: false,
            shadows: false,
        }
    }
}

impl MaterialMaps {
    /// Lets a texture, unless it is [`NONE`], multiply a property.
    pub fn multiply(&mut self, property: u32, texture: u32) {
        if texture != NONE {
            self.properties.push(PropertyTexture { property, texture });
        }
    }

    /// Whether a texture multiplies one of these properties.
    pub fn any_of(&self, properties: &[u32]) -> bool {
        self.properties.iter().any(|own| properties.contains(&own.property))
    }
}

/// What a kind of material needs besides its record.
#[derive(Clone, Debug)]
pub enum Detail {
    /// Nothing.
    None,
    /// Of plastic.
    Plastic(Plastic),
    /// Of a principled material.
    Principled(Principled),
    /// Of a layered material.
    Layered(Layered),
}

impl From<Material> for MaterialDescription {
    fn from(record: Material) -> Self {
        Self { record, detail: Detail::None, textures: MaterialMaps::default() }
    }
}

fn record(kind: u32, flags: u32) -> Material {
    Material { kind, flags, textures: NONE, ..Material::default() }
}

/// Lambertian reflection of this albedo.
pub fn diffuse(reflectance: [f32; 3]) -> Material {
    Material { reflectance, ..record(MATERIAL_DIFFUSE, 0) }
}

/// A flag where roughness differs along the two tangents, so that it matters where they point.
fn anisotropy([alpha_u, alpha_v]: [f32; 2]) -> u32 {
    if alpha_u == alpha_v { 0 } else { MATERIAL_HAS_TANGENTS }
}

/// A metal of complex relative index `eta + i k`; a mirror where `alpha` is nothing, else GGX of that roughness along
/// both tangents.
pub fn conductor(eta: [f32; 3], k: [f32; 3], reflectance: [f32; 3], alpha: Option<[f32; 2]>) -> Material {
    let [alpha_u, alpha_v] = alpha.unwrap_or_default();
    let kind = if alpha.is_some() { MATERIAL_ROUGH_CONDUCTOR } else { MATERIAL_CONDUCTOR };
    let flags = alpha.map_or(0, anisotropy);
    Material { alpha_u, alpha_v, conductor_eta: eta, conductor_k: k, reflectance, ..record(kind, flags) }
}

/// Glass of relative index `eta` (inside over outside); smooth where `alpha` is nothing, else GGX of that roughness.
pub fn dielectric(eta: f32, reflectance: [f32; 3], transmittance: [f32; 3], alpha: Option<[f32; 2]>) -> Material {
    let [alpha_u, alpha_v] = alpha.unwrap_or_default();
    let kind = if alpha.is_some() { MATERIAL_ROUGH_DIELECTRIC } else { MATERIAL_DIELECTRIC };
    let flags = MATERIAL_HAS_TRANSMISSION | alpha.map_or(0, anisotropy);
    let eta = if alpha.is_some() { bending(eta) } else { eta };
    Material { alpha_u, alpha_v, eta, reflectance, transmittance, ..record(kind, flags) }
}

/// A thin sheet of glass of relative index `eta`, met once: light passes straight through.
pub fn thin_dielectric(eta: f32, reflectance: [f32; 3], transmittance: [f32; 3]) -> Material {
    Material { eta, reflectance, transmittance, ..record(MATERIAL_THIN_DIELECTRIC, MATERIAL_HAS_TRANSMISSION) }
}

/// A diffuse base under a coating of relative index `eta`, smooth where `alpha` is nothing, else GGX of that roughness;
/// `nonlinear` lets light that the coating throws back take on the base's colour each time.
pub fn plastic(
    eta: f32,
    diffuse: [f32; 3],
    specular: [f32; 3],
    nonlinear: bool,
    alpha: Option<f32>,
) -> MaterialDescription {
    let mean = |rgb: [f32; 3]| rgb.iter().sum::<f32>() / 3.0;
    let (diffuse_mean, specular_mean) = (mean(diffuse), mean(specular));
    let kind = if alpha.is_some() { MATERIAL_ROUGH_PLASTIC } else { MATERIAL_PLASTIC };
    let alpha = alpha.unwrap_or_default();
    let total = diffuse_mean + specular_mean;
    let detail = Plastic {
        specular,
        specular_weight: if total > 0.0 { specular_mean / total } else { 0.5 },
        nonlinear: u32::from(nonlinear),
        ..Plastic::default() // what the coating does is integrated when the material is filed
    };
    MaterialDescription {
        record: Material { alpha_u: alpha, alpha_v: alpha, eta, reflectance: diffuse, ..record(kind, 0) },
        detail: Detail::Plastic(detail),
        textures: MaterialMaps::default(),
    }
}

/// An index of refraction that bends light at all: half vectors of refraction do not exist for an index of one.
fn bending(eta: f32) -> f32 {
    if (eta - 1.0).abs() < 1e-3 { 1.001 } else { eta }
}

/// A material that has its roughness as artists see it, the square root of alpha, and bends light at `eta`.
fn perceptual(mut record: Material, base: [f32; 3], roughness: f32, eta: f32, detail: Detail) -> MaterialDescription {
    (record.reflectance, record.alpha_u, record.alpha_v, record.eta) = (base, roughness, roughness, bending(eta));
    MaterialDescription { record, detail, textures: MaterialMaps::default() }
}

/// Burley's principled BSDF of this base colour, perceptual roughness and index of refraction.
pub fn principled(base: [f32; 3], roughness: f32, eta: f32, parameters: Principled) -> MaterialDescription {
    let transmits = if parameters.spec_trans > 0.0 { MATERIAL_HAS_TRANSMISSION } else { 0 };
    let tangents = if parameters.anisotropic > 0.0 { MATERIAL_HAS_TANGENTS } else { 0 };
    let record = record(MATERIAL_PRINCIPLED, transmits | tangents);
    perceptual(record, base, roughness, eta, Detail::Principled(parameters))
}

/// Burley's principled BSDF of a thin sheet of this base colour, perceptual roughness and index of refraction, the same from both sides; it has
/// neither metal nor a clear coat.
pub fn principled_thin(base: [f32; 3], roughness: f32, eta: f32, parameters: Principled) -> MaterialDescription {
    let tangents = if parameters.anisotropic > 0.0 { MATERIAL_HAS_TANGENTS } else { 0 };
    let record = record(MATERIAL_PRINCIPLED_THIN, MATERIAL_HAS_TRANSMISSION | tangents);
    perceptual(record, base, roughness, eta, Detail::Principled(parameters))
}

/// A [`Layered`] that is a plain metallic-roughness material.
pub fn plain_layers(metallic: f32) -> Layered {
    Layered {
        metallic,
        specular: 1.0,
        specular_colour: [1.0; 3],
        clearcoat_normal: [0.0, 0.0, 1.0],
        clearcoat_normal_texture: NONE,
        clearcoat_normal_scale: 1.0,
        anisotropy_direction: [1.0, 0.0],
        diffuse_transmission_colour: [1.0; 3],
        ..Layered::default()
    }
}

/// glTF's layered material of this base colour, perceptual roughness and index of refraction.
pub fn layered(base: [f32; 3], roughness: f32, eta: f32, layers: Layered) -> MaterialDescription {
    let passes = layers.transmission > 0.0 || layers.diffuse_transmission > 0.0;
    let transmits = if passes { MATERIAL_HAS_TRANSMISSION } else { 0 };
    let has_tangents = layers.anisotropy > 0.0 || layers.clearcoat_normal_texture != NONE;
    let tangents = if has_tangents { MATERIAL_HAS_TANGENTS } else { 0 };
    let absorbs = layers.is_volume != 0 && layers.absorption.iter().any(|channel| *channel > 0.0);
    let absorbs = if absorbs { MATERIAL_HAS_ABSORPTION } else { 0 };
    let record = record(MATERIAL_LAYERED, transmits | tangents | absorbs);
    perceptual(record, base, roughness, eta, Detail::Layered(layers))
}

impl MaterialDescription {
    /// This material with Beckmann's microfacets instead of GGX's.
    pub fn beckmann(mut self) -> Self {
        self.record.flags |= MICROFACET_BECKMANN;
        self
    }

    /// This material, giving back what a rough metal or rough glass loses to multiple scattering; any other material stays as it is.
    pub fn compensated(mut self) -> Self {
        if matches!(self.record.kind, MATERIAL_ROUGH_CONDUCTOR | MATERIAL_ROUGH_DIELECTRIC) {
            self.record.flags |= MATERIAL_IS_COMPENSATED;
        }
        self
    }

    /// Whether light passes through it, so that it is the same material seen from both sides.
    pub fn transmits(&self) -> bool {
        self.record.flags & MATERIAL_HAS_TRANSMISSION != 0
    }

    /// Whether any texture is set.
    pub fn is_textured(&self) -> bool {
        let textures = &self.textures;
        let has_coat_map = matches!(&self.detail, Detail::Layered(l) if l.clearcoat_normal_texture != NONE);
        !textures.properties.is_empty() || textures.normal != NONE || textures.bump != NONE || has_coat_map
    }
}
