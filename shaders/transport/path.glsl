// What the integrators that follow paths from the camera share: a path between two of its vertices, and one vertex.
#include "core/film.glsl"
#include "trace/interaction.glsl"
#include "transport/visibility.glsl"
#include "transport/cone.glsl"
#include "materials/bsdf.glsl"
#include "lights/light.glsl"

// Segments after which even a path that has lost nothing may end: between perfect mirrors it would go on for ever.
const uint ENDLESS = 4096u;

// A path from the camera, on its way from one vertex to the next.
struct Path {
    Ray ray;
    Receiver from;   // the last vertex that scattered, where the ray left it
    Sampler random;
    vec3 throughput; // product of f |cos| / pdf so far
    vec3 absorption; // of the medium that the ray is in, 1/m
    float pdf_w;     // with which the last vertex chose the ray's direction
    bool delta;      // that vertex chose it by a delta lobe, or is the camera: no other technique can
    uint depth;      // vertices so far that scattered: the next hit ends a path of depth + 1 segments
    float eta;       // product of index ratios crossed, for Russian roulette
    Cone cone;       // how wide the path is, for mip maps
};

// A path before its first segment.
Path path_along(Ray ray, Sampler random, bool delta) {
    return Path(ray, Receiver(ray.origin, vec3(0.0), false), random, vec3(1.0), vec3(0.0), 1.0, delta, 0u, 1.0, Cone(0.0, 0.0));
}

// A path from the camera along a ray of it.
Path path_from_camera(Ray ray, Sampler random) {
    Path path = path_along(ray, random, true);
    if (HAS_ABSORPTION) path.absorption = scene.camera_absorption;
    if (HAS_MIP_MAPS) path.cone = camera_cone(path.ray.direction);
    return path;
}

Path path_begin(inout Pixel pixel, inout Estimate e) {
    Sampler random;
    Ray ray = sample_open(pixel, e, random);
    return path_from_camera(ray, random);
}

// Follows the path to its next vertex; false where it leaves the scene.
bool path_trace(inout Path path, out Hit hit, out Interaction at, inout Estimate e) {
    return trace_visible(path.ray, hit, at, path.random, e.rays);
}

// A surface point in its local shading frame, on the side that the path came from.
struct Vertex {
    Interaction at;
    Surface surface;
    Frame frame;
    vec3 wo;           // local, towards the previous vertex
    float turned;      // -1 where the frame is turned round to face a path that came to the back
    uint material;     // NONE reflects nothing
    bool front;        // the path came to the front of the surface, by the shading normal
    bool mapped;       // a normal or bump map tilts the frame off the shading normal
    float side;        // of what the path sees there, in texture coordinates; 0 is a point
};

// The vertex where the ray has arrived.
Vertex vertex_of(Ray ray, Interaction at) {
    Vertex v;
    v.at = at;
    v.surface = load_surface(v.at.surface);
    v.frame = frame_from_normal(v.at.shading_normal);
    v.wo = to_local(v.frame, -ray.direction);
    v.front = v.wo.z > 0.0;
    v.material = v.front || !HAS_BACK_MATERIALS ? v.surface.front : v.surface.back;
    v.turned = 1.0;
    v.mapped = false;
    v.side = 0.0;
    if (!HAS_BACK_MATERIALS && !v.front || v.wo.z == 0.0) v.material = NONE;
    return v;
}

Vertex vertex_at(Ray ray, Hit hit) { return vertex_of(ray, interaction_at(ray, hit)); }

#include "transport/shading_basis.glsl"

// The vertex's material; turns the frame round where the path came to the back of something that reflects only.
Bsdf vertex_material(inout Vertex v, Ray ray, inout Sampler random) {
    Bsdf b = bsdf_at(v.material, v.at.uv, v.side, v.at.colour, random);
    if (HAS_TANGENTS && (b.m.flags & MATERIAL_HAS_TANGENTS) != 0u) {
        v.frame = shading_frame(v.at, b.m, v.mapped);
        v.wo = to_local(v.frame, -ray.direction);
    }
    if (HAS_BACK_MATERIALS && !v.front && !bsdf_transmits(b)) {
        v.wo.z = -v.wo.z;
        v.turned = -1.0;
    }
    return b;
}

vec3 vertex_to_world(Vertex v, vec3 w) { return to_world(v.frame, vec3(w.xy, w.z * v.turned)); }

vec3 vertex_to_local(Vertex v, vec3 w) {
    vec3 local = to_local(v.frame, w);
    return vec3(local.xy, local.z * v.turned);
}

// A tilted frame calls directions above the surface that are below it and the other way round; neither carries light, or it
// would leak through.
bool vertex_is_sound(Vertex v, vec3 local, vec3 world) { return local.z * v.turned * dot(world, v.at.shading_normal) > 0.0; }

// Whether light goes from one direction to the other, the local and world forms of the second being given.
bool vertex_scatters(Vertex v, Ray ray, vec3 local, vec3 world) {
    return !v.mapped || vertex_is_sound(v, v.wo, -ray.direction) && vertex_is_sound(v, local, world);
}

vec3 vertex_eval(Vertex v, Bsdf b, Ray ray, vec3 local, vec3 world) {
    return vertex_scatters(v, ray, local, world) ? bsdf_eval(b, v.wo, local) : vec3(0.0);
}

// Takes the weight of a sample that is not sound.
void vertex_check(Vertex v, Ray ray, inout BsdfSample s) {
    if (v.mapped && !(vertex_is_sound(v, v.wo, -ray.direction) && vertex_is_sound(v, s.wi, vertex_to_world(v, s.wi)))) s.weight = vec3(0.0);
}

BsdfSample vertex_sample(Vertex v, Bsdf b, Ray ray, vec3 u) {
    BsdfSample s = bsdf_sample(b, v.wo, u);
    vertex_check(v, ray, s);
    return s;
}

// The ray from one point to just before another.
Ray ray_between(vec3 origin, vec3 target) {
    vec3 d = target - origin;
    float distance = length(d);
    return Ray(origin, d / distance, distance * (1.0 - gamma(8.0)));
}

float vertex_opacity(Vertex v) { return surface_opacity(v.surface, v.at.uv); }

// The vertex as what lights shine on.
Receiver vertex_receiver(Vertex v, Bsdf b) { return Receiver(v.at.position, v.turned * v.frame.normal, bsdf_transmits(b)); }

// The ray that leaves the vertex in the world direction w.
Ray vertex_ray(Vertex v, vec3 w) {
    return Ray(offset_origin(v.at.position, v.at.margin, v.at.normal, w), w, INFINITY);
}

// The same up to a target that lies off its own surface, like the origin: what is left is the rounding of t.
Ray vertex_ray_to(Vertex v, vec3 w, vec3 target) { return ray_between(vertex_ray(v, w).origin, target); }

// The ray from the vertex to the light sample.
Ray vertex_shadow_ray(Vertex v, LightSample light) {
    return light.distant ? vertex_ray(v, light.wi) : vertex_ray_to(v, light.wi, light.target);
}

// Absorption of the medium on the side of the vertex that a local direction leaves to, given that of the medium it was reached through.
vec3 vertex_absorption(Vertex v, Bsdf b, vec3 absorption, vec3 local) {
    if (!HAS_ABSORPTION || (b.m.flags & MATERIAL_HAS_ABSORPTION) == 0u || local.z * v.wo.z > 0.0) return absorption;
    return local.z < 0.0 ? b.layered.absorption : vec3(0.0);
}

// Share of light that passes along a ray through a medium of this absorption, from end to end.
vec3 ray_transmittance(Ray ray, vec3 absorption, inout uint rays) {
    float through = trace_transmittance(ray, rays);
    if (!HAS_ABSORPTION || absorption == vec3(0.0)) return vec3(through);
    return ray.t_max == INFINITY ? vec3(0.0) : through * exp(-absorption * ray.t_max);
}

// Share of the light sample that reaches the vertex of a path in a medium of this absorption.
vec3 vertex_transmittance(Vertex v, LightSample light, vec3 absorption, inout uint rays) {
    return ray_transmittance(vertex_shadow_ray(v, light), absorption, rays);
}

// Takes away what the medium absorbed on the way to the vertex.
void path_absorb(inout Path path, Vertex v) {
    if (HAS_ABSORPTION) path.throughput *= exp(-path.absorption * distance(path.from.position, v.at.position));
}

// Measures what the path sees of the vertex's textures. On a surface that it grazes that is an ellipse: its short axis counts,
// since the samples of a pixel are spread along the long one anyway, and nothing is blurred that they tell apart.
void path_measure(Path path, inout Vertex v) {
    if (HAS_MIP_MAPS) v.side = cone_width(path.cone, distance(path.from.position, v.at.position)) * sqrt(v.at.uv_area);
}

// Goes on in the direction that the BSDF chose.
void path_scatter(inout Path path, Vertex v, Bsdf b, BsdfSample s) {
    if (HAS_MIP_MAPS) {
        path.cone.width = cone_width(path.cone, distance(path.from.position, v.at.position));
        if (!s.delta) path.cone = scattered_cone(path.cone.width, path.cone.spread, s.pdf_w);
    }
    path.throughput *= s.weight;
    path.pdf_w = s.pdf_w;
    path.delta = s.delta;
    path.eta *= s.eta;
    path.depth += 1u;
    path.ray = vertex_ray(v, vertex_to_world(v, s.wi));
    path.from = vertex_receiver(v, b);
    path.from.position = path.ray.origin;
    if (HAS_ABSORPTION && (b.m.flags & MATERIAL_HAS_ABSORPTION) != 0u && s.wi.z * v.wo.z < 0.0)
        path.absorption = s.wi.z < 0.0 ? b.layered.absorption : vec3(0.0);
}

// Russian roulette: the path survives with the probability that it still matters, which keeps throughputs near one; `scale` on its
// throughput takes out what comes back by itself. A constant limit below one would make throughputs grow without bound where nearly all
// light is reflected.
float path_survival(Path path, float scale) {
    float greatest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
    if (path.depth < RR_DEPTH) return greatest > 0.0 ? 1.0 : 0.0;
    return min(greatest * scale, path.depth < ENDLESS ? 1.0 : 0.999);
}

// False where the path ends.
bool path_survives(inout Path path, float scale, float u) {
    float survival = path_survival(path, scale);
    if (u >= survival) return false;
    path.throughput /= survival;
    return true;
}

#include "transport/emission.glsl"
