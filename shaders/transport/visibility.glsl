// What surfaces let pass: masks stop a share of the light, whatever they are made of, and let the rest go straight on. A path
// meets such a surface or misses it by chance; a light sample is weighted by what all surfaces on its way let through.
#include "core/rng.glsl"
#include "materials/opacity.glsl"
#include "trace/trace.glsl"
#include "trace/interaction.glsl"

// Whether the camera looks through what lies there: a scene can ask for emitters that nobody sees, but that light it all the same.
bool is_hidden(bool from_camera, uint surface) { return HIDES_EMITTERS && from_camera && load_surface(surface).emission != vec3(0.0); }

// The nearest hit that does not let the path pass, and what lies there; moves the ray on behind those that do. One call of each function,
// as a driver compiles each of them anew.
bool trace_visible(inout Ray ray, bool from_camera, out Hit hit, out Interaction at, inout Sampler random, inout uint rays) {
    bool found, passing;
    do {
        found = trace_closest(ray, hit);
        rays += 1u;
        passing = false;
        if (found) {
            at = interaction_at(ray, hit);
            if (HAS_MASKS || HIDES_EMITTERS) {
                float opacity = is_hidden(from_camera, at.surface) ? 0.0 : HAS_MASKS ? surface_opacity(load_surface(at.surface), place_of(at), at.colour.a) : 1.0;
                passing = opacity < 1.0 && (opacity == 0.0 || next4(random).x >= opacity);
                if (passing) ray.origin = offset_origin(at.position, at.margin, at.normal, ray.direction);
            }
        }
    } while ((HAS_MASKS || HIDES_EMITTERS) && passing);
    return found;
}

// Share of the light that comes through between the ray's ends, one of which may be the camera. Where something is in the way that may let it pass, the ray goes from
// surface to surface in further turns.
float trace_transmittance(Ray ray, bool to_camera, inout uint rays) {
    if (!HAS_MASKS && !HIDES_EMITTERS) {
        rays += 1u;
        return trace_any(ray) ? 0.0 : 1.0;
    }
    vec3 end = ray.origin + ray.t_max * ray.direction;
    bool distant = ray.t_max == INFINITY;
    float through = 1.0;
    bool first = true, blocked = true;
    while (blocked) {
        Hit hit;
        blocked = trace(ray, first, hit);
        rays += 1u;
        if (blocked && !first) {
            Interaction at = interaction_at(ray, hit);
            through *= is_hidden(to_camera, at.surface) ? 1.0 : HAS_MASKS ? 1.0 - surface_opacity(load_surface(at.surface), place_of(at), at.colour.a) : 0.0;
            blocked = through > 0.0;
            ray.origin = offset_origin(at.position, at.margin, at.normal, ray.direction);
            ray.t_max = distant ? INFINITY : max(0.0, dot(end - ray.origin, ray.direction));
        }
        first = false;
    }
    return through;
}
