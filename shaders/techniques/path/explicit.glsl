// One step of explicit path tracing: to the next vertex, what is found and connected there, and the ray after it; false where the path ends.
#include "transport/emission.glsl"
#include "transport/nee.glsl"

bool explicit_extend(inout Path path, inout Estimate e) {
    // 1. Arrive at the next vertex, or leave the scene.
    Vertex v;
    if (!path_arrive(path, v, e.rays)) {
        if (HAS_BACKGROUND) contribute(e, path.depth + 1u, background_contribution(path) * background_weight(path));
        return false;
    }

    // 2. Emission that the path has run into.
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) contribute(e, path.depth + 1u, path.throughput * emission * emission_weight(path, v));
    if (path.depth + 1u >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    // 3. Next-event estimation, weighted against the BSDF's choice of the same direction. The sample of the BSDF for the next segment is drawn
    // before, as a mixture of lobes is evaluated for both directions by the same code.
    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    BsdfSample s = bsdf_choose(b, v.wo, bsdf_u.xyz);
    NextEvent n = nee_sample(path, v, b, light_u, s);
    contribute(e, path.depth + 2u, nee_contribution(path, v, b, n, path.throughput, nee_weight(n), e.rays));

    // 4. Scatter.
    path_scatter(path, v, b, s);

    // 5. Russian roulette. Radiance that is scaled by crossing into glass comes back when it leaves: eta^2 takes that out of the
    // decision.
    return path_survives(path, path.eta * path.eta, bsdf_u.w);
}
