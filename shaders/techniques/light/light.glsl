// `light`: light tracing. Subpaths from the lights; each of their vertices is connected to the camera (Arvo 1986; Dutre, Lafortune and
// Willems 1993). What reaches the camera by way of a mirror or glass has no vertex that a camera without extent could see, and what is as smooth as
// these has next to none (materials/lobes.glsl): it is missing.
#version 460
#include "core/prelude.glsl"
#define SPLITS_LOBES true

#ifdef PASS_RESOLVE
#include "core/resolve.glsl"
#else
#include "trace/trace.glsl"
#include "transport/camera_connection.glsl"
#include "transport/light_lanes.glsl"

struct Lane {
    LightLane light;
    CameraConnection beginning; // of the subpath, to be splatted
};

bool open(out Lane lane) { return light_open(lane.light); }
bool has_next(Lane lane) { return light_has_next(lane.light); }

bool begin(inout Lane lane) {
    light_begin(lane.light);
    lane.beginning = no_camera_connection();
    float camera_a;
    if (MAX_DEPTH > 0u) lane.beginning = camera_connect_light(lane.light.path, lane.light.emitted, camera_a);
    return true;
}

// Follows the subpath to its next vertex, connects that to the camera, and chooses the ray after it.
bool follow(inout Path path, vec3 power, inout CameraConnection connection, inout uint rays) {
    Vertex v;
    if (!path_arrive(path, v, rays) || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    vec4 u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (bsdf_has_broad(b)) connection = camera_connect_vertex(path, power, v, broad_lobes(b), u);
    if (path.depth + 2u >= MAX_DEPTH) return false; // with the segment to the camera
    path_scatter(path, v, b, light_vertex_sample(v, b, path.ray, bsdf_u.xyz));
    return path_survives(path, 1.0, bsdf_u.w);
}

bool extend(inout Lane lane) {
    uint s = lane.light.path.depth + 2u;
    CameraConnection vertex = no_camera_connection();
    vec3 power = lane.light.emitted.power;
    bool alive = MAX_DEPTH > 1u && power != vec3(0.0) && follow(lane.light.path, power, vertex, lane.light.rays);
    camera_splat_both(lane.beginning, vertex, lane.light.pixel.sample_index, s, lane.light.rays);
    return alive;
}

void end(inout Lane lane) { light_end(lane.light); }
void close(Lane lane) { light_close(lane.light); }

LANES(Lane, open, has_next, begin, extend, end, close)
#endif
