// `photon`: progressive photon mapping (Hachisuka, Ogaki and Jensen 2008) in the form of Knaus and Zwicker 2011: each sample of the
// image is a photon map of its own, with a smaller radius than the one before, and the image is their mean. Biased at any number of
// samples, but the bias vanishes as that grows.
//
// The pass `light` follows paths from the lights and keeps photons where they meet what is not a mirror or smooth glass; the passes
// `grid-...` sort them; the pass `camera` goes through delta lobes only, and at each vertex gathers photons for all other lobes.
#version 460
#include "core/prelude.glsl"

// PARAM0
const uint DIRECT_NEE = 0u; // light that comes straight from its source is sampled there
const uint DIRECT_PHOTONS = 1u;

#include "techniques/photon/photons.glsl"

#if !defined(PASS_LIGHT) && !defined(PASS_CAMERA)
#include "core/grid_build.glsl"
#else
#include "trace/trace.glsl"
#include "transport/light_subpath.glsl"

#ifdef PASS_LIGHT
#include "techniques/photon/light_pass.glsl"
#else
#include "techniques/photon/gather.glsl"

bool path_extend(inout Path path, inout Estimate e) {
    Hit hit;
    Interaction at;
    uint length = path.depth + 1u;
    if (!path_trace(path, hit, at, e)) {
        if (HAS_BACKGROUND) contribute(e, length, path.throughput * background_radiance(path.ray.direction));
        return false;
    }
    Vertex v = vertex_of(path.ray, at);
    path_absorb(path, v);
    path_measure(path, v);

    // 1. Emission: all vertices before were delta, so that nothing else finds it.
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) contribute(e, length, path.throughput * emission);
    if (length >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    // 2. Lobes that are not delta: light straight from its source, and photons.
    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b)) {
        if (PARAM0 == DIRECT_NEE) {
            LightSample light = light_sample(vertex_receiver(v, b), light_u);
            vec3 wi = vertex_to_local(v, light.wi);
            vec3 radiance = path.throughput * vertex_eval(v, b, path.ray, wi, light.wi) * light.weight;
            if (radiance != vec3(0.0))
                contribute(e, length + 1u, radiance * vertex_transmittance(v, light, vertex_absorption(v, b, path.absorption, wi), e.rays));
        }
        gather_photons(path, v, b, e);
    }

    // 3. Delta lobes.
    BsdfSample s = vertex_sample(v, b, path.ray, bsdf_u.xyz);
    if (!s.delta) return false;
    path_scatter(path, v, b, s);
    return path_survives(path, path.eta * path.eta, bsdf_u.w);
}

#include "transport/lanes.glsl"
#endif
#endif
