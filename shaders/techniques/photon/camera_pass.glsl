// The pass `camera` of photon mapping: follows narrow lobes only, deltas among them, and at each vertex estimates the density of photons for all
// other lobes.
#include "techniques/photon/photons.glsl"
#include "transport/camera_lanes.glsl"
#include "transport/density_sums.glsl"
#include "transport/emission.glsl"
#include "transport/light_subpath.glsl"
#include "transport/split.glsl"
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
    // 1. Emission: next-event estimation finds it as well at the vertex before, if that lobe was no delta.
    Vertex v;
    const bool weighted = SPLITS && DIRECT == DIRECT_NEE;
    vec3 emission;
    uint length = path.depth + 1u;
    if (!arrive_at_emission(path, weighted, weighted, v, emission, e)) return false;
    if (length >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    // 2. Next-event estimation, and photons for broad lobes. With direct=photons, that of lights without extent on narrow lobes alone.
    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    BsdfSample s = bsdf_choose(b, v.wo, bsdf_u.xyz);
    const bool highlights = SPLITS && HAS_DELTA_LIGHTS; // of lights without extent on narrow lobes: nothing else finds them
    bool connects = (DIRECT == DIRECT_NEE || highlights) && !bsdf_is_delta(b);
    LightSample light = no_light();
    if (connects) light = light_sample(vertex_reference(v, b), light_u);
    SplitEvent n = split_connect(path, v, b, light, connects, s);
    float broad_weight = DIRECT == DIRECT_NEE ? 1.0 : 0.0;
    float narrow_weight = DIRECT == DIRECT_NEE ? nee_weight(n.narrow) : light.delta ? 1.0 : 0.0;
    if (connects) contribute(e, length + 1u, split_contribution(path, v, b, n, broad_weight, narrow_weight, e.rays));
    if (bsdf_has_broad(b)) add_photons(path, v, broad_lobes(b), e);

    // 3. Narrow lobes.
    if (!s.narrow) return false;
    path_scatter(path, v, b, s);
    return path_survives(path, path.eta * path.eta, bsdf_u.w);
}

bool extend(inout CameraLane lane) { return follow(lane.path, lane.e); }

CAMERA_LANES(extend)
