// How much of the light that meets a surface it stops, whatever it is made of.
#include "core/texture.glsl"

// Share of the light that the surface stops.
float surface_opacity(Surface surface, vec2 uv) {
    if (!HAS_TEXTURED_MASKS || surface.opacity_texture == NONE) return surface.opacity;
    float opacity = clamp(surface.opacity * texture_scalar(surface.opacity_texture, uv), 0.0, 1.0);
    return surface.opacity_cutoff > 0.0 ? (opacity < surface.opacity_cutoff ? 0.0 : 1.0) : opacity;
}
