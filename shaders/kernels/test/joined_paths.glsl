// The paths that bdpt joins, vertex by vertex, one from the light and one from the camera for each pixel of the first sample: followed as
// techniques/bidirectional/light_pass.glsl and camera_pass.glsl do, with the same random numbers. The layout of an answer is
// src/verify/path_weights.rs's.
// Parameters of technique: bdpt
#version 460
#include "core/prelude.glsl"
#include "kernels/probe.glsl"

#define STRATEGIES_OF_BDPT

#include "trace/trace.glsl"
#include "techniques/bidirectional/mis.glsl"
#include "core/splat.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Answers { float at[]; };

const uint MOST = 8u;                // vertices of a path that fit
const uint HEAD = 4u;                // floats before them
const uint FROM_LIGHT = 12u;         // floats of a vertex from the light
const uint FROM_CAMERA = 8u;         // ... from the camera
const uint ANSWER = HEAD + (FROM_LIGHT + FROM_CAMERA) * MOST;

uint answer;

void put(uint place, vec3 v) {
    for (uint axis = 0u; axis < 3u; axis++) Answers(PROBE_OUTPUT).at[answer + place + axis] = v[axis];
}

void put(uint place, float x) { Answers(PROBE_OUTPUT).at[answer + place] = x; }

uint light_place(uint vertex) { return HEAD + FROM_LIGHT * vertex; }
uint camera_place(uint vertex) { return HEAD + FROM_LIGHT * MOST + FROM_CAMERA * vertex; }

// A vertex from the light: where it is, the point of the camera that it is connected to, and the pixel.
void put_light_vertex(uint vertex, vec3 position, bool delta, CameraView view, bool visible, vec4 u) {
    vec3 value = vec3(1.0);
    uint seen_by = visible ? splat_pixel(view.position, u.zw, value) : NONE;
    put(light_place(vertex), position);
    put(light_place(vertex) + 3u, delta ? 1.0 : 0.0);
    put(light_place(vertex) + 4u, view.target);
    put(light_place(vertex) + 7u, seen_by == NONE ? -1.0 : float(seen_by));
    put(light_place(vertex) + 11u, -1.0);
}

// Where the ray from that vertex runs into the lens.
void put_lens(uint vertex, Ray ray, float end, Sampler random) {
    vec2 position;
    float t;
    if (!lens_hit(ray, end, position, t)) return;
    vec4 u = next4(random);
    vec3 value = vec3(1.0);
    uint seen_by = splat_pixel(position, u.xy, value);
    if (seen_by == NONE) return;
    put(light_place(vertex) + 8u, ray.origin + t * ray.direction);
    put(light_place(vertex) + 11u, float(seen_by));
}

// Returns the number of vertices.
uint follow_light(Pixel pixel, inout uint rays) {
    EmittedRay e;
    Path path = light_path_begin(pixel.index, pixel.sample_index, e);
    LightView seen = light_view(e, path.random);
    Sampler random = path.random;
    put_light_vertex(0u, e.position, false, seen.camera, seen.visible, vec4(0.0, 0.0, seen.u));
    for (uint vertex = 1u;; vertex++) {
        Vertex v;
        Ray ray = path.ray;
        bool found = path_arrive(path, v, rays);
        if (CAMERA == CAMERA_THIN_LENS && path.depth > 0u) put_lens(vertex - 1u, ray, found ? v.hit.t : INFINITY, path.random);
        if (!found || vertex == MOST) return vertex;
        if (v.material == NONE) return vertex;
        Bsdf b = vertex_material(v, path.ray, path.random);
        vec4 u = next4(path.random);
        vec4 bsdf_u = next4(path.random);
        CameraView view = camera_view(v.at.position, u.xy);
        put_light_vertex(vertex, v.at.position, bsdf_is_delta(b), view, view.visible, u);
        path_scatter(path, v, b, light_vertex_sample(v, b, path.ray, bsdf_u.xyz));
        if (!path_survives(path, 1.0, bsdf_u.w)) return vertex + 1u;
    }
}

uint follow_camera(Pixel pixel, inout Estimate e) {
    Sampler random;
    Ray ray = sample_open(pixel, e, random);
    Path path = path_from_camera(ray, random);
    put(camera_place(0u), path.ray.origin);
    for (uint vertex = 1u;; vertex++) {
        Vertex v;
        if (vertex == MOST || !path_arrive(path, v, e.rays)) return vertex;
        put(camera_place(vertex), v.at.position);
        if (v.material == NONE) return vertex + 1u;
        Bsdf b = vertex_material(v, path.ray, path.random);
        vec4 light_u = next4(path.random);
        vec4 bsdf_u = next4(path.random);
        bool delta = bsdf_is_delta(b);
        if (!delta && path.depth + 1u < longest()) next4(path.random); // what chooses a connection
        put(camera_place(vertex) + 3u, delta ? 1.0 : 0.0);
        put(camera_place(vertex) + 4u, delta ? vec3(0.0) : light_sample(vertex_reference(v, b), light_u).target);
        path_scatter(path, v, b, vertex_sample(v, b, path.ray, bsdf_u.xyz));
        if (!path_survives(path, path.eta * path.eta, bsdf_u.w)) return vertex + 1u;
    }
}

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    answer = ANSWER * gl_GlobalInvocationID.x;
    Pixel pixel = pixel_open(gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    Estimate e;
    e.rays = 0u;
    put(0u, float(pixel.index));
    put(1u, float(follow_light(pixel, e.rays)));
    put(2u, float(follow_camera(pixel, e)));
}
