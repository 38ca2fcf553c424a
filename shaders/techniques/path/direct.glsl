// `direct`: emission and light that was scattered once, by sampling the lights, by sampling the BSDF, or by both with
// multiple importance sampling (Veach 1997, section 9.2). All three agree in the mean; they differ in their noise.
//
// What a technique cannot do is left to the other: delta lobes always go by the BSDF, delta lights always by a sample.
#version 460
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "transport/path.glsl"

const uint SAMPLE_BOTH = 0u;
const uint SAMPLE_EMITTER = 1u;
const uint SAMPLE_BSDF = 2u;

// The weight of light found by the BSDF's choice of direction, given its weight under both techniques.
float by_bsdf(Path path, float both) { return path.delta || PARAM0 == SAMPLE_BSDF ? 1.0 : PARAM0 == SAMPLE_BOTH ? both : 0.0; }

// The weight of a light sample, given its weight under both techniques.
float by_emitter(LightSample light, float both) {
    return light.delta || PARAM0 == SAMPLE_EMITTER ? 1.0 : PARAM0 == SAMPLE_BOTH ? both : 0.0;
}

bool path_extend(inout Path path, inout Estimate e) {
    Hit hit;
    Interaction at;
    bool found = path_trace(path, hit, at, e);
    if (!found) {
        if (HAS_BACKGROUND) {
            float weight = by_bsdf(path, background_weight(path));
            contribute(e, path.depth + 1u, path.throughput * background_radiance(path.ray.direction) * weight);
        }
        return false;
    }
    Vertex v = vertex_of(path.ray, at);
    path_absorb(path, v);
    path_measure(path, v);
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0))
        contribute(e, path.depth + 1u, path.throughput * emission * by_bsdf(path, emission_weight(path, hit, v)));
    if (path.depth + 1u >= min(MAX_DEPTH, 2u) || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b)) {
        LightSample light = light_sample(vertex_receiver(v, b), light_u);
        vec3 wi = vertex_to_local(v, light.wi);
        float weight = by_emitter(light, power_heuristic(light.pdf_w, bsdf_pdf(b, v.wo, wi)));
        vec3 radiance = path.throughput * vertex_eval(v, b, path.ray, wi, light.wi) * light.weight * weight;
        if (radiance != vec3(0.0)) contribute(e, path.depth + 2u, radiance * vertex_transmittance(v, light, vertex_absorption(v, b, path.absorption, wi), e.rays));
        if (PARAM0 == SAMPLE_EMITTER) return false;
    }
    path_scatter(path, v, b, vertex_sample(v, b, path.ray, bsdf_u.xyz));
    return path.throughput != vec3(0.0);
}

#include "transport/lanes.glsl"
