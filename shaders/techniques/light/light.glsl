// `light`: light tracing. Paths from the lights; each of their vertices is shown to the camera (Arvo 1986; Dutre, Lafortune and
// Willems 1993). What reaches the camera by way of a mirror or glass has no vertex that a camera without extent could see: it is missing.
#version 460
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "core/splat.glsl"

#ifdef PASS_RESOLVE
#include "core/resolve.glsl"
#else
#include "transport/light_subpath.glsl"

layout(local_size_x = WORKGROUP) in;

// Shows the light itself to the camera: a path of one segment.
void show_light(Pixel pixel, Path path, EmittedRay e, inout uint rays) {
    LightView seen = light_view(e, path.random);
    if (!seen.visible) return;
    vec3 value = e.shown * (seen.cosine * seen.camera.importance / (seen.camera.distance2 * light_path_count()));
    uint seen_by = splat_pixel(seen.camera.position, seen.u, value);
    if (seen_by != NONE) splat(seen_by, pixel.sample_index, 1u, value * ray_transmittance(seen.ray, e.absorption, rays));
}

// Follows the path to its next vertex, shows that to the camera, and chooses the ray after it.
bool light_path_extend(Pixel pixel, inout Path path, vec3 power, inout uint rays) {
    Hit hit;
    Interaction at;
    if (!trace_visible(path.ray, hit, at, path.random, rays)) return false;
    Vertex v = vertex_of(path.ray, at);
    path_absorb(path, v);
    if (v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    uint length = path.depth + 2u; // segments with the one to the camera

    vec4 u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b)) {
        CameraView view = camera_view(v.at.position, u.xy);
        vec3 local = vertex_to_local(v, view.direction);
        vec3 value = power * path.throughput * light_vertex_eval(v, b, path.ray, local, view.direction);
        value *= view.importance / (view.distance2 * light_path_count());
        uint seen_by = view.visible && value != vec3(0.0) ? splat_pixel(view.position, u.zw, value) : NONE;
        if (seen_by != NONE) {
            value *= ray_transmittance(vertex_ray_to(v, view.direction, view.target), vertex_absorption(v, b, path.absorption, local), rays);
            splat(seen_by, pixel.sample_index, length, value);
        }
    }
    if (length >= MAX_DEPTH) return false;
    path_scatter(path, v, b, light_vertex_sample(v, b, path.ray, bsdf_u.xyz));
    return path_survives(path, 1.0, bsdf_u.w);
}

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    uint rays = 0u;
    Path path;
    EmittedRay emitted;
    bool alive = false;
    while (alive || pixel_has_sample(pixel)) {
        if (!alive) {
            path = light_path_begin(pixel.index, pixel.sample_index, emitted);
            if (MAX_DEPTH > 0u) show_light(pixel, path, emitted, rays);
        }
        alive = MAX_DEPTH > 1u && emitted.power != vec3(0.0) && light_path_extend(pixel, path, emitted.power, rays);
        if (!alive) pixel.sample_index += 1u;
    }
    count_rays(rays);
}
#endif
