// The vertices of light paths that are kept for paths from the camera, and the connection to one.
#include "lib/light_path.glsl"
#include "lib/bidirectional.glsl"
#include "lib/kept_paths.glsl"

// What is kept of light path `index` of a sample. For a grid all paths of a sample lie there; else those of the frame, whose pixels
// are numbered like their paths.
LightPath light_path_of(uint index, uint sample_index) {
    if (frame.grid_cell_count > 0u) return light_path_at(uint64_t(index));
    return light_path_at(uint64_t(gl_GlobalInvocationID.x) * uint64_t(frame.sample_count) + uint64_t(sample_index - frame.first_sample));
}

// Ends what is kept of a light path that has met so many vertices.
void keep_count(LightPath kept, uint met) {
    kept.count = min(met, frame.light_vertices);
    if (met <= frame.light_vertices) return;
    for (uint i = 0u; i < kept.count; i++) kept.at[i].power *= kept_share(met);
}

// Density per scaled area with which a point of the lens is chosen; 0 where no light path runs into one.
float lens_choice() { return CONNECTS && MEETS_LENS && CAMERA == CAMERA_THIN_LENS ? 1.0 / scaled_area(lens_area()) : 0.0; }

// The path goes on from a vertex in the direction that its BSDF chose.
void partial_leave(inout Partial p, Vertex v, Bsdf b, BsdfSample s) {
    float cosine = abs(dot(vertex_to_world(v, s.wi), v.at.normal));
    // Refraction compresses solid angles by n_i^2 cos_i / (n_o^2 cos_o) (Veach 1997, section 5.2): turned round, its delta lobe is as much denser.
    float reverse_pdf_w = s.delta ? s.pdf_w * abs(v.wo.z / s.wi.z) / (s.eta * s.eta) : bsdf_pdf(b, s.wi, v.wo);
    partial_scatter(p, cosine, s.pdf_w, reverse_pdf_w, s.delta, vertex_opacity(v));
}

// A vertex of a path from the camera joined to one of a light path.
struct Connection {
    vec3 value;      // what the first receives over the path's throughput, were nothing in between
    float weight;    // of this among all strategies for the whole path
    Ray ray;         // from the first to the second
    vec3 absorption; // in between
};

// `random` is at the beginning of the light path.
Connection connect(Path path, Vertex v, Bsdf b, Partial p, LightVertex y, Sampler random) {
    Connection joined;
    joined.value = vec3(0.0);
    Ray arrived = Ray(y.position, y.direction, INFINITY);
    Vertex w = vertex_at(arrived, Hit(0.0, y.primitive, y.instance, y.uv));
    random.dimension = y.dimension;
    Bsdf c = vertex_material(w, arrived, random);

    vec3 d = w.at.position - v.at.position;
    float distance2 = dot(d, d);
    if (distance2 == 0.0) return joined;
    vec3 towards = d * inversesqrt(distance2);
    vec3 local = vertex_to_local(v, towards), other = vertex_to_local(w, -towards);
    joined.value = y.power * vertex_eval(v, b, path.ray, local, towards) * light_vertex_eval(w, c, arrived, other, -towards) / distance2;
    if (joined.value == vec3(0.0)) return joined;

    float area = scaled_area(distance2);
    float from_light = bsdf_pdf(c, w.wo, other) * abs(dot(towards, v.at.normal)) / area;
    float from_camera = bsdf_pdf(b, v.wo, local) * abs(dot(towards, w.at.normal)) / area;
    float others = partial_sum(p, from_light, bsdf_pdf(b, local, v.wo), vertex_opacity(v)) +
                   partial_sum(Partial(y.d_vcm, y.d_vc), from_camera, bsdf_pdf(c, other, w.wo), vertex_opacity(w));
    joined.weight = 1.0 / (1.0 + others);
    joined.ray = vertex_ray_to(v, towards, offset_origin(w.at.position, w.at.margin, w.at.normal, -towards));
    joined.absorption = vertex_absorption(v, b, path.absorption, local);
    return joined;
}
