// What surfaces let pass: masks stop a share of the light, whatever they are made of, and let the rest go straight on. A path
// meets such a surface or misses it by chance; a light sample is weighted by what all surfaces on its way let through.
#include "lib/rng.glsl"
#include "lib/interaction.glsl"

// Share of the light that the surface stops.
float surface_opacity(Surface surface, vec2 uv) {
    if (!HAS_MASKS || surface.opacity_texture == NONE) return surface.opacity;
    float opacity = clamp(surface.opacity * texture_scalar(surface.opacity_texture, uv), 0.0, 1.0);
    return surface.opacity_cutoff > 0.0 ? (opacity < surface.opacity_cutoff ? 0.0 : 1.0) : opacity;
}

// The nearest hit that does not let the path pass; moves the ray on behind those that do.
bool trace_visible(inout Ray ray, out Hit hit, inout Sampler random, inout uint rays) {
    bool found = trace_closest(ray, hit);
    rays += 1u;
    if (!HAS_MASKS) return found;
    bool passing = found;
    while (passing) {
        Interaction at = interaction_at(ray, hit);
        float opacity = surface_opacity(load_surface(at.surface), at.uv);
        passing = opacity < 1.0 && (opacity == 0.0 || next4(random).x >= opacity);
        if (passing) {
            ray.origin = offset_origin(at.position, at.margin, at.normal, ray.direction);
            found = trace_closest(ray, hit);
            rays += 1u;
            passing = found;
        }
    }
    return found;
}

// Share of the light that comes through between the ray's ends.
float trace_transmittance(Ray ray, inout uint rays) {
    rays += 1u;
    if (!trace_any(ray)) return 1.0;
    if (!HAS_MASKS) return 0.0;
    vec3 end = ray.origin + ray.t_max * ray.direction;
    bool distant = ray.t_max == INFINITY;
    float through = 1.0;
    Hit hit;
    bool blocked = trace_closest(ray, hit);
    rays += 1u;
    while (blocked) {
        Interaction at = interaction_at(ray, hit);
        through *= 1.0 - surface_opacity(load_surface(at.surface), at.uv);
        blocked = through > 0.0;
        if (blocked) {
            ray.origin = offset_origin(at.position, at.margin, at.normal, ray.direction);
            ray.t_max = distant ? INFINITY : max(0.0, dot(end - ray.origin, ray.direction));
            blocked = trace_closest(ray, hit);
            rays += 1u;
        }
    }
    return through;
}
