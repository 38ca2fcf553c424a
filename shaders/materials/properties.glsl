// What textures multiply in a material, one texture a turn of a loop: a kernel holds the code that reads a texture once, not once for each
// property, as a CPU driver takes long to compile it.

// Roughness as its texture makes it.
float textured_roughness(Bsdf b, float roughness) { return max(roughness, ROUGHNESS_IS_PERCEPTUAL(b) ? 0.0 : 1e-4); }

#include "generated/properties.glsl"

// The properties at texture coordinates, where a path is `side` wide in them.
void apply_textures(inout Bsdf b, TexturePlace place, float side) {
    MaterialTextures t = TextureSets(scene.material_textures).at[b.m.textures];
    for (uint i = t.first; i < t.first + t.count; i++) {
        PropertyTexture own = PropertyTextures(scene.property_textures).at[i];
        Texture source = texture_seen(load_texture(own.texture), place.uv);
        vec4 value = texture_value(source, place, is_linear(own.property) ? side : 0.0);
        multiply_property(b, own.property, value, texture_channel(source, value));
    }
}
