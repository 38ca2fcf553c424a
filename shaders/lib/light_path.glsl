// Paths from the lights. They are `Path`s like those from the camera, but carry power instead of importance: BSDFs take their
// directions in reverse order, and shading normals and refraction need what Veach 1997, sections 5.2 and 5.3, derives.
#include "lib/path.glsl"

// Random numbers of light paths begin here: no path from the camera comes so far.
const uint LIGHT_DIMENSION = 0x10000u;

// Light paths in each sample of the image.
float light_path_count() { return float(frame.light_path_count); }

// A path from the lights before its first segment; `power` goes apart from the throughput, which begins at 1.
Path light_path_begin(uint pixel, uint sample_index, out EmittedRay emitted) {
    Path path;
    path.random = Sampler(pixel, sample_index, LIGHT_DIMENSION, frame.seed);
    vec4 u = next4(path.random);
    vec4 v = next4(path.random);
    emitted = light_emit(u, v);
    path.ray = Ray(emitted.origin, emitted.direction, INFINITY);
    path.from = Receiver(path.ray.origin, vec3(0.0), false);
    path.throughput = vec3(1.0);
    path.absorption = vec3(0.0);
    path.pdf_w = 1.0;
    path.delta = false;
    path.depth = 0u;
    path.eta = 1.0;
    path.cone = Cone(0.0, 0.0);
    return path;
}

// f |cos| of light that came along the ray and leaves along `world`, for power: f takes light from where it came to where it goes,
// and the cosines are those of the geometric normal (Veach 1997, equation 5.19).
vec3 light_vertex_eval(Vertex v, Bsdf b, Ray ray, vec3 local, vec3 world) {
    if (v.mapped && !(vertex_is_sound(v, v.wo, -ray.direction) && vertex_is_sound(v, local, world))) return vec3(0.0);
    if (local.z <= 0.0 && !bsdf_transmits(b)) return vec3(0.0); // BSDFs that only reflect rely on a wo above the surface
    float arriving = abs(dot(ray.direction, v.at.normal));
    return arriving > 0.0 ? bsdf_eval(b, local, v.wo) * (abs(dot(world, v.at.normal)) / arriving) : vec3(0.0);
}

// The next direction. The BSDF's own weight is that of radiance: refraction gets its eta^2 back, and the shading normal its factor.
BsdfSample light_vertex_sample(Vertex v, Bsdf b, Ray ray, vec3 u) {
    BsdfSample s = vertex_sample(v, b, ray, u);
    vec3 world = vertex_to_world(v, s.wi);
    float geometric = abs(dot(world, v.at.normal)) * abs(v.wo.z);
    float shading = abs(dot(ray.direction, v.at.normal)) * abs(s.wi.z);
    s.weight *= shading > 0.0 ? s.eta * s.eta * geometric / shading : 0.0;
    return s;
}

// The ray that shows the vertex to the camera.
Ray vertex_camera_ray(Vertex v, CameraView view) {
    Ray ray = vertex_ray(v, view.direction);
    vec3 d = view.target - ray.origin;
    float distance = length(d);
    ray.direction = d / distance;
    ray.t_max = distance * (1.0 - gamma(8.0));
    return ray;
}

// Absorption of the medium on the side of the vertex that a local direction leaves to, given that of the medium it was reached through.
vec3 vertex_absorption(Vertex v, Bsdf b, vec3 absorption, vec3 local) {
    if (!HAS_ABSORPTION || (b.m.flags & MATERIAL_HAS_ABSORPTION) == 0u || local.z * v.wo.z > 0.0) return absorption;
    return local.z < 0.0 ? b.layered.absorption : vec3(0.0);
}

// Share of light that passes along a ray with two ends through a medium.
vec3 segment_transmittance(Ray ray, vec3 absorption, inout uint rays) {
    float through = trace_transmittance(ray, rays);
    return HAS_ABSORPTION ? through * exp(-absorption * ray.t_max) : vec3(through);
}

// Russian roulette on the throughput, as `path` has it; false where the path ends.
bool light_path_survives(inout Path path, float u) {
    float greatest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
    if (greatest == 0.0) return false;
    if (path.depth >= RR_DEPTH) {
        float survive = min(greatest, path.depth < ENDLESS ? 1.0 : 0.999);
        if (u >= survive) return false;
        path.throughput /= survive;
    }
    return true;
}
