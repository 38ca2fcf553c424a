// A vertex of a light subpath connected to the camera (t = 1): what light tracing splats (Arvo 1986; Veach 1997, section 10.2).
#include "transport/light_subpath.glsl"
#include "core/splat.glsl"

// Whether some light is seen by the camera: those without extent, and those infinitely far, do not meet it at the end of a segment.
const bool HAS_SEEN_LIGHTS = HAS_TRIANGLE_LIGHTS || HAS_SPHERE_LIGHTS;

// A vertex connected to a point of the camera, before its visibility is known.
struct CameraConnection {
    vec3 contribution; // to its pixel; nothing where the camera does not see the vertex
    float weight;      // MIS weight among all strategies for the whole path
    vec2 position;     // in the image, in pixels
    vec2 u;            // chooses the pixel, by the filter
    Ray ray;           // from the vertex to the camera
    vec3 absorption;   // of the medium in between, 1/m
    CameraView view;
};

CameraConnection no_camera_connection() {
    CameraConnection c;
    c.contribution = vec3(0.0);
    c.weight = 1.0;
    return c;
}

// (1, 1): the beginning of a light subpath on an area light, unweighted. `camera_a` is the density of camera paths that arrive there, per
// area, times the number of light subpaths.
CameraConnection camera_connect_light(Path path, EmittedRay e, out float camera_a) {
    CameraConnection c = no_camera_connection();
    camera_a = 0.0;
    if (HIDES_EMITTERS || !HAS_SEEN_LIGHTS) return c;
    LightView seen = light_view(e, path.random);
    if (!seen.visible) return c;
    camera_a = seen.camera.importance * seen.cosine / (seen.camera.distance2 * light_path_count());
    c.contribution = e.radiance_over_pdf * camera_a;
    c.position = seen.camera.position;
    c.u = seen.u;
    c.ray = seen.ray;
    c.absorption = e.absorption;
    return c;
}

// (s, 1), s > 1: the vertex that the light subpath has arrived at, unweighted. u.xy chooses the point of the lens.
CameraConnection camera_connect_vertex(Path path, vec3 power, Vertex v, Bsdf b, vec4 u) {
    CameraConnection c = no_camera_connection();
    c.view = camera_view(v.at.position, u.xy);
    vec3 local = vertex_to_local(v, c.view.direction);
    if (!c.view.visible || is_hidden(true, v.at.surface)) return c;
    c.contribution = power * path.throughput * light_vertex_eval(v, b, path.ray, local, c.view.direction);
    if (c.contribution == vec3(0.0)) return c;
    c.contribution *= c.view.importance / (c.view.distance2 * light_path_count());
    c.position = c.view.position;
    c.u = u.zw;
    c.ray = vertex_ray_to(v, c.view.direction, c.view.target);
    c.absorption = vertex_absorption(v, b, path.absorption, local);
    return c;
}

// Splats (s, 1) with its weight, as far as it comes through.
void camera_splat(CameraConnection c, uint sample_index, uint s, inout uint rays) {
    uint pixel = c.contribution != vec3(0.0) ? splat_pixel(c.position, c.u, c.contribution) : NONE;
    if (pixel == NONE) return;
    c.contribution *= ray_transmittance(c.ray, true, c.absorption, rays);
    splat_weighted(pixel, sample_index, s, 1u, c.contribution, c.weight);
}

// Splats the connections of the subpath's beginning and of the vertex that it has arrived at, in turns: the kernel traces such rays in one
// place. The former counts once.
void camera_splat_both(inout CameraConnection light, CameraConnection vertex, uint sample_index, uint s, inout uint rays) {
    if (!HAS_SEEN_LIGHTS) {
        if (vertex.contribution != vec3(0.0)) camera_splat(vertex, sample_index, s, rays);
        return;
    }
    for (uint turn = 0u; turn < turns(2u); turn++) {
        bool first = turn == 0u;
        CameraConnection c = vertex;
        if (first) c = light;
        if (c.contribution != vec3(0.0)) camera_splat(c, sample_index, first ? 1u : s, rays);
    }
    light.contribution = vec3(0.0);
}
