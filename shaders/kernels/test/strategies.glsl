// The weights of all strategies for paths that are given by their densities, put together from techniques/bidirectional/mis.glsl as
// techniques/bidirectional/bdpt.glsl and vcm.glsl do. Vertex 0 is the camera, the last one lies on a light; the layout of a query is src/verify/weights.rs's.
// Parameters of technique: vcm
#version 460
#include "core/prelude.glsl"
#include "kernels/probe.glsl"
#include "trace/trace.glsl"
#define STRATEGIES_OF_VCM
#include "techniques/bidirectional/mis.glsl"

layout(local_size_x = WORKGROUP) in;

const uint MOST = 8u; // vertices
const uint QUERY = 64u; // floats of a query

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Weights { float at[]; };

uint query;
float value(uint index) { return Floats(PROBE_INPUT).at[query * QUERY + index]; }
float camera_density() { return value(1u); }
float emission_a() { return value(2u); }
float emission_w() { return value(3u); }
float choice_a() { return value(4u); }
float to_light(uint i) { return value(5u + i); }             // density of going on towards the light
float to_camera(uint i) { return value(5u + MOST + i); }     // ... towards the camera
bool is_delta(uint i) { return value(5u + 2u * MOST + i) != 0.0; }
float distance2(uint edge) { return value(5u + 3u * MOST + edge); } // between this vertex and the next, in squares of the radius
float near_cosine(uint edge) { return value(5u + 4u * MOST + edge); }
float far_cosine(uint edge) { return value(5u + 5u * MOST + edge); }
float merging(uint i) { return value(5u + 6u * MOST + i); } // density of merges, as an opacity: of one light subpath, in an area of one

float lens_a() { return value(5u + 7u * MOST); } // density of the point on the lens; 0 is a pinhole

void arrive(inout SubpathMis p, uint edge, float cosine) { mis_arrive(p, distance2(edge) * scene.radius * scene.radius, cosine); }

SubpathMis from_camera(uint last) {
    SubpathMis p = mis_begin_camera(camera_density(), lens_a(), near_cosine(0u));
    arrive(p, 0u, far_cosine(0u));
    for (uint i = 1u; i < last; i++) {
        mis_scatter(p, near_cosine(i), to_light(i), to_camera(i), is_delta(i), merging(i));
        arrive(p, i, far_cosine(i));
    }
    return p;
}

SubpathMis from_light(uint n, uint last) {
    uint edge = n - 2u;
    float start = emission_a() * emission_w();
    SubpathMis p = SubpathMis(heuristic(choice_a() * distance2(edge) / (start * near_cosine(edge))), heuristic(far_cosine(edge) / (start * near_cosine(edge))));
    for (uint i = n - 2u; i > last; i--) {
        mis_scatter(p, far_cosine(i - 1u), to_camera(i), to_light(i), is_delta(i), merging(i));
        arrive(p, i - 1u, near_cosine(i - 1u));
    }
    return p;
}

float weight(uint n, uint s) {
    uint t = n - s;
    float seen = camera_density() * far_cosine(0u) / distance2(0u); // density of vertex 1 from the camera
    if (n == 2u) return s == 0u ? 1.0 / (1.0 + if_connected(heuristic(emission_a() / seen))) : if_connected(1.0 / (1.0 + heuristic(seen / emission_a())));
    if (s == 0u) {
        SubpathMis p = from_camera(n - 1u);
        return 1.0 / (1.0 + if_connected(p.d_vcm) * heuristic(choice_a()) + p.d_vc * heuristic(emission_a() * emission_w()));
    }
    uint edge = t - 1u;
    if (!CONNECTS || t > 1u && is_delta(t - 1u) || s > 1u && is_delta(t)) return 0.0;
    if (s == 1u) {
        float found = is_delta(t - 1u) ? 0.0 : to_light(t - 1u) * far_cosine(edge) / (distance2(edge) * choice_a());
        float reverse = emission_a() * emission_w() * near_cosine(edge) / (distance2(edge) * choice_a());
        return 1.0 / (1.0 + heuristic(found) + mis_connection(from_camera(t - 1u), reverse, to_camera(t - 1u), merging(t - 1u)));
    }
    SubpathMis y = from_light(n, t);
    if (t == 1u) {
        float lens = lens_a() > 0.0 ? heuristic(to_camera(1u) * near_cosine(0u) / (distance2(0u) * lens_a())) : 0.0;
        return 1.0 / (1.0 + lens + mis_connection(y, seen, to_light(t), merging(t)));
    }
    float light_side = to_camera(t) * near_cosine(edge) / distance2(edge);
    float camera_side = to_light(t - 1u) * far_cosine(edge) / distance2(edge);
    return 1.0 / (1.0 + mis_connection(from_camera(t - 1u), light_side, to_camera(t - 1u), merging(t - 1u)) +
                  mis_connection(y, camera_side, to_light(t), merging(t)));
}

// Of t = 0, where all n vertices are from the light.
float whole_weight(uint n) {
    if (!CONNECTS || lens_a() == 0.0 || n == 2u) return 0.0;
    SubpathMis p = from_light(n, 1u);
    mis_scatter(p, far_cosine(0u), to_camera(1u), to_light(1u), is_delta(1u), merging(1u));
    arrive(p, 0u, near_cosine(0u));
    return mis_lens_weight(p, camera_density(), lens_a());
}

// Of the merge at vertex i.
float merge_weight(uint n, uint i) {
    if (!MERGES || is_delta(i)) return 0.0;
    return 1.0 / (1.0 + mis_merge(from_camera(i), to_camera(i), merging(i)) + mis_merge(from_light(n, i), to_light(i), merging(i)));
}

void main() {
    query = gl_GlobalInvocationID.x;
    if (query >= frame.slot_count) return;
    uint n = uint(value(0u));
    for (uint i = 0u; i < MOST; i++) {
        Weights(PROBE_OUTPUT).at[query * 2u * MOST + i] = i < n ? weight(n, i) : 0.0;
        Weights(PROBE_OUTPUT).at[query * 2u * MOST + MOST + i] = i > 0u && i < n - 1u ? merge_weight(n, i) : 0.0;
    }
    Weights(PROBE_OUTPUT).at[query * 2u * MOST + n] = whole_weight(n); // merges begin at vertex 1: even the longest path leaves room
}
