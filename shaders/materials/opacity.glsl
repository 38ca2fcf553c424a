// How much of the light that meets a surface it stops, whatever it is made of.
#include "core/texture.glsl"

// Share of the light that the surface stops, where its vertex colours have this alpha.
float surface_opacity(Surface surface, TexturePlace place, float alpha) {
    bool textured = HAS_TEXTURED_MASKS && surface.opacity_texture != NONE;
    bool coloured = HAS_ALPHA_COLOURS && (surface.flags & SURFACE_HAS_ALPHA_COLOURS) != 0u;
    if (!textured && !coloured) return surface.opacity;
    float opacity = surface.opacity;
    if (textured) opacity *= texture_scalar(surface.opacity_texture, place);
    if (coloured) opacity *= alpha;
    opacity = clamp(opacity, 0.0, 1.0);
    return surface.opacity_cutoff > 0.0 ? (opacity < surface.opacity_cutoff ? 0.0 : 1.0) : opacity;
}
