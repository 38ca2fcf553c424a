// `direct`: emission and light that was scattered once, by sampling the lights, by sampling the BSDF, or by both with
// multiple importance sampling (Veach 1997, section 9.2). All three agree in the mean; they differ in their noise.
//
// What a technique cannot do is left to the other: delta lobes always go by the BSDF, delta lights always by a sample.
#version 460
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "transport/emission.glsl"
#include "transport/nee.glsl"
#include "transport/camera_lanes.glsl"
#include "generated/parameters.glsl"

// The weight of light found by the BSDF's choice of direction, given its weight under both techniques.
float by_bsdf(Path path, float both) { return path.delta || SAMPLING == SAMPLING_BSDF ? 1.0 : SAMPLING == SAMPLING_MIS ? both : 0.0; }

// The weight of a light sample.
float by_emitter(NextEvent n) { return n.light.delta || SAMPLING == SAMPLING_EMITTER ? 1.0 : SAMPLING == SAMPLING_MIS ? nee_weight(n) : 0.0; }

bool extend(inout CameraLane lane) {
    Path path = lane.path;
    Vertex v;
    if (!path_arrive(path, v, lane.e.rays)) {
        if (HAS_BACKGROUND) contribute(lane.e, path.depth + 1u, background_contribution(path) * by_bsdf(path, background_weight(path)));
        return false;
    }
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) contribute(lane.e, path.depth + 1u, path.throughput * emission * by_bsdf(path, emission_weight(path, v)));
    if (path.depth + 1u >= min(MAX_DEPTH, 2u) || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    BsdfSample s = bsdf_choose(b, v.wo, bsdf_u.xyz);
    NextEvent n = nee_sample(path, v, b, light_u, s);
    contribute(lane.e, path.depth + 2u, nee_contribution(path, v, b, n, path.throughput, by_emitter(n), lane.e.rays));
    if (!bsdf_is_delta(b) && SAMPLING == SAMPLING_EMITTER) return false;
    path_scatter(path, v, b, s);
    lane.path = path;
    return path.throughput != vec3(0.0);
}

CAMERA_LANES(extend)
