// The vertices of light paths that are kept for paths from the camera, and the connection to one.
#include "lib/light_path.glsl"
#include "lib/bidirectional.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LightPath { uint count; LightVertex at[]; };

// The light path of the same slot and sample.
LightPath light_path_of(Pixel pixel) {
    uint64_t index = uint64_t(gl_GlobalInvocationID.x) * uint64_t(frame.sample_count) + uint64_t(pixel.sample_index - frame.first_sample);
    uint64_t bytes = 4ul + uint64_t(LIGHT_VERTEX_BYTES) * uint64_t(frame.light_vertices);
    return LightPath(unpack32(pack64(frame.light_paths) + index * bytes));
}

void keep_light_vertex(Pixel pixel, uint index, LightVertex y) { light_path_of(pixel).at[index] = y; }
void keep_light_vertex_count(Pixel pixel, uint count) { light_path_of(pixel).count = count; }

// What the vertex of a path from the camera receives from a vertex of the light path, over the path's throughput, and the weight of that
// among all strategies for the whole path.
vec3 connect(Pixel pixel, Path path, Vertex v, Bsdf b, Partial p, LightVertex y, out float weight, inout uint rays) {
    weight = 0.0;
    Ray arrived = Ray(y.position, y.direction, INFINITY);
    Vertex w = vertex_at(arrived, Hit(0.0, y.primitive, y.instance, y.uv));
    Sampler random = Sampler(pixel.index, pixel.sample_index, y.dimension, frame.seed);
    Bsdf c = vertex_material(w, arrived, random);

    vec3 d = w.at.position - v.at.position;
    float distance2 = dot(d, d);
    if (distance2 == 0.0) return vec3(0.0);
    vec3 towards = d * inversesqrt(distance2);
    vec3 local = vertex_to_local(v, towards), other = vertex_to_local(w, -towards);
    vec3 value = y.power * vertex_eval(v, b, path.ray, local, towards) * light_vertex_eval(w, c, arrived, other, -towards) / distance2;
    if (value == vec3(0.0)) return value;

    float area = scaled_area(distance2);
    float from_light = bsdf_pdf(c, w.wo, other) * abs(dot(towards, v.at.normal)) / area;
    float from_camera = bsdf_pdf(b, v.wo, local) * abs(dot(towards, w.at.normal)) / area;
    float others = partial_sum(p, from_light, bsdf_pdf(b, local, v.wo)) + partial_sum(Partial(y.d_vcm, y.d_vc), from_camera, bsdf_pdf(c, other, w.wo));

    Ray ray = vertex_ray(v, towards);
    vec3 reach = offset_origin(w.at.position, w.at.margin, w.at.normal, -towards) - ray.origin;
    float distance = length(reach);
    ray.direction = reach / distance;
    ray.t_max = distance * (1.0 - gamma(8.0));
    weight = 1.0 / (1.0 + others);
    return value * segment_transmittance(ray, vertex_absorption(v, b, path.absorption, local), rays);
}
