// What the integrators that follow paths from the camera share: a path between two of its vertices, and one vertex.
#include "lib/film.glsl"
#include "lib/interaction.glsl"
#include "materials/bsdf.glsl"
#include "lights/light.glsl"

// A path from the camera, on its way from one vertex to the next.
struct Path {
    Ray ray;
    Sampler random;
    vec3 throughput; // product of f |cos| / pdf so far
    float pdf_w;     // with which the last vertex chose the ray's direction
    bool delta;      // that vertex chose it by a delta lobe, or is the camera: no other technique can
    uint depth;      // vertices so far that scattered: the next hit ends a path of depth + 1 segments
    float eta;       // product of index ratios crossed, for Russian roulette
};

Path path_begin(inout Pixel pixel, inout Estimate e) {
    Path path;
    path.ray = sample_open(pixel, e, path.random);
    path.throughput = vec3(1.0);
    path.pdf_w = 1.0;
    path.delta = true;
    path.depth = 0u;
    path.eta = 1.0;
    return path;
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
};

Vertex vertex_at(Ray ray, Hit hit) {
    Vertex v;
    v.at = interaction_at(ray, hit);
    v.surface = load_surface(v.at.surface);
    v.frame = frame_from_normal(v.at.shading_normal);
    v.wo = to_local(v.frame, -ray.direction);
    v.front = v.wo.z > 0.0;
    v.material = v.front || !HAS_BACK_MATERIALS ? v.surface.front : v.surface.back;
    v.turned = 1.0;
    if (!HAS_BACK_MATERIALS && !v.front || v.wo.z == 0.0) v.material = NONE;
    return v;
}

// The vertex's material; turns the frame round where the path came to the back of something that reflects only.
Material vertex_material(inout Vertex v) {
    Material m = load_material(v.material);
    if (HAS_BACK_MATERIALS && !v.front && !bsdf_transmits(m)) {
        v.wo.z = -v.wo.z;
        v.turned = -1.0;
    }
    return m;
}

vec3 vertex_to_world(Vertex v, vec3 w) { return to_world(v.frame, vec3(w.xy, w.z * v.turned)); }

vec3 vertex_to_local(Vertex v, vec3 w) {
    vec3 local = to_local(v.frame, w);
    return vec3(local.xy, local.z * v.turned);
}

// The ray that leaves the vertex in the world direction w.
Ray vertex_ray(Vertex v, vec3 w) {
    return Ray(offset_origin(v.at.position, v.at.margin, v.at.normal, w), w, INFINITY);
}

// The ray from the vertex to the light sample.
Ray vertex_shadow_ray(Vertex v, LightSample light) {
    Ray ray = vertex_ray(v, light.wi);
    if (!light.distant) {
        vec3 d = light.target - ray.origin;
        float distance = length(d);
        ray.direction = d / distance;
        ray.t_max = distance * (1.0 - gamma(8.0)); // both ends are off their surfaces; what is left is the rounding of t
    }
    return ray;
}

// Whether the light sample is seen from the vertex.
bool vertex_sees(Vertex v, LightSample light) { return !trace_any(vertex_shadow_ray(v, light)); }

// Goes on in the direction that the BSDF chose.
void path_scatter(inout Path path, Vertex v, BsdfSample s) {
    path.throughput *= s.weight;
    path.pdf_w = s.pdf_w;
    path.delta = s.delta;
    path.eta *= s.eta;
    path.depth += 1u;
    path.ray = vertex_ray(v, vertex_to_world(v, s.wi));
}

#include "lib/emission.glsl"
