// The vertices of light paths that are kept for paths from the camera, and the connection to one.
#include "transport/light_subpath.glsl"
#include "techniques/bidirectional/mis.glsl"
#include "techniques/bidirectional/kept_paths.glsl"

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

// Chooses the direction in which the path goes on, and takes the step in its sums.
BsdfSample partial_leave(inout Partial p, Vertex v, Bsdf b, Ray ray, vec3 u) {
    BsdfSample s = bsdf_choose(b, v.wo, u);
    vec2 pdf_w = HAS_OPEN_SAMPLES ? bsdf_pdf_both(b, v.wo, s.wi) : vec2(0.0, bsdf_pdf(b, s.wi, v.wo));
    bsdf_close(b, v.wo, pdf_w.x, s);
    vertex_check(v, ray, s);
    float cosine = abs(dot(vertex_to_world(v, s.wi), v.at.normal));
    // Refraction compresses solid angles by n_i^2 cos_i / (n_o^2 cos_o) (Veach 1997, section 5.2): turned round, its delta lobe is as much denser.
    float reverse_pdf_w = s.delta ? s.pdf_w * abs(v.wo.z / s.wi.z) / (s.eta * s.eta) : pdf_w.y;
    partial_scatter(p, cosine, s.pdf_w, reverse_pdf_w, s.delta, vertex_opacity(v));
    return s;
}
