// One step of explicit path tracing: to the next vertex, what is gathered there, and the ray after it; false where the path ends.
#include "transport/path.glsl"
#include "transport/nee.glsl"

bool path_extend(inout Path path, inout Estimate e) {
    Hit hit;
    Interaction at;
    bool found = path_trace(path, hit, at, e);
    if (!found) {
        if (HAS_BACKGROUND)
            contribute(e, path.depth + 1u, path.throughput * background_radiance(path.ray.direction) * background_weight(path));
        return false;
    }
    Vertex v = vertex_of(path.ray, at);
    path_absorb(path, v);
    path_measure(path, v);

    // 1. Emission that the path has run into.
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) contribute(e, path.depth + 1u, path.throughput * emission * emission_weight(path, hit, v));
    if (path.depth + 1u >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    // 2. Next-event estimation: a sample of the lights, weighted against the chance that the BSDF picks its direction.
    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    BsdfSample s = bsdf_choose(b, v.wo, bsdf_u.xyz);
    contribute(e, path.depth + 2u, next_event(path, v, b, path.throughput, light_u, s, e.rays));

    // 3. The next direction.
    path_scatter(path, v, b, s);

    // 4. Russian roulette. Radiance that is scaled by crossing into glass comes back when it leaves: eta^2 takes that out of the
    // decision.
    return path_survives(path, path.eta * path.eta, bsdf_u.w);
}
