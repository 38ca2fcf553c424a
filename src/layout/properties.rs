//! What a texture may multiply in a material, each property declared once.
//!
//! A row is a constant, whether the BSDF is linear in the property, and the statement of GLSL that multiplies it: the texture's `value` as a colour, or its
//! `channel`. From the list come the constants, `generated/properties.glsl`, which properties mip maps filter, and the feature
//! [`super::Needs::textured_properties`], by which a kernel holds the statements that its scene needs.

/// A property of materials that may be textured.
#[derive(Clone, Copy, Debug)]
pub struct Property {
    /// The name of its constant; the value is its place in [`PROPERTIES`].
    pub constant: &'static str,
    /// Whether BSDFs are linear in it: their mean over a footprint is that of the footprint's mean.
    pub linear: bool,
    /// What multiplies it, in GLSL.
    pub statement: &'static str,
}

macro_rules! properties {
    ($( $(#[$doc:meta])* $constant:ident $linear:ident $statement:literal; )*) => {
        enum Index { $( $constant ),* }
        $( $(#[$doc])* pub const $constant: u32 = Index::$constant as u32; )*

        /// The properties, by their constants.
        pub const PROPERTIES: &[Property] = &[$( Property {
            constant: stringify!($constant),
            linear: properties!(@is_linear $linear),
            statement: $statement,
        } ),*];
    };
    (@is_linear linear) => { true };
    (@is_linear other) => { false };
}

properties! {
    /// Reflectance or base colour.
    PROPERTY_REFLECTANCE linear "b.m.reflectance *= value.rgb;";
    /// Transmittance, or a plastic's specular reflectance.
    PROPERTY_TRANSMITTANCE linear "b.m.transmittance *= value.rgb; if (HAS_PLASTIC || HAS_ROUGH_PLASTIC) b.plastic.specular *= value.rgb;";
    /// Roughness along both tangents: alpha, or perceptual roughness of principled and layered materials.
    PROPERTY_ROUGHNESS other "b.m.alpha_u = textured_roughness(b, b.m.alpha_u * channel); b.m.alpha_v = textured_roughness(b, b.m.alpha_v * channel);";
    /// Roughness along the first tangent.
    PROPERTY_ALPHA_U other "b.m.alpha_u = textured_roughness(b, b.m.alpha_u * channel);";
    /// Roughness along the second tangent.
    PROPERTY_ALPHA_V other "b.m.alpha_v = textured_roughness(b, b.m.alpha_v * channel);";
    /// Real part of a conductor's index of refraction.
    PROPERTY_CONDUCTOR_ETA other "b.m.conductor_eta *= value.rgb;";
    /// Imaginary part of it.
    PROPERTY_CONDUCTOR_K other "b.m.conductor_k *= value.rgb;";
    /// Metalness.
    PROPERTY_METALLIC linear "if (HAS_PRINCIPLED) b.principled.metallic *= channel; if (HAS_LAYERED) b.layered.metallic *= channel;";
    /// Anisotropy of a principled material.
    PROPERTY_ANISOTROPIC other "b.principled.anisotropic *= channel;";
    /// Share of a principled material's light that is transmitted.
    PROPERTY_SPEC_TRANS linear "b.principled.spec_trans *= channel;";
    /// How much the base colour tints a principled material's reflection.
    PROPERTY_SPEC_TINT linear "b.principled.spec_tint *= channel;";
    /// A principled material's sheen.
    PROPERTY_SHEEN linear "b.principled.sheen *= channel;";
    /// How much the base colour tints it.
    PROPERTY_SHEEN_TINT linear "b.principled.sheen_tint *= channel;";
    /// How far a principled material's diffuse lobe is flattened.
    PROPERTY_FLATNESS linear "b.principled.flatness *= channel;";
    /// A principled material's clear coat.
    PROPERTY_PRINCIPLED_CLEARCOAT linear "b.principled.clearcoat *= channel;";
    /// The gloss of that coat.
    PROPERTY_CLEARCOAT_GLOSS other "b.principled.clearcoat_gloss *= channel;";
    /// How much of a thin principled material's diffuse light passes through.
    PROPERTY_DIFF_TRANS linear "b.principled.diff_trans *= channel;";
    /// Index of refraction of a thin principled material.
    PROPERTY_ETA other "b.m.eta = max(b.m.eta * channel, 1.001);";
    /// Strength of a layered material's dielectric reflection.
    PROPERTY_SPECULAR linear "b.layered.specular *= channel;";
    /// Colour of that reflection.
    PROPERTY_SPECULAR_COLOUR linear "b.layered.specular_colour *= value.rgb;";
    /// Share of a layered material's light that passes through.
    PROPERTY_TRANSMISSION linear "b.layered.transmission *= channel;";
    /// A layered material's clear coat.
    PROPERTY_CLEARCOAT linear "b.layered.clearcoat *= channel;";
    /// The perceptual roughness of that coat.
    PROPERTY_CLEARCOAT_ROUGHNESS other "b.layered.clearcoat_roughness *= channel;";
    /// Strength of a layered material's anisotropy (blue), and its direction in the tangent frame (red and green, -1 to 1).
    PROPERTY_LAYERED_ANISOTROPY other "b.layered.anisotropy *= value.b; turn_anisotropy(b.layered, 2.0 * value.rg - 1.0);";
    /// Strength of a layered material's thin film.
    PROPERTY_IRIDESCENCE linear "b.layered.iridescence *= channel;";
    /// Thickness of that film, between its least and its largest.
    PROPERTY_IRIDESCENCE_THICKNESS other "b.layered.iridescence_thickness = mix(b.layered.iridescence_least, b.layered.iridescence_thickness, channel);";
    /// Share of a layered material's diffuse light that comes out on the other side.
    PROPERTY_DIFFUSE_TRANSMISSION linear "b.layered.diffuse_transmission *= channel;";
    /// Colour of that light.
    PROPERTY_DIFFUSE_TRANSMISSION_COLOUR linear "b.layered.diffuse_transmission_colour *= value.rgb;";
    /// Colour of a layered material's sheen.
    PROPERTY_SHEEN_COLOUR linear "b.layered.sheen_colour *= value.rgb;";
    /// The perceptual roughness of that sheen.
    PROPERTY_SHEEN_ROUGHNESS other "b.layered.sheen_roughness *= channel;";
}

const _: () = assert!(PROPERTIES.len() <= 32, "a scene's textured properties are the bits of a word");

/// The text of `generated/properties.glsl`.
pub fn properties_glsl() -> String {
    let mut text = String::from("// Generated from src/layout/properties.rs.\n\n");
    for (value, property) in PROPERTIES.iter().enumerate() {
        let name = property.constant;
        text += &format!("const uint {name} = {value}u;\n");
        text += &format!("const bool TEXTURES_{name} = (TEXTURED_PROPERTIES & (1u << {value})) != 0u;\n");
    }
    let linear =
        (0u32..).zip(PROPERTIES).filter(|(_, property)| property.linear).fold(0, |all, (bit, _)| all | 1 << bit);
    text += "\n// The BSDF is linear in it: its mean over a footprint is that of the footprint's mean.\n";
    text += &format!("bool is_linear(uint property) {{ return ({linear}u >> property & 1u) != 0u; }}\n");
    text += "\n// The texture's value as a colour, or its channel.\n";
    text += "void multiply_property(inout Bsdf b, uint property, vec4 value, float channel) {\n";
    for Property { constant, statement, .. } in PROPERTIES {
        text += &format!("    if (TEXTURES_{constant} && property == {constant}) {{ {statement} }}\n");
    }
    text += "}\n";
    text
}
