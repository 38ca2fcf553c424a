// Vertices of light subpaths as a pass leaves them for another one: those that are not delta alone.
#include "transport/light_subpath.glsl"

// What is kept of a light subpath.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LightPath { uint count; LightVertex at[]; };

LightPath light_path_at(uint64_t place) {
    uint64_t bytes = 4ul + uint64_t(LIGHT_VERTEX_BYTES) * uint64_t(light_table.light_vertices);
    return LightPath(unpack32(pack64(light_table.light_paths) + place * bytes));
}

// The ray by which light arrived at a vertex that was kept.
Ray light_vertex_ray(LightVertex y) { return Ray(y.position, y.direction, INFINITY); }

// The vertex again, with its material; `random` is at the beginning of its subpath.
Vertex light_vertex(LightVertex y, Sampler random, out Bsdf b) {
    Ray arrived = light_vertex_ray(y);
    Vertex v = vertex_at(arrived, Hit(0.0, y.primitive, y.instance, y.uv));
    random.dimension = y.dimension;
    b = vertex_material(v, arrived, random);
    return v;
}

// Ends what is kept of a light subpath that has met so many vertices: where those are more than there is room for, the ones that are kept
// stand for all.
void light_path_close(LightPath kept, uint met) {
    kept.count = min(met, light_table.light_vertices);
    if (met <= light_table.light_vertices) return;
    for (uint i = 0u; i < kept.count; i++) kept.at[i].power *= kept_share(met);
}
