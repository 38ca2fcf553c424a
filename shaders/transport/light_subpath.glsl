// Paths from the lights. They are `Path`s like those from the camera, but carry power instead of importance: BSDFs take their
// directions in reverse order, and shading normals and refraction need what Veach 1997, sections 5.2 and 5.3, derives.
#include "core/light_subpath_table.glsl"
#include "transport/path.glsl"

// Light paths in each sample of the image.
float light_path_count() { return float(light_subpaths.light_path_count); }

// Random numbers of a light subpath.
Sampler light_path_random(uint index, uint sample_index) { return Sampler(index, sample_index, LIGHT_DIMENSION, frame.seed); }

// A path along an emitted ray.
Path path_from_light(EmittedRay e, Sampler random) {
    Path path = path_along(Ray(e.origin, e.direction, INFINITY), random, false);
    if (HAS_ABSORPTION) path.absorption = e.absorption;
    return path;
}

// Records where a light subpath begins.
void record_emitted(EmittedRay e) {
    if (!records(RECORD_BEGIN)) return;
    PathRecord r = record_of(RECORD_BEGIN, 0u);
    r.position = e.origin;
    r.normal = e.normal;
    r.direction = e.direction;
    r.value = e.power;
    r.pdf = e.pdf_a;
    r.flags = (e.delta ? RECORDED_DELTA : 0u) | (e.distant ? RECORDED_DISTANT : 0u);
    record_append(r);
}

// A path from the lights before its first segment; `power` goes apart from the throughput, which begins at 1.
Path light_path_begin(uint index, uint sample_index, out EmittedRay emitted) {
    Sampler random = light_path_random(index, sample_index);
    vec4 u = next4(random);
    vec4 v = next4(random);
    emitted = light_emit(u, v);
    record_begin_light(index, sample_index, light_subpaths.light_path_count);
    record_emitted(emitted);
    return path_from_light(emitted, random);
}

// f |cos| of light that came along the ray and leaves along `world`, for power: f takes light from where it came to where it goes,
// and the cosines are those of the geometric normal (Veach 1997, equation 5.19).
vec3 light_vertex_eval(Vertex v, Bsdf b, Ray ray, vec3 local, vec3 world) {
    float passage = vertex_passage(v, ray, local, world);
    if (passage == 0.0) return vec3(0.0);
    if (local.z <= 0.0 && !bsdf_transmits(b)) return vec3(0.0); // BSDFs that only reflect rely on a wo above the surface
    float arriving = abs(dot(ray.direction, v.at.normal));
    return arriving > 0.0 ? bsdf_eval(b, local, v.wo) * (passage * abs(dot(world, v.at.normal)) / arriving) : vec3(0.0);
}

// What the weight of a BSDF's sample, which is that of radiance, is to be multiplied by for power: refraction gets its eta^2 back, and the
// shading normal its factor.
float adjoint_factor(Vertex v, Ray ray, BsdfSample s) {
    vec3 world = vertex_to_world(v, s.wi);
    float geometric = abs(dot(world, v.at.normal)) * abs(v.wo.z);
    float shading = abs(dot(ray.direction, v.at.normal)) * abs(s.wi.z);
    return shading > 0.0 ? s.eta * s.eta * geometric / shading : 0.0;
}

// The next direction.
BsdfSample light_vertex_sample(Vertex v, Bsdf b, Ray ray, vec3 u) {
    BsdfSample s = vertex_sample(v, b, ray, u);
    s.weight *= adjoint_factor(v, ray, s);
    return s;
}

// How the camera sees the beginning of a light subpath on an area light.
struct LightView {
    CameraView camera;
    Ray ray;        // to the camera
    float cosine;   // at the light
    vec2 u;         // chooses the pixel
    bool visible;
};

LightView light_view(EmittedRay e, Sampler random) {
    LightView v;
    v.visible = false;
    if (e.delta || e.distant) return v;
    vec4 u = next4(random);
    v.camera = camera_view(e.position, u.xy);
    v.cosine = dot(v.camera.direction, e.normal);
    v.visible = v.camera.visible && v.cosine > 0.0;
    v.ray = ray_between(offset_origin(e.position, distance(e.origin, e.position), e.normal, v.camera.direction), v.camera.target);
    v.u = u.zw;
    return v;
}

// Where to keep a vertex of a path that has `met` as many before it; NONE is nowhere. Where there are more than there is room for, those
// kept are a uniform choice of all so far (Vitter 1985, algorithm R), so that memory is bounded and no length of path is left out.
uint keep_place(uint met, inout Sampler random) {
    if (met < light_subpaths.light_vertices) return met;
    uint place = min(uint(next4(random).x * float(met + 1u)), met);
    return place < light_subpaths.light_vertices ? place : NONE;
}

// What each vertex that is kept of so many stands for.
float kept_share(uint met) { return max(float(met) / float(light_subpaths.light_vertices), 1.0); }
