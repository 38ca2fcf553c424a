// What textures multiply in a material, one property a turn of a loop: a kernel holds the code that reads a texture once, not once for each
// property, as a CPU driver takes long to compile it.

// Of all materials.
const uint PROPERTY_REFLECTANCE = 0u;
const uint PROPERTY_TRANSMITTANCE = 1u;
const uint PROPERTY_ROUGHNESS = 2u;
const uint PROPERTY_METALLIC = 3u;
const uint MATERIAL_PROPERTIES = 4u;
// Of layered ones besides.
const uint PROPERTY_SPECULAR = 4u;
const uint PROPERTY_SPECULAR_COLOUR = 5u;
const uint PROPERTY_TRANSMISSION = 6u;
const uint PROPERTY_CLEARCOAT = 7u;
const uint PROPERTY_CLEARCOAT_ROUGHNESS = 8u;
const uint PROPERTY_SHEEN_COLOUR = 9u;
const uint PROPERTY_SHEEN_ROUGHNESS = 10u;
const uint LAYERED_PROPERTIES = 11u;

uint property_texture(Bsdf b, MaterialTextures t, uint property) {
    switch (property) {
        case PROPERTY_REFLECTANCE: return t.reflectance;
        case PROPERTY_TRANSMITTANCE: return t.transmittance;
        case PROPERTY_ROUGHNESS: return t.roughness;
        case PROPERTY_METALLIC: return t.metallic;
        case PROPERTY_SPECULAR: return b.layered.specular_texture;
        case PROPERTY_SPECULAR_COLOUR: return b.layered.specular_colour_texture;
        case PROPERTY_TRANSMISSION: return b.layered.transmission_texture;
        case PROPERTY_CLEARCOAT: return b.layered.clearcoat_texture;
        case PROPERTY_CLEARCOAT_ROUGHNESS: return b.layered.clearcoat_roughness_texture;
        case PROPERTY_SHEEN_COLOUR: return b.layered.sheen_colour_texture;
        default: return b.layered.sheen_roughness_texture;
    }
}

// The BSDF is linear in it: its mean over a footprint is that of the footprint's mean.
bool is_linear(uint property) {
    return property != PROPERTY_ROUGHNESS && property != PROPERTY_CLEARCOAT_ROUGHNESS && property != PROPERTY_SHEEN_ROUGHNESS;
}

// The texture's value as a colour, or its channel.
void multiply_property(inout Bsdf b, uint property, vec4 value, float channel) {
    switch (property) {
        case PROPERTY_REFLECTANCE: b.m.reflectance *= value.rgb; break;
        case PROPERTY_TRANSMITTANCE:
            b.m.transmittance *= value.rgb;
            if (HAS_PLASTIC || HAS_ROUGH_PLASTIC) b.plastic.specular *= value.rgb;
            break;
        case PROPERTY_ROUGHNESS: {
            bool perceptual = ROUGHNESS_IS_PERCEPTUAL(b);
            b.m.alpha_u = max(b.m.alpha_u * channel, perceptual ? 0.0 : 1e-4);
            b.m.alpha_v = max(b.m.alpha_v * channel, perceptual ? 0.0 : 1e-4);
            break;
        }
        case PROPERTY_METALLIC:
            if (HAS_PRINCIPLED) b.principled.metallic *= channel;
            if (HAS_LAYERED) b.layered.metallic *= channel;
            break;
        case PROPERTY_SPECULAR: b.layered.specular *= channel; break;
        case PROPERTY_SPECULAR_COLOUR: b.layered.specular_colour *= value.rgb; break;
        case PROPERTY_TRANSMISSION: b.layered.transmission *= channel; break;
        case PROPERTY_CLEARCOAT: b.layered.clearcoat *= channel; break;
        case PROPERTY_CLEARCOAT_ROUGHNESS: b.layered.clearcoat_roughness *= channel; break;
        case PROPERTY_SHEEN_COLOUR: b.layered.sheen_colour *= value.rgb; break;
        default: b.layered.sheen_roughness *= channel;
    }
}

// The properties at texture coordinates, where a path is `side` wide in them.
void apply_textures(inout Bsdf b, vec2 uv, float side) {
    MaterialTextures t = TextureSets(scene.material_textures).at[b.m.textures];
    uint properties = is_kind(b, HAS_LAYERED, MATERIAL_LAYERED) ? LAYERED_PROPERTIES : MATERIAL_PROPERTIES;
    for (uint property = 0u; property < properties; property++) {
        uint index = property_texture(b, t, property);
        if (index == NONE) continue;
        Texture source = load_texture(index);
        vec4 value = texture_value(source, uv, is_linear(property) ? side : 0.0);
        multiply_property(b, property, value, texture_channel(source, value));
    }
}
