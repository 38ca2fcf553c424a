// The pass `camera` of photon mapping: goes through delta lobes only, and at each vertex estimates the density of photons for all other lobes.
#include "techniques/photon/photons.glsl"
#include "transport/camera_lanes.glsl"
#include "transport/density_sums.glsl"
#include "transport/emission.glsl"
#include "transport/light_subpath.glsl"
#include "transport/nee.glsl"
#include "core/grid.glsl"

// Radiance of the photons around a vertex: the density estimate with a constant kernel (Jensen 1996).
void add_photons(Path path, Vertex v, Bsdf b, inout Estimate e) {
    uint length = path.depth + 1u;
    vec3 factor = path.throughput / (PI * merge_radius() * merge_radius() * light_path_count() * scene.splat_unit);
    DensitySums sums;
    density_clear(sums);
    GridSearch search = grid_search(v.at.position);
    while (grid_next(search)) {
        PhotonPath kept = photon_path(search.index / light_subpaths.light_vertices);
        uint place = search.index % light_subpaths.light_vertices;
        if (!grid_found(search, kept.at[place].position)) continue;
        Photon y = kept.at[place];
        // Photons are as dense as the geometric cosine says, the BSDF goes by the shading one.
        float arriving = abs(dot(y.direction, y.normal));
        if (!same_facing(y.normal, v.at.normal) || arriving == 0.0 || y.segments > MAX_DEPTH - length) continue;
        vec3 f = vertex_eval(v, b, path.ray, vertex_to_local(v, -y.direction), -y.direction);
        density_add(sums, length + y.segments, factor * y.power * f / arriving);
    }
    density_contribute(e, sums);
}

bool follow(inout Path path, inout Estimate e) {
    // 1. Emission: all vertices before were delta, so that nothing else finds it.
    Vertex v;
    vec3 emission;
    uint length = path.depth + 1u;
    if (!arrive_at_emission(path, v, emission, e)) return false;
    if (length >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    // 2. Lobes that are not delta: next-event estimation, and photons.
    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    BsdfSample s = bsdf_choose(b, v.wo, bsdf_u.xyz);
    if (DIRECT == DIRECT_NEE) {
        NextEvent n = nee_sample(path, v, b, light_u, s);
        contribute(e, length + 1u, nee_contribution(path, v, b, n, path.throughput, 1.0, e.rays));
    }
    if (!bsdf_is_delta(b)) add_photons(path, v, b, e);

    // 3. Delta lobes.
    vertex_check(v, path.ray, s);
    if (!s.delta) return false;
    path_scatter(path, v, b, s);
    return path_survives(path, path.eta * path.eta, bsdf_u.w);
}

bool extend(inout CameraLane lane) { return follow(lane.path, lane.e); }

CAMERA_LANES(extend)
