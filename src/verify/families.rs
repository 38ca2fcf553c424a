//! The materials that rows sweep over roughness.

use crate::layout::{Layered, Principled};
use crate::scene::material::{self, MaterialDescription, plain_layers};

const WHITE: [f32; 3] = [1.0; 3];
/// A mirror that reflects everything: index 0 + i.
const PERFECT: ([f32; 3], [f32; 3]) = ([0.0; 3], [1.0; 3]);

fn principled(base: [f32; 3], roughness: f32, parameters: Principled) -> MaterialDescription {
    material::principled(base, roughness, 1.5, parameters)
}

fn layered(base: [f32; 3], roughness: f32, layers: Layered) -> MaterialDescription {
    material::layered(base, roughness, 1.5, layers)
}

/// Families of materials over roughness (alpha = roughness^2), white, with the bound on their albedo.
pub type Family = (&'static str, fn(f32) -> MaterialDescription, f64);

/// Every family.
pub const FAMILIES: &[Family] = &[
    ("GGX conductor", |r| material::conductor(PERFECT.0, PERFECT.1, WHITE, Some([r * r; 2])).into(), 1.002),
    (
        "Beckmann conductor",
        |r| MaterialDescription::from(material::conductor(PERFECT.0, PERFECT.1, WHITE, Some([r * r; 2]))).beckmann(),
        1.002,
    ),
    ("GGX dielectric", |r| material::dielectric(1.5, WHITE, WHITE, Some([r * r; 2])).into(), 1.002),
    (
        "Beckmann dielectric",
        |r| MaterialDescription::from(material::dielectric(1.5, WHITE, WHITE, Some([r * r; 2]))).beckmann(),
        1.002,
    ),
    (
        "compensated mirror",
        |r| MaterialDescription::from(material::conductor(PERFECT.0, PERFECT.1, WHITE, Some([r * r; 2]))).compensated(),
        1.002,
    ),
    (
        "compensated glass",
        |r| MaterialDescription::from(material::dielectric(1.5, WHITE, WHITE, Some([r * r; 2]))).compensated(),
        1.002,
    ),
    ("GGX plastic", |r| material::plastic(1.5, WHITE, WHITE, false, Some(r * r)), 1.002),
    ("Beckmann plastic", |r| material::plastic(1.5, WHITE, WHITE, false, Some(r * r)).beckmann(), 1.002),
    ("principled metal", |r| principled(WHITE, r, Principled { metallic: 1.0, ..Principled::default() }), 1.002),
    ("principled glass", |r| principled(WHITE, r, Principled { spec_trans: 1.0, ..Principled::default() }), 1.002),
    ("principled", |r| principled(WHITE, r, Principled::default()), 1.58),
    (
        "principled thin glass",
        |r| material::principled_thin(WHITE, r, 1.5, Principled { spec_trans: 1.0, ..Principled::default() }),
        1.002,
    ),
    (
        "principled thin sheet",
        |r| material::principled_thin(WHITE, r, 1.5, Principled { diff_trans: 0.8, ..Principled::default() }),
        1.36,
    ),
    ("layered metal", |r| layered(WHITE, r, plain_layers(1.0)), 1.002),
    ("layered wall", |r| layered(WHITE, r, Layered { transmission: 1.0, ..plain_layers(0.0) }), 1.002),
    ("layered glass", |r| layered(WHITE, r, Layered { transmission: 1.0, is_volume: 1, ..plain_layers(0.0) }), 1.002),
    ("layered dielectric", |r| layered(WHITE, r, plain_layers(0.0)), 1.84),
    (
        "layered anisotropic metal",
        |r| layered(WHITE, r, Layered { anisotropy: 0.6, anisotropy_direction: [0.6, 0.8], ..plain_layers(1.0) }),
        1.002,
    ),
    (
        "layered iridescent metal",
        |r| {
            let film =
                Layered { iridescence: 1.0, iridescence_eta: 1.3, iridescence_thickness: 400.0, ..plain_layers(1.0) };
            layered([0.9, 0.6, 0.3], r, film)
        },
        1.002,
    ),
    ("layered leaf", |r| layered(WHITE, r, Layered { diffuse_transmission: 0.5, ..plain_layers(0.0) }), 1.84),
    (
        "layered sheen on metal",
        |r| layered(WHITE, 0.3, Layered { sheen_colour: WHITE, sheen_roughness: r, ..plain_layers(1.0) }),
        1.002,
    ),
    (
        "layered coat on metal",
        |r| layered(WHITE, 0.3, Layered { clearcoat: 1.0, clearcoat_roughness: r, ..plain_layers(1.0) }),
        1.002,
    ),
];

/// Whether light passes a family without a change of medium, as through a sheet.
pub fn is_thin(name: &str) -> bool {
    ["layered wall", "layered leaf"].contains(&name) || name.starts_with("principled thin")
}

/// Whether a family's BSDF is the same in both directions: what microfacets of a thin sheet let pass is not (`shaders/materials/principled_thin.glsl`).
pub fn is_reciprocal(name: &str) -> bool {
    name != "principled thin glass"
}
