// What a point of a diffuse surface receives, by one ray: light that comes straight from its source, and the patch that would send it
// more.
#include "techniques/radiosity/patches.glsl"
#include "transport/emission.glsl"
#include "transport/nee.glsl"

struct Gathered {
    vec3 direct;    // irradiance from lights, W/m^2
    uint from;      // the patch that the ray met, or NONE
    float distance; // to there
    uint met;       // what it met, as a column of the counts
};

// Irradiance from a sample of the lights. Where emission is found by rays alone, there are no other lights.
vec3 gather_light(Interaction at, vec3 normal, vec4 u, inout uint rays) {
    LightSample light = light_sample(ReferencePoint(at.position, normal, false), u);
    float cosine = dot(normal, light.wi);
    if (cosine <= 0.0 || light.weight == vec3(0.0)) return vec3(0.0);
    float weight = light.delta ? 1.0 : power_heuristic(light.pdf_w, INV_PI * cosine);
    return light.weight * (cosine * weight * trace_transmittance(shadow_ray(at, light), false, rays));
}

// `normal` is that of the side that receives. The ray's direction has the density cos / pi, so that what comes along it counts pi times
// its radiance, and the share of rays that meet a patch is the form factor to it (Goral et al. 1984, equation 3; as an expectation,
// Neumann 1995).
Gathered gather(PatchTable t, Interaction at, vec3 normal, vec2 u, vec4 light_u, inout Sampler random, out Ray ray, inout uint rays) {
    Gathered g = Gathered(vec3(0.0), NONE, 0.0, 0u);
    if (t.found == 0u) g.direct = gather_light(at, normal, light_u, rays);

    vec3 local = sample_cosine_hemisphere(u);
    vec3 w = to_world(basis_from_normal(normal), local);
    float pdf_w = INV_PI * local.z;
    ray = Ray(offset_origin(at.position, at.margin, at.normal, w), w, INFINITY);
    ReferencePoint from = ReferencePoint(ray.origin, normal, false);
    Vertex v;
    Ray moved = ray; // behind masks that let it pass
    if (!vertex_arrive(moved, false, v, random, rays)) {
        if (HAS_BACKGROUND) g.direct += PI * background_radiance(w) * power_heuristic(pdf_w, background_pdf(w));
        return g;
    }
    vec3 emission = vertex_emission(v, moved);
    if (emission != vec3(0.0)) {
        float weight = t.found != 0u ? 1.0 : power_heuristic(pdf_w, light_pdf(from, moved, v.hit, v.at, v.surface));
        g.direct += PI * weight * emission;
    }
    g.distance = distance(ray.origin, v.at.position);
    ray = moved;
    vec2 c;
    g.from = patch_at(t, v.hit, v.at.position, v.front, c);
    g.met = g.from == NONE ? 1u : Patches(t.patches).at[g.from].column;
    return g;
}
