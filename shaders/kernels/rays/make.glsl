// The rays that `lumbre rays` measures: for each pixel a primary ray, and from where it hits a shadow ray to a light and a
// ray in a direction chosen as a diffuse surface would, and from there the same again. Rays that do not exist (a path that
// has left the scene) have a negative length.
#version 460
#include "core/prelude.glsl"
#include "kernels/ray_records.glsl"
#include "trace/trace.glsl"
#include "transport/nee.glsl"

layout(local_size_x = WORKGROUP) in;

const Ray NO_RAY = Ray(vec3(0.0), vec3(0.0, 0.0, 1.0), -1.0);

RayRecord record(Ray ray) { return RayRecord(ray.origin, ray.direction, ray.t_max); }

void main() {
    uint slot = gl_GlobalInvocationID.x;
    if (slot >= frame.slot_count) return;
    Pixel pixel = pixel_open(slot);
    Sampler random = Sampler(slot, 0u, 0u, frame.seed);
    vec4 camera_u = next4(random);
    Ray ray = pixel.inside ? camera_ray(vec2(pixel.xy) + camera_u.xy, camera_u.zw) : NO_RAY;
    RayRecords records = RayRecords(PROBE_INPUT);
    records.at[slot] = record(ray);
    for (uint bounce = 0u; bounce < RAY_BOUNCES; bounce++) {
        Ray shadow = NO_RAY;
        Hit hit;
        bool found = ray.t_max > 0.0 && trace_closest(ray, hit);
        vec4 light_u = next4(random);
        vec4 bsdf_u = next4(random);
        if (found) {
            Vertex v = vertex_at(ray, hit);
            v.turned = v.front ? 1.0 : -1.0;
            LightSample light = light_sample(ReferencePoint(v.at.position, v.turned * v.basis.normal, false), light_u);
            if (light.pdf_w > 0.0) shadow = shadow_ray(v.at, light);
            ray = vertex_ray(v, vertex_to_world(v, sample_cosine_hemisphere(bsdf_u.xy)));
        } else {
            ray = NO_RAY;
        }
        records.at[(2u * bounce + 1u) * frame.slot_count + slot] = record(shadow);
        records.at[(2u * bounce + 2u) * frame.slot_count + slot] = record(ray);
    }
}
