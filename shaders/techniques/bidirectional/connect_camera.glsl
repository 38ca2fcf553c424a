// What vertices of light paths show to the camera: the strategies (s, 1).
#include "techniques/bidirectional/light_vertices.glsl"

// What a vertex shows to the camera, were nothing in between.
struct Shown {
    vec3 value;        // nothing where the camera does not see it
    float weight;      // among all strategies for the whole path
    vec2 position;     // in the image, in pixels
    vec2 u;            // chooses the pixel
    Ray ray;           // to the camera
    vec3 absorption;   // on the way
};

// (1, 1): the light itself, against (0, 2), the camera running into it.
Shown shown_light(Path path, EmittedRay e) {
    Shown shown;
    shown.value = vec3(0.0);
    LightView seen = light_view(e, path.random);
    if (!seen.visible) return shown;
    float camera_a = seen.camera.importance * seen.cosine / (seen.camera.distance2 * light_path_count()); // pixels per area
    shown.value = e.shown * camera_a;
    shown.weight = 1.0 / (1.0 + mis(camera_a / e.pdf_a));
    shown.position = seen.camera.position;
    shown.u = seen.u;
    shown.ray = seen.ray;
    shown.absorption = e.absorption;
    return shown;
}

// (s, 1), s > 1: the vertex that the path has come to.
Shown shown_vertex(Path path, vec3 power, Vertex v, Bsdf b, Partial p, vec4 u) {
    Shown shown;
    CameraView view = camera_view(v.at.position, u.xy);
    vec3 local = vertex_to_local(v, view.direction);
    shown.value = power * path.throughput * light_vertex_eval(v, b, path.ray, local, view.direction);
    if (!view.visible) shown.value = vec3(0.0);
    if (shown.value == vec3(0.0)) return shown;
    float camera_a = view.importance * abs(dot(view.direction, v.at.normal)) / (scaled_area(view.distance2) * light_path_count());
    float lens_a = lens_choice();
    vec2 pdf_w = lens_a > 0.0 ? bsdf_pdf_both(b, v.wo, local) : vec2(0.0, bsdf_pdf(b, local, v.wo));
    float others = partial_sum(p, camera_a, pdf_w.y, vertex_opacity(v));
    if (lens_a > 0.0) others += mis(pdf_w.x * lens_cosine(view.direction) / (scaled_area(view.distance2) * lens_a)); // t = 0
    shown.weight = 1.0 / (1.0 + others);
    shown.value *= view.importance / (view.distance2 * light_path_count());
    shown.position = view.position;
    shown.u = u.zw;
    shown.ray = vertex_ray_to(v, view.direction, view.target);
    shown.absorption = vertex_absorption(v, b, path.absorption, local);
    return shown;
}

// The light path has arrived at a vertex, at this cosine. What (1, t) would have picked its beginning with is known at the first one only.
void light_partial_arrive(inout Partial p, Path path, EmittedRay e, Vertex v, Bsdf b, float arriving) {
    vec3 segment = v.at.position - path.from.position;
    float distance2 = dot(segment, segment);
    if (path.depth > 0u) partial_arrive(p, distance2, arriving);
    else p = Partial(mis(light_choice_ratio(e, vertex_receiver(v, b), distance2) / arriving), e.delta ? 0.0 : mis(e.d_vc / arriving));
}
