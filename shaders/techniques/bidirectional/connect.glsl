// What paths from the camera find by themselves: the strategies (0, t), which run into a light, and (1, t), next-event estimation.
#include "techniques/bidirectional/light_vertices.glsl"
#include "core/splat.glsl"

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

// A vertex of a path from the camera joined to a light or to a vertex of a light path.
struct Connection {
    vec3 value;      // contribution, were nothing in between
    float weight;    // of this among all strategies for the whole path
    Ray ray;         // from the first to the second
    vec3 absorption; // in between
};

// What is to be joined to: a sample of the lights (s = 1, next-event estimation), or a vertex of a light path (s > 1). Both in one function, so that
// a kernel holds the BSDF at the camera's vertex once.
struct End {
    bool light;
    vec4 u;         // chooses the sample of the lights
    LightVertex y;  // the vertex otherwise
    Sampler random; // at the beginning of its path
};

Connection join(Path path, Vertex v, Bsdf b, Partial p, bool both_sides, End end) {
    Connection joined;
    joined.value = vec3(0.0);
    LightSample light = no_light();
    Vertex w;
    Bsdf c;
    Ray arrived = Ray(end.y.position, end.y.direction, INFINITY);
    float distance2 = 1.0;
    vec3 towards;
    if (end.light) {
        light = light_sample(vertex_receiver(v, b), end.u);
        towards = light.wi;
    } else {
        w = vertex_at(arrived, Hit(0.0, end.y.primitive, end.y.instance, end.y.uv));
        end.random.dimension = end.y.dimension;
        c = vertex_material(w, arrived, end.random);
        vec3 d = w.at.position - v.at.position;
        distance2 = dot(d, d);
        if (distance2 == 0.0) return joined;
        towards = d * inversesqrt(distance2);
    }
    vec3 local = vertex_to_local(v, towards), other = vec3(0.0);
    vec3 f = vertex_eval(v, b, path.ray, local, towards);
    if (end.light) {
        joined.value = path.throughput * f * light.weight;
    } else {
        other = vertex_to_local(w, -towards);
        joined.value = end.y.power * f * light_vertex_eval(w, c, arrived, other, -towards) / distance2;
    }
    if (joined.value == vec3(0.0)) return joined;

    vec2 pdf_w = bsdf_pdf_both(b, v.wo, local);
    float opacity = vertex_opacity(v);
    float others;
    if (end.light) {
        others = mis((light.delta ? 0.0 : pdf_w.x) / light.pdf_w);
        if (both_sides) others += partial_sum(p, light.emitted * abs(dot(light.wi, v.at.normal)) / scaled_area(1.0), pdf_w.y, opacity);
        joined.ray = vertex_shadow_ray(v, light);
    } else {
        joined.value *= path.throughput;
        vec2 far_pdf_w = bsdf_pdf_both(c, w.wo, other);
        float area = scaled_area(distance2);
        float from_light = far_pdf_w.x * abs(dot(towards, v.at.normal)) / area;
        float from_camera = pdf_w.x * abs(dot(towards, w.at.normal)) / area;
        others = partial_sum(p, from_light, pdf_w.y, opacity) + partial_sum(Partial(end.y.d_vcm, end.y.d_vc), from_camera, far_pdf_w.y, vertex_opacity(w));
        joined.ray = vertex_ray_to(v, towards, offset_origin(w.at.position, w.at.margin, w.at.normal, -towards));
    }
    joined.weight = 1.0 / (1.0 + others);
    joined.absorption = vertex_absorption(v, b, path.absorption, local);
    return joined;
}

// Adds what (s, t) brings, as far as it comes through.
void gather_connection(Pixel pixel, inout Estimate e, uint s, uint t, Connection c) {
    gather(pixel, e, s, t, c.value * ray_transmittance(c.ray, c.absorption, e.rays), c.weight);
}
