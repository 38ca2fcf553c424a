// What paths from the camera find by themselves: the strategies (0, t), which run into a light, and (1, t), next-event estimation.
#include "lib/light_vertices.glsl"
#include "lib/splat.glsl"

// Adds what (s, t) brings to the path's own pixel.
void gather(Pixel pixel, inout Estimate e, uint s, uint t, vec3 value, float weight) {
    if (HAS_STRATEGIES) splat_strategy(pixel.index, pixel.sample_index, s, t, value * pixel.filter_weight, weight);
    else contribute(e, s + t - 1u, value * weight);
}

// Weight of (0, t): the path has run into a light. `choice_pdf_w` is the density with which (1, t - 1) picks that direction,
// `cosine` lies at the light, `emission_a` is the density of light paths beginning there, per scaled area, and `emission_w` that of
// going this way then.
float implicit_weight(Path path, Partial p, float choice_pdf_w, float cosine, float distance2, float emission_a, float emission_w) {
    if (path.depth == 0u) {
        // Against (1, 1): p holds pixels per area there.
        return 1.0 / (1.0 + connected(p.d_vcm) * mis(emission_a));
    }
    float choice_a = choice_pdf_w * cosine / scaled_area(distance2);
    return 1.0 / (1.0 + connected(p.d_vcm) * mis(choice_a) + p.d_vc * mis(emission_a * emission_w));
}

// The same for a path that is too long for any other strategy but (1, t - 1).
float long_weight(Path path, float choice_pdf_w) { return CONNECTS && !path.delta ? 1.0 / (1.0 + mis(choice_pdf_w / path.pdf_w)) : 1.0; }

// s = 0: the path has left the scene and sees the background.
void gather_background(Pixel pixel, Path path, Partial p, bool both_sides, inout Estimate e) {
    float pdf_w = background_pdf(path.ray.direction);
    float weight = 1.0;
    // d_vcm and d_vc are still over solid angle: a light path begins on a disk.
    float emission_a = disk_pdf(path.ray.origin, path.ray.direction) / scaled_area(1.0);
    if (path.depth > 0u)
        weight = both_sides ? 1.0 / (1.0 + connected(p.d_vcm) * mis(pdf_w) + p.d_vc * mis(pdf_w * emission_a)) : long_weight(path, pdf_w);
    gather(pixel, e, 0u, path.depth + 2u, path.throughput * background_radiance(path.ray.direction), weight);
}

// s = 0: the path has run into a light.
void gather_emission(Pixel pixel, Path path, Hit hit, Vertex v, Partial p, bool both_sides, float cosine, float distance2, inout Estimate e) {
    vec3 emission = vertex_emission(v, path.ray);
    if (emission == vec3(0.0)) return;
    float choice = path.depth > 0u && !path.delta ? light_pdf(path.from, path.ray, hit, v.at, v.surface) : 0.0;
    float weight = 1.0;
    if (both_sides) {
        float emission_w = surface_emission_pdf(v.at.position, -path.ray.direction, cosine);
        weight = implicit_weight(path, p, choice, cosine, distance2, v.surface.emission_density / scaled_area(1.0), emission_w);
    } else {
        weight = long_weight(path, choice);
    }
    gather(pixel, e, 0u, path.depth + 2u, path.throughput * emission, weight);
}

// s = 1: next-event estimation.
void gather_light(Pixel pixel, Path path, Vertex v, Bsdf b, Partial p, bool both_sides, vec4 u, inout Estimate e) {
    LightSample light = light_sample(vertex_receiver(v, b), u);
    vec3 wi = vertex_to_local(v, light.wi);
    vec3 value = path.throughput * vertex_eval(v, b, path.ray, wi, light.wi) * light.weight;
    if (value == vec3(0.0)) return;
    float found_w = light.delta ? 0.0 : bsdf_pdf(b, v.wo, wi);
    float others = mis(found_w / light.pdf_w);
    if (both_sides) others += partial_sum(p, light.emitted * abs(dot(light.wi, v.at.normal)) / scaled_area(1.0), bsdf_pdf(b, wi, v.wo), vertex_opacity(v));
    value *= vertex_transmittance(v, light, vertex_absorption(v, b, path.absorption, wi), e.rays);
    gather(pixel, e, 1u, path.depth + 2u, value, 1.0 / (1.0 + others));
}
