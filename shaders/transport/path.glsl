// A path on its way from one vertex to the next, and its stages: begin, arrive at the next vertex, scatter, end by Russian roulette.
// Next-event estimation, between the last two, is in transport/nee.glsl; the loop over all of them in transport/lanes.glsl.
#include "core/film.glsl"
#include "transport/cone.glsl"
#include "transport/vertex.glsl"

// Segments after which even a path that has lost nothing may end: between perfect mirrors it would go on for ever.
const uint ENDLESS = 4096u;

// A subpath from the camera or from a light, on its way from one vertex to the next.
struct Path {
    Ray ray;
    ReferencePoint from;    // the last vertex that scattered, where the ray left it
    Sampler random;
    vec3 throughput;  // product of f |cos| / pdf so far
    vec3 absorption;  // of the medium that the ray is in, 1/m
    float pdf_w;      // solid angle density with which the last vertex chose the ray's direction
    bool delta;       // that vertex chose it by a delta lobe, or is the camera: no other technique can
    bool from_camera; // the path carries importance; one from a light carries power
    uint depth;       // vertices so far that scattered: the next hit ends a path of depth + 1 segments
    float eta;        // product of index ratios crossed, for Russian roulette
    float dimming;    // of a path from the camera: what its first vertex left of its throughput, 1 before it and for paths from lights
    Cone cone;        // how wide a path from the camera is, for mip maps
};

// A path before its first segment.
Path path_along(Ray ray, Sampler random, bool from_camera) {
    ReferencePoint from = ReferencePoint(ray.origin, vec3(0.0), false);
    return Path(ray, from, random, vec3(1.0), vec3(0.0), 1.0, from_camera, from_camera, 0u, 1.0, 1.0, Cone(0.0, 0.0));
}

// Records where a path begins.
void record_path(Path path) {
    if (!records(RECORD_BEGIN)) return;
    PathRecord r = record_of(RECORD_BEGIN, 0u);
    r.position = path.ray.origin;
    r.direction = path.ray.direction;
    record_append(r);
}

// Records the vertex where a path has arrived.
void record_vertex(Path path, Vertex v) {
    if (!records(RECORD_VERTEX)) return;
    PathRecord r = record_of(RECORD_VERTEX, path.depth + 1u);
    r.position = v.at.position;
    r.normal = v.at.normal;
    r.direction = -path.ray.direction;
    r.throughput = path.throughput;
    r.material = v.material;
    r.primitive = v.hit.primitive;
    r.instance = v.hit.instance;
    record_append(r);
}

// Records the direction in which the path goes on.
void record_scatter(Path path, BsdfSample s) {
    if (!records(RECORD_SCATTER)) return;
    PathRecord r = record_of(RECORD_SCATTER, path.depth);
    r.position = path.ray.origin;
    r.direction = path.ray.direction;
    r.value = s.weight;
    r.throughput = path.throughput;
    r.pdf = s.pdf_w;
    r.flags = (s.delta ? RECORDED_DELTA : 0u) | (s.narrow ? RECORDED_NARROW : 0u);
    record_append(r);
}

void record_roulette(Path path, float survival, bool ends) {
    if (!records(RECORD_ROULETTE)) return;
    PathRecord r = record_of(RECORD_ROULETTE, path.depth);
    r.probability = min(survival, 1.0);
    r.flags = ends ? RECORDED_ENDS : 0u;
    record_append(r);
}

// A path from the camera along a ray of it.
Path path_from_camera(Ray ray, Sampler random) {
    Path path = path_along(ray, random, true);
    if (HAS_ABSORPTION) path.absorption = scene.camera_absorption;
    if (HAS_MIP_MAPS) path.cone = camera_cone(path.ray.direction);
    record_path(path);
    return path;
}

// Takes away what the medium absorbed on the way to the vertex.
void path_absorb(inout Path path, Vertex v) {
    if (HAS_ABSORPTION) path.throughput *= exp(-path.absorption * distance(path.from.position, v.at.position));
}

// Measures what the path sees of the vertex's textures. On a surface that it grazes that is an ellipse: its short axis counts,
// since the samples of a pixel are spread along the long one anyway, and nothing is blurred that they tell apart.
// Light paths see them as points.
void path_measure(Path path, inout Vertex v) {
    if (HAS_MIP_MAPS && path.from_camera) v.side = cone_width(path.cone, distance(path.from.position, v.at.position)) * sqrt(v.at.uv_area);
}

// Follows the path to its next vertex; false where it leaves the scene.
bool path_arrive(inout Path path, out Vertex v, inout uint rays) {
    if (!vertex_arrive(path.ray, path.from_camera && path.depth == 0u, v, path.random, rays)) return false;
    v.from_light = !path.from_camera;
    path_absorb(path, v);
    path_measure(path, v);
    record_vertex(path, v);
    return true;
}

// Counts the vertex that has scattered, and keeps what the first one left of a camera path's throughput.
void path_count(inout Path path) {
    path.depth += 1u;
    if (path.from_camera && path.depth == 1u) path.dimming = clamp(largest(path.throughput) * path.eta * path.eta, 1e-6, 1.0);
}

// Goes on in the direction that the BSDF chose.
void path_scatter(inout Path path, Vertex v, Bsdf b, BsdfSample s) {
    if (HAS_MIP_MAPS && path.from_camera) {
        path.cone.width = cone_width(path.cone, distance(path.from.position, v.at.position));
        if (!s.delta) path.cone = scattered_cone(path.cone.width, path.cone.spread, s.pdf_w);
    }
    path.throughput *= s.weight;
    path.pdf_w = s.pdf_w;
    path.delta = s.delta;
    path.eta *= s.eta;
    path_count(path);
    path.ray = vertex_ray(v, vertex_to_world(v, s.wi));
    path.from = vertex_reference(v, b);
    path.from.position = path.ray.origin;
    if (HAS_ABSORPTION && (b.m.flags & MATERIAL_HAS_ABSORPTION) != 0u && s.wi.z * v.wo.z < 0.0)
        path.absorption = s.wi.z < 0.0 ? b.layered.absorption : vec3(0.0);
    record_scatter(path, s);
}

// Russian roulette: a path whose throughput has fallen below this survives with the share of it that is left, and is raised back to it;
// others always survive. That of a path from the camera counts by what its first vertex left of it, so that dark surfaces are not made of few,
// bright samples. Lower makes paths longer, higher makes them noisier: relMSE x s is flat around it (docs/speed.md).
const float ROULETTE_BELOW = 0.5;

// Probability with which the path goes on. `scale` on its throughput takes out what comes back by itself. A limit below one would make
// throughputs grow without bound where nearly all light is reflected.
float path_survival(Path path, float scale) {
    float greatest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
    if (path.depth < RR_DEPTH) return greatest > 0.0 ? 1.0 : 0.0;
    return min(greatest * scale / (ROULETTE_BELOW * path.dimming), path.depth < ENDLESS ? 1.0 : 0.999);
}

// False where the path ends.
bool path_survives(inout Path path, float scale, float u) {
    float survival = path_survival(path, scale);
    record_roulette(path, survival, u >= survival);
    if (u >= survival) return false;
    path.throughput /= survival;
    return true;
}
