// Samples the lights from the points that the host gives, looks where the sample says, and says with which density light
// sampling chooses what lies in a direction.
#version 460
#include "core/prelude.glsl"
#include "kernels/probe.glsl"
#include "trace/trace.glsl"
#include "transport/emission.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LightQueries { LightQuery at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer LightAnswers { LightAnswer at[]; };

// The emission that a ray from the reference point finds, and the density over solid angle with which light sampling goes there.
vec4 emission_and_density(ReferencePoint r, vec3 direction) {
    Ray ray = Ray(r.position, direction, INFINITY);
    Hit hit;
    if (!trace_closest(ray, hit)) return HAS_BACKGROUND ? vec4(background_radiance(direction), background_pdf(direction)) : vec4(0.0);
    Vertex v = vertex_at(ray, hit);
    vec3 emission = vertex_emission(v, ray);
    if (emission == vec3(0.0)) return vec4(0.0);
    return vec4(emission, light_pdf(r, ray, hit, v.at, v.surface));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.slot_count) return;
    LightQuery q = LightQueries(PROBE_INPUT).at[index];
    ReferencePoint r = ReferencePoint(q.point, q.normal, false);
    LightSample s = light_sample(r, q.u);
    Ray shadow = Ray(q.point, s.wi, INFINITY);
    if (!s.distant) shadow = ray_between(q.point, s.target);
    bool visible = s.pdf_w > 0.0 && !trace_any(shadow);
    vec4 found = emission_and_density(r, s.wi);
    vec4 asked = emission_and_density(r, q.direction);
    LightAnswers(PROBE_OUTPUT).at[index] =
        LightAnswer(s.wi, s.weight, s.pdf_w, s.delta ? 1u : 0u, visible ? 1u : 0u, found.xyz, found.w, asked.xyz, asked.w);
}
