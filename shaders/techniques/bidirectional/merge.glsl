// Vertex merging: the end of a path from the camera and that of a light path, close enough to be taken for one vertex (Georgiev,
// Krivanek, Davidovic and Slusallek 2012; the density estimate is that of photon mapping with a constant kernel).
#include "techniques/bidirectional/light_vertices.glsl"
#include "transport/density_sums.glsl"
#include "core/grid.glsl"

// Weight of a merge of the camera's vertex v with y among all strategies; `local` is the direction in which y's light came.
float merge_weight(Vertex v, Bsdf b, Partial p, LightVertex y, vec3 local) {
    if (MERGES_FIRST) return 1.0; // nothing else finds the path
    float opacity = vertex_opacity(v);
    vec2 pdf_w = bsdf_pdf_both(b, v.wo, local);
    return 1.0 / (1.0 + partial_merge_sum(p, pdf_w.y, opacity) + partial_merge_sum(Partial(y.d_vcm, y.d_vc), pdf_w.x, opacity));
}

void gather_merges(Path path, Vertex v, Bsdf b, Partial p, inout Estimate e) {
    uint length = path.depth + 1u;
    float area = PI * frame.merge_radius * frame.merge_radius;
    vec3 factor = path.throughput / (area * vertex_opacity(v) * light_path_count() * scene.splat_unit);
    Gathered gathered;
    gather_nothing(gathered);
    GridSearch search = grid_search(v.at.position);
    while (grid_next(search)) {
        LightPath kept = light_path_at(uint64_t(search.index / frame.light_vertices));
        uint place = search.index % frame.light_vertices;
        if (!grid_found(search, kept.at[place].position)) continue;
        LightVertex y = kept.at[place];
        // Light arrives as densely as the geometric cosine says, the BSDF goes by the shading one.
        float arriving = abs(dot(y.direction, y.normal));
        if (!same_facing(y.normal, v.at.normal) || arriving == 0.0 || y.segments > longest() - length) continue;
        vec3 local = vertex_to_local(v, -y.direction);
        vec3 f = vertex_eval(v, b, path.ray, local, -y.direction);
        if (f != vec3(0.0)) gather(gathered, length + y.segments, factor * y.power * f * (merge_weight(v, b, p, y, local) / arriving));
    }
    contribute_gathered(e, gathered);
}
