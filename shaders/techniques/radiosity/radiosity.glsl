// `radiosity`: the surfaces are divided into patches, each with one irradiance H (Goral, Torrance, Greenberg and Battaile 1984,
// "Modeling the interaction of light between diffuse surfaces"). With the albedo r and the form factors F,
//     H_i = D_i + sum over j of F_ij r_j H_j,
// where D is the light that comes straight from its source.
//
// The pass `gather` is one round of it: stochastic Jacobi iteration (Neumann and Bekaert 1995; Bekaert 1999, section 6.3). No form
// factor is kept: rays with the density cos / pi meet patch j with the probability F_ij. The mean over rounds is the solution, once
// the rounds that prepare have sent the light of each length on its way. Lengths keep their layers: light of k segments to a patch
// is in layer k - 1, and each round takes every layer on by one.
//
// The passes `shoot` and `collect` do the same the other way round: rays carry power from the lights, and from patches in proportion to
// what they send out, to where they meet (Shirley 1990; Bekaert 1999, section 6.4).
//
// The pass `vertices` takes the values to the corners of the patches, the pass `pixels` shows them. Biased: the value is constant on a
// patch, and all surfaces are diffuse.
#version 460
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "techniques/radiosity/gather.glsl"
#include "generated/parameters.glsl"

#ifdef PASS_PIXELS
#include "transport/camera_lanes.glsl"

// The layer's irradiance at a hit.
vec3 shown(PatchTable t, uint index, vec2 c, uint layer) {
    if (SHOWN == SHOWN_VERTICES) return interpolated(t, index, c, layer);
    return received(t, (round_index() & 1u) ^ 1u, layer).at[index];
}

// A patch whose distance is less than so many times its own size is too coarse to be seen from there.
const float NEAR = 2.0;

// The final gather: a ray to the patches, and a sample of the lights, for the point itself (Reichert 1992; Lischinski, Tampieri and
// Greenberg 1993). A patch that is near is not asked, but gathered for in turn, as for photons (Jensen 2001, section 7.5 of part II):
// then the path goes on.
bool gather_finally(PatchTable t, Vertex v, vec3 carried, inout Path path, inout Estimate e) {
    vec4 light_u = next4(path.random);
    vec4 u = next4(path.random);
    vec3 normal = v.turned * v.basis.normal;
    Ray ray;
    Gathered g = gather(t, v.at, normal, u.xy, light_u, path.random, ray, e.rays);
    contribute(e, path.depth + 2u, carried * g.direct);
    if (g.from == NONE || path.depth + 3u > MAX_DEPTH) return false;
    if (g.distance < NEAR * sqrt(Patches(t.patches).at[g.from].area)) {
        path.ray = ray;
        path.from = ReferencePoint(ray.origin, normal, false);
        path.throughput = PI * carried;
        path_count(path);
        return path_survives(path, 1.0, u.z);
    }
    carried *= Values(t.albedo).at[g.from];
    for (uint layer = 0u; layer < t.layers && path.depth + layer + 3u <= MAX_DEPTH; layer++)
        contribute(e, path.depth + layer + 3u, carried * received(t, (round_index() & 1u) ^ 1u, layer).at[g.from]);
    return false;
}

bool show(inout Path path, inout Estimate e) {
    Vertex v;
    if (!path_arrive(path, v, e.rays)) {
        if (HAS_BACKGROUND && path.depth == 0u) contribute(e, 1u, background_contribution(path));
        return false;
    }
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0) && path.depth == 0u) contribute(e, 1u, path.throughput * emission); // later it is gathered
    if (path.depth + 2u > MAX_DEPTH || v.material == NONE) return false;

    // What the material returns of light that comes evenly from all sides: of a diffuse one its albedo, without noise.
    Bsdf b = vertex_material(v, path.ray, path.random);
    BsdfSample s = power_sample(v, b, path.ray, next4(path.random).xyz);
    vec3 carried = path.throughput * s.weight * (s.eta * s.eta * INV_PI);
    if (carried == vec3(0.0)) return false;
    PatchTable t = patch_table();
    if (SHOWN == SHOWN_GATHERED) return gather_finally(t, v, carried, path, e);
    vec2 c;
    uint index = patch_at(t, v.hit, v.at.position, v.front, c);
    if (index == NONE) return false;
    for (uint layer = 0u; layer < t.layers; layer++) contribute(e, layer + 2u, carried * shown(t, index, c, layer));
    return false;
}

bool extend(inout CameraLane lane) { return show(lane.path, lane.e); }

CAMERA_LANES(extend)
#elif defined(PASS_SHOOT) || defined(PASS_COLLECT)
#include "techniques/radiosity/shoot.glsl"
#else
#include "techniques/radiosity/passes.glsl"
#endif
