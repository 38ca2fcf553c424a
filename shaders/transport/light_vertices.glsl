// Vertices of light subpaths as a pass leaves them for another one: those that are not delta alone.
#include "transport/light_subpath.glsl"

// What is kept of a light subpath.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LightPath { uint count; LightVertex at[]; };

LightPath light_path_at(uint64_t index) { return LightPath(light_path_address(index, LIGHT_VERTEX_BYTES)); }

// The ray by which light arrived at a vertex that was kept.
Ray light_vertex_ray(LightVertex y) { return Ray(y.position, y.direction, INFINITY); }

// The vertex again, with its material; `random` is at the beginning of its subpath.
Vertex light_vertex(LightVertex y, Sampler random, out Bsdf b) {
    Ray arrived = light_vertex_ray(y);
    Vertex v = vertex_at(arrived, Hit(0.0, y.primitive, y.instance, y.uv));
    v.from_light = true;
    random.dimension = y.dimension;
    b = vertex_material(v, arrived, random);
    return v;
}
