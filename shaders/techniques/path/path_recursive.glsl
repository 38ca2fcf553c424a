// `path-recursive`: the rendering equation as it stands, L = Le + integral of f L cos, evaluated by a function that calls itself:
//
//     radiance(ray) = emission + direct light + weight * radiance(next ray)
//
// with the estimators and random numbers of `path`. GLSL has no recursion: the calls lie on a stack of our own. docs/recursion.md walks
// through it.
//
// returns=radiance is that function. What it gathered is weighted on the way back, each call by its own weight.
// returns=nothing hands down the product of all weights instead, so that each call can add to the image by itself. Then nothing is left to do
// once the inner call has returned, and the stack is not needed either: this is `path`, but for how compilers round (on lavapipe to the last bit).
#version 460
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "transport/emission.glsl"
#include "transport/nee.glsl"
#include "transport/camera_lanes.glsl"
#include "generated/parameters.glsl"

// What a call leaves on the stack. It returns emission + direct + weight * what the inner call returns.
struct Call {
    vec3 emission, direct, weight;
};
const uint ROOM = 32u;
Call stack[ROOM];
uint calls = 0u;

// Outermost calls for which there was no room: what they gathered is in the image, and this is the product of their weights.
uint settled = 0u;
vec3 settled_weight = vec3(1.0);

void settle_outermost(inout Estimate e) {
    gather(e, settled + 1u, settled_weight * stack[0].emission);
    gather(e, settled + 2u, settled_weight * stack[0].direct);
    settled_weight *= stack[0].weight;
    settled++;
    calls--;
    for (uint i = 0u; i < calls; i++) stack[i] = stack[i + 1u];
}

void push(Path path, vec3 handed_down, Call call, inout Estimate e) {
    if (RECORDS) {
        // The same contributions as the path's throughput has them.
        record_contribution(path.depth + 1u, call.emission / handed_down * path.throughput);
        record_contribution(path.depth + 2u, call.direct / handed_down * path.throughput);
    }
    if (calls == ROOM) settle_outermost(e);
    stack[calls++] = call;
}

// All calls return, the innermost first.
void unwind(inout Estimate e) {
    Estimate returned;
    returned.radiance = vec3(0.0);
    for (uint i = 0u; i < LENGTH_LAYERS; i++) returned.by_length[i] = vec3(0.0);
    while (calls > 0u) {
        Call call = stack[--calls];
        returned.radiance *= call.weight;
        for (uint i = 0u; i < LENGTH_LAYERS; i++) returned.by_length[i] *= call.weight;
        uint length = settled + calls + 1u;
        gather(returned, length, call.emission);
        gather(returned, length + 1u, call.direct);
    }
    e.radiance += settled_weight * returned.radiance;
    for (uint i = 0u; i < LENGTH_LAYERS; i++) e.by_length[i] += settled_weight * returned.by_length[i];
    settled = 0u;
    settled_weight = vec3(1.0);
}

// One call up to the inner one, for which `path` is then ready; false where it makes none. With returns=nothing the path's throughput is the
// argument that is handed down; with returns=radiance only Russian roulette looks at it.
bool radiance(inout Path path, inout Estimate e) {
    Call call = Call(vec3(0.0), vec3(0.0), vec3(0.0));
    Path before = path;
    Vertex v;
    if (!path_arrive(path, v, e.rays)) {
        if (HAS_BACKGROUND) {
            vec3 handed_down = RETURNS == RETURNS_RADIANCE ? vec3(1.0) : path.throughput;
            bool hidden = HIDES_EMITTERS && path.depth == 0u;
            call.emission = hidden ? vec3(0.0) : handed_down * background_radiance(path.ray.direction) * background_weight(path);
            if (RETURNS == RETURNS_RADIANCE) push(path, handed_down, call, e); else contribute(e, path.depth + 1u, call.emission);
        }
        return false;
    }
    before.throughput = vec3(1.0);
    path_absorb(before, v); // this call's own segment
    vec3 handed_down = RETURNS == RETURNS_RADIANCE ? before.throughput : path.throughput;

    // Emission.
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) call.emission = handed_down * emission * emission_weight(path, v);
    if (RETURNS == RETURNS_NOTHING) contribute(e, path.depth + 1u, call.emission);
    bool ends = path.depth + 1u >= MAX_DEPTH || v.material == NONE;
    Path arrived = path;

    if (!ends) {
        // Direct light.
        Bsdf b = vertex_material(v, path.ray, path.random);
        vec4 light_u = next4(path.random);
        vec4 bsdf_u = next4(path.random);
        BsdfSample s = bsdf_choose(b, v.wo, bsdf_u.xyz);
        NextEvent n = nee_sample(path, v, b, light_u, s);
        call.direct = nee_contribution(path, v, b, n, handed_down, nee_weight(n), e.rays);
        if (RETURNS == RETURNS_NOTHING) contribute(e, path.depth + 2u, call.direct);

        // The inner call.
        path_scatter(path, v, b, s);
        float survival = path_survival(path, path.eta * path.eta);
        ends = bsdf_u.w >= survival;
        if (!ends) {
            path.throughput /= survival;
            call.weight = handed_down * s.weight / survival;
        }
    }
    if (RETURNS == RETURNS_RADIANCE) push(arrived, handed_down, call, e);
    return !ends;
}

bool extend(inout CameraLane lane) {
    if (radiance(lane.path, lane.e)) return true;
    unwind(lane.e);
    return false;
}

CAMERA_LANES(extend)
