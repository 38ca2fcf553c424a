// `whitted`: recursive ray tracing (Whitted 1980, "An improved illumination model for shaded display"). Light that came straight from a
// light and was scattered once, as the camera sees it by way of any number of mirrors and smooth glass, and of what is as smooth as these
// (materials/lobes.glsl). Where glass or a coating both reflects and refracts, the path branches; nothing else scatters further.
//
// branches=one follows one of the two by chance instead: the same image in the mean, by single paths.
// lights=point takes the middle of each triangle or sphere for all of it, as the first ray tracers did: shadows are sharp.
#version 460
#include "core/prelude.glsl"
#define SPLITS_LOBES true
#include "trace/trace.glsl"
#include "transport/emission.glsl"
#include "transport/split.glsl"
#include "transport/camera_lanes.glsl"
#include "lights/middle.glsl"
#include "generated/parameters.glsl"

uint shadow_rays() { return uint(SHADOW_RAYS); }

// The recursion's stack: branches that wait for their turn. Each level of the tree leaves at most one; where there is no room, a path
// follows one by chance.
struct Branch {
    Ray ray;
    vec3 throughput, absorption;
    float eta, dimming;
    uint depth;
    Cone cone;
};
const uint ROOM = 12u;
Branch stack[ROOM];
uint waiting = 0u;

void put_aside(Path path) { stack[waiting++] = Branch(path.ray, path.throughput, path.absorption, path.eta, path.dimming, path.depth, path.cone); }

// Takes up a branch that waits, with random numbers that nothing has used.
void take_up(inout Path path) {
    Branch branch = stack[--waiting];
    path.ray = branch.ray;
    path.from.position = branch.ray.origin;
    path.throughput = branch.throughput;
    path.absorption = branch.absorption;
    path.eta = branch.eta;
    path.dimming = branch.dimming;
    path.depth = branch.depth;
    path.cone = branch.cone;
    path.delta = true; // two lobes are of deltas alone
}

// The two lobes between which u.z decides, each weighted by its own share; the second has no weight where there is one only.
void lobes(Path path, Vertex v, Bsdf b, vec2 u, out BsdfSample first, out BsdfSample second) {
    first = vertex_sample(v, b, path.ray, vec3(u, 0.0));
    second = vertex_sample(v, b, path.ray, vec3(u, 1.0 - 2.0 * MACHINE_EPSILON));
    first.weight *= first.pdf_w;
    second.weight *= first.wi != second.wi ? second.pdf_w : 0.0;
}

bool goes_on(inout Path path, Vertex v, Bsdf b, BsdfSample s, float u) {
    if (!s.narrow) return false;
    path_scatter(path, v, b, s);
    return path_survives(path, path.eta * path.eta, u);
}

// Light that is scattered by the vertex once: the mean over so many shadow rays. The middle of a light stands for it on broad lobes alone: narrow ones
// show all of it where the path runs into it, as mirrors do.
void connect_lights(inout Path path, Vertex v, Bsdf b, inout Estimate e) {
    for (uint i = 0u; i < shadow_rays(); i++) {
        vec4 u = next4(path.random);
        LightSample light = no_light();
        bool middle = false;
        if (LIGHTS == LIGHTS_POINT) light = light_middle_sample(vertex_reference(v, b), u, middle);
        else light = light_sample(vertex_reference(v, b), u);
        BsdfSample none = bsdf_no_sample(vec3(0.0, 0.0, 1.0));
        SplitEvent n = split_connect(path, v, b, light, true, none);
        float share = 1.0 / float(shadow_rays());
        contribute(e, path.depth + 2u, split_contribution(path, v, b, n, share, middle ? 0.0 : share * nee_weight(n.narrow), e.rays));
    }
}

// Follows one branch to its next vertex; false where it ends there.
bool branch_extend(inout Path path, inout Estimate e) {
    Vertex v;
    vec3 emission;
    if (!arrive_at_emission(path, SPLITS && LIGHTS != LIGHTS_POINT, SPLITS, v, emission, e)) return false;
    if (path.depth + 1u >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    if (!bsdf_is_delta(b)) connect_lights(path, v, b, e);

    vec4 u = next4(path.random);
    if (BRANCHES == BRANCHES_ONE || waiting == ROOM || !HAS_TWO_LOBES(b)) return goes_on(path, v, b, vertex_sample(v, b, path.ray, u.xyz), u.w);
    BsdfSample first, second;
    lobes(path, v, b, u.xy, first, second);
    Path other = path;
    if (goes_on(other, v, b, first, u.w)) put_aside(other);
    return goes_on(path, v, b, second, u.z);
}

bool extend(inout CameraLane lane) {
    if (branch_extend(lane.path, lane.e)) return true;
    if (waiting == 0u) return false;
    take_up(lane.path);
    return true;
}

CAMERA_LANES(extend)
