// Contributions of a vertex with their weights: emission that a camera subpath runs into, (0, t); the connection of its vertex to a sample of the
// lights, (1, t), or to a vertex of a light subpath, (s, t); and the connection of a light subpath's vertex to the camera, (s, 1).
#include "techniques/bidirectional/mis.glsl"
#include "transport/camera_connection.glsl"
#include "transport/emission.glsl"
#include "transport/light_vertices.glsl"
#include "transport/nee.glsl"

// The vertices of light subpath `index` of a sample. For a grid all subpaths of a sample are kept; else those of the frame's lanes alone, whose
// pixels have the numbers of their subpaths.
LightPath light_path_of(uint index, uint sample_index) {
    if (light_subpaths.grid_cell_count > 0u) return light_path_at(uint64_t(index));
    return light_path_at(uint64_t(gl_GlobalInvocationID.x) * uint64_t(frame.sample_count) + uint64_t(sample_index - frame.first_sample));
}

// Density per scaled area with which a point of the lens is chosen; 0 where no light subpath runs into one.
float lens_choice() { return CONNECTS && MEETS_LENS && !HIDES_EMITTERS && CAMERA == CAMERA_THIN_LENS ? 1.0 / scaled_area(lens_area()) : 0.0; }

// Adds the contribution of (s, t) to the path's own pixel.
void add_strategy(Pixel pixel, inout Estimate e, uint s, uint t, vec3 value, float weight) {
    if (value != vec3(0.0)) record_strategy(s, t, value, weight, 0u);
    if (HAS_STRATEGIES) splat_strategy(pixel.index, pixel.sample_index, s, t, value * pixel.filter_weight, weight);
    else contribute(e, s + t - 1u, value * weight);
}

// (0, t): the path has left the scene and sees the background.
void add_background(Pixel pixel, Path path, SubpathMis m, bool both_sides, inout Estimate e) {
    float pdf_w = background_pdf(path.ray.direction);
    float weight = 1.0;
    // d_vcm and d_vc are still over solid angle: a light subpath begins on a disk.
    float emission_a = disk_pdf(path.ray.origin, path.ray.direction) / scaled_area(1.0);
    if (path.depth > 0u)
        weight = both_sides ? 1.0 / (1.0 + if_connected(m.d_vcm) * heuristic(pdf_w) + m.d_vc * heuristic(pdf_w * emission_a)) : mis_long_weight(path, pdf_w);
    add_strategy(pixel, e, 0u, path.depth + 2u, background_contribution(path), weight);
}

// (0, t): the path has run into a light.
void add_emission(Pixel pixel, Path path, Vertex v, SubpathMis m, bool both_sides, float cosine, float distance2, inout Estimate e) {
    vec3 emission = vertex_emission(v, path.ray);
    if (emission == vec3(0.0)) return;
    float choice = path.depth > 0u && !path.delta ? light_pdf(path.from, path.ray, v.hit, v.at, v.surface) : 0.0;
    float weight = 1.0;
    if (both_sides) {
        float emission_w = surface_emission_pdf(v.at.position, -path.ray.direction, cosine);
        weight = mis_emission_weight(path, m, choice, cosine, distance2, v.surface.emission_density / scaled_area(1.0), emission_w);
    } else {
        weight = mis_long_weight(path, choice);
    }
    add_strategy(pixel, e, 0u, path.depth + 2u, path.throughput * emission, weight);
}

// A vertex of a camera subpath connected to a light or to a vertex of a light subpath.
struct Connection {
    vec3 contribution; // were nothing in between
    float weight;      // MIS weight among all strategies for the whole path
    Ray ray;           // from the first to the second
    vec3 absorption;   // of the medium in between, 1/m
};

// What is to be connected to: a sample of the lights (s = 1, next-event estimation), or a vertex of a light subpath (s > 1). Both in one function,
// so that a kernel holds the BSDF at the camera's vertex once.
struct End {
    bool light;
    vec4 u;         // chooses the sample of the lights
    LightVertex y;  // the vertex otherwise
    Sampler random; // at the beginning of its subpath
};

Connection connect(Path path, Vertex v, Bsdf b, SubpathMis m, bool both_sides, End end) {
    Connection c;
    c.contribution = vec3(0.0);
    LightSample light = no_light();
    Vertex w;
    Bsdf far;
    Ray arrived = light_vertex_ray(end.y);
    float distance2 = 1.0;
    vec3 towards;
    if (end.light) {
        light = light_sample(vertex_reference(v, b), end.u);
        towards = light.wi;
    } else {
        w = light_vertex(end.y, end.random, far);
        vec3 d = w.at.position - v.at.position;
        distance2 = dot(d, d);
        if (distance2 == 0.0) return c;
        towards = d * inversesqrt(distance2);
    }
    vec3 local = vertex_to_local(v, towards), other = vec3(0.0);
    vec3 f = vertex_eval(v, b, path.ray, local, towards);
    if (end.light) {
        c.contribution = nee_unoccluded(path.throughput, f, light);
    } else {
        other = vertex_to_local(w, -towards);
        c.contribution = end.y.power * f * light_vertex_eval(w, far, arrived, other, -towards) / distance2;
    }
    if (c.contribution == vec3(0.0)) return c;

    vec2 pdf_w = bsdf_pdf_both(b, v.wo, local);
    float opacity = vertex_opacity(v);
    float others;
    if (end.light) {
        others = heuristic((light.delta ? 0.0 : pdf_w.x) / light.pdf_w); // eq. 44
        // eq. 45
        if (both_sides) others += mis_connection(m, light.emitted * abs(dot(light.wi, v.at.normal)) / scaled_area(1.0), pdf_w.y, opacity);
        c.ray = shadow_ray(v.at, light);
    } else {
        c.contribution *= path.throughput;
        vec2 far_pdf_w = bsdf_pdf_both(far, w.wo, other);
        float area = scaled_area(distance2);
        float from_light = far_pdf_w.x * abs(dot(towards, v.at.normal)) / area;
        float from_camera = pdf_w.x * abs(dot(towards, w.at.normal)) / area;
        // eqs. 41 and 40
        others = mis_connection(m, from_light, pdf_w.y, opacity) +
                 mis_connection(SubpathMis(end.y.d_vcm, end.y.d_vc), from_camera, far_pdf_w.y, vertex_opacity(w));
        c.ray = vertex_ray_between(v, towards, w);
    }
    c.weight = 1.0 / (1.0 + others); // eq. 37
    c.absorption = vertex_absorption(v, b, path.absorption, local);
    return c;
}

// Adds the contribution of (s, t), as far as it comes through.
void add_connection(Pixel pixel, inout Estimate e, uint s, uint t, Connection c) {
    add_strategy(pixel, e, s, t, c.contribution * ray_transmittance(c.ray, false, c.absorption, e.rays), c.weight);
}

// (1, 1): the light itself connected to the camera, against (0, 2), the camera running into it.
CameraConnection connect_light_to_camera(Path path, EmittedRay e) {
    float camera_a;
    CameraConnection c = camera_connect_light(path, e, camera_a);
    if (c.contribution != vec3(0.0)) c.weight = 1.0 / (1.0 + heuristic(camera_a / e.pdf_a));
    return c;
}

// (s, 1), s > 1: the vertex that the light subpath has come to connected to the camera (eqs. 37, 46 and 47).
CameraConnection connect_vertex_to_camera(Path path, vec3 power, Vertex v, Bsdf b, SubpathMis m, vec4 u) {
    CameraConnection c = camera_connect_vertex(path, power, v, b, u);
    if (c.contribution == vec3(0.0)) return c;
    vec3 local = vertex_to_local(v, c.view.direction);
    float camera_a = c.view.importance * abs(dot(c.view.direction, v.at.normal)) / (scaled_area(c.view.distance2) * light_path_count());
    float lens_a = lens_choice();
    vec2 pdf_w = lens_a > 0.0 ? bsdf_pdf_both(b, v.wo, local) : vec2(0.0, bsdf_pdf(b, local, v.wo));
    float others = mis_connection(m, camera_a, pdf_w.y, vertex_opacity(v));
    if (lens_a > 0.0) others += heuristic(pdf_w.x * lens_cosine(c.view.direction) / (scaled_area(c.view.distance2) * lens_a)); // t = 0
    c.weight = 1.0 / (1.0 + others);
    return c;
}
