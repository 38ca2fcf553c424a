// What photons around a vertex bring: the density estimate with a constant kernel (Jensen 1996).
#include "techniques/photon/photons.glsl"
#include "transport/density_sums.glsl"
#include "core/grid.glsl"
#include "transport/light_subpath.glsl"

void gather_photons(Path path, Vertex v, Bsdf b, inout Estimate e) {
    uint length = path.depth + 1u;
    vec3 factor = path.throughput / (PI * frame.merge_radius * frame.merge_radius * light_path_count() * scene.splat_unit);
    Gathered gathered;
    gather_nothing(gathered);
    GridSearch search = grid_search(v.at.position);
    while (grid_next(search)) {
        PhotonPath kept = photon_path(search.index / frame.light_vertices);
        uint place = search.index % frame.light_vertices;
        if (!grid_found(search, kept.at[place].position)) continue;
        Photon y = kept.at[place];
        // Photons are as dense as the geometric cosine says, the BSDF goes by the shading one.
        float arriving = abs(dot(y.direction, y.normal));
        if (!same_facing(y.normal, v.at.normal) || arriving == 0.0 || y.segments > MAX_DEPTH - length) continue;
        vec3 f = vertex_eval(v, b, path.ray, vertex_to_local(v, -y.direction), -y.direction);
        gather(gathered, length + y.segments, factor * y.power * f / arriving);
    }
    contribute_gathered(e, gathered);
}
