//! The arrays of materials, with what is integrated once for each: coatings of plastic, energy that compensation gives back.

use super::compensation;
use super::fresnel::diffuse_reflectance;
use super::microfacets::Microfacets;
use super::plastic::rough_coating;
use crate::layout::{
    Compensation, Layered, MATERIAL_FLIPS_NORMALS, MATERIAL_HAS_TANGENTS, MATERIAL_IS_COMPENSATED,
    MATERIAL_ROUGH_PLASTIC, MATERIAL_SHADOWS_NORMALS, MICROFACET_BECKMANN, Material, MaterialTextures, NONE,
    PROPERTY_ALPHA_U, PROPERTY_ALPHA_V, PROPERTY_ANISOTROPIC, Plastic, Principled, PropertyTexture,
};
use crate::scene::material::{Detail, MaterialDescription};

/// What plastic's coating does to light that crosses it: its transmittance by cosine where it is rough, and the share of
/// diffuse light that it reflects from inside.
fn coating(description: &MaterialDescription) -> (Vec<f32>, f64) {
    let (alpha, eta) = (f64::from(description.record.alpha_u), f64::from(description.record.eta));
    if description.record.kind != MATERIAL_ROUGH_PLASTIC {
        return (Vec::new(), diffuse_reflectance(1.0 / eta));
    }
    let beckmann = description.record.flags & MICROFACET_BECKMANN != 0;
    rough_coating(Microfacets::isotropic(alpha, beckmann), eta)
}

/// The materials' records and what goes beside them.
#[derive(Default)]
pub(super) struct MaterialRecords {
    pub materials: Vec<Material>,
    pub textures: Vec<MaterialTextures>,
    pub property_textures: Vec<PropertyTexture>,
    pub plastics: Vec<Plastic>,
    pub principleds: Vec<Principled>,
    pub layereds: Vec<Layered>,
    pub compensations: Vec<Compensation>,
}

/// The records of materials, and of what each has beside its own; tables of coatings and of missing energy go to the end of `tables`.
pub(super) fn material_records(descriptions: &[MaterialDescription], tables: &mut Vec<f32>) -> MaterialRecords {
    let mut records = MaterialRecords::default();
    let mut known = compensation::Known::default();
    for description in descriptions {
        let mut record = description.record;
        match &description.detail {
            Detail::None if record.flags & MATERIAL_IS_COMPENSATED != 0 => {
                record.detail = records.compensations.len() as u32;
                records.compensations.push(compensation::file(description, tables, &mut known));
            }
            Detail::None => {}
            Detail::Plastic(plastic) => {
                let (table, inside) = coating(description);
                let (first, internal_reflectance) = (tables.len() as u32, inside as f32);
                record.detail = records.plastics.len() as u32;
                records.plastics.push(Plastic { table: first, internal_reflectance, ..*plastic });
                tables.extend(table);
            }
            Detail::Principled(principled) => {
                record.detail = records.principleds.len() as u32;
                records.principleds.push(*principled);
            }
            Detail::Layered(layered) => {
                record.detail = records.layereds.len() as u32;
                records.layereds.push(*layered);
            }
        }
        let textures = &description.textures;
        if description.is_textured() {
            record.textures = records.textures.len() as u32;
            records.textures.push(MaterialTextures {
                first: records.property_textures.len() as u32,
                count: textures.properties.len() as u32,
                normal: textures.normal,
                normal_scale: textures.normal_scale,
                bump: textures.bump,
                bump_scale: textures.bump_scale,
            });
            records.property_textures.extend(&textures.properties);
        }
        let stretched = textures.any_of(&[PROPERTY_ALPHA_U, PROPERTY_ALPHA_V, PROPERTY_ANISOTROPIC]);
        if textures.normal != NONE || textures.bump != NONE || stretched {
            record.flags |= MATERIAL_HAS_TANGENTS;
        }
        for (set, flag) in [(textures.flips, MATERIAL_FLIPS_NORMALS), (textures.shadows, MATERIAL_SHADOWS_NORMALS)] {
            record.flags |= if set { flag } else { 0 };
        }
        records.materials.push(record);
    }
    records
}
