// `path-implicit`: implicit path tracing. The BSDF alone chooses directions, and light counts where a path runs into it;
// lights that no direction hits by chance stay unseen.
//
// form=unbiased adds emission at every vertex and ends paths by Russian roulette with the constant probability q.
// form=biased ends at the first light or at a fixed length: it misses what lights reflect and longer paths.
#version 460
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "transport/emission.glsl"
#include "transport/camera_lanes.glsl"
#include "generated/parameters.glsl"

const uint FIXED_LENGTH = 8u; // of the biased form, where the scene gives no limit

bool implicit_extend(inout Path path, inout Estimate e) {
    // 1. Emission that the path has run into, all of which counts.
    Vertex v;
    vec3 emission;
    if (!arrive_at_emission(path, false, false, v, emission, e)) return false;
    if (v.material == NONE) return false;
    if (FORM == FORM_BIASED) {
        if (emission != vec3(0.0) || path.depth + 1u >= min(MAX_DEPTH, FIXED_LENGTH)) return false;
    } else if (path.depth + 1u >= MAX_DEPTH) {
        return false;
    }

    // 2. The next direction.
    Bsdf b = vertex_material(v, path.ray, path.random);
    vec4 u = next4(path.random);
    path_scatter(path, v, b, vertex_sample(v, b, path.ray, u.xyz));
    if (path.throughput == vec3(0.0)) return false;

    // 3. Russian roulette with a constant probability of ending.
    if (FORM != FORM_BIASED && path.depth >= RR_DEPTH) {
        float q = Q;
        if (u.w < q) return false;
        path.throughput /= 1.0 - q;
    }
    return true;
}

bool extend(inout CameraLane lane) { return implicit_extend(lane.path, lane.e); }

CAMERA_LANES(extend)
