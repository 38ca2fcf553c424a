// The random numbers at the coordinates that the host gives, and what the maps of core/sampling.glsl make of them.
#version 460
#include "core/prelude.glsl"
#include "kernels/probe.glsl"
#include "core/rng.glsl"
#include "core/sampling.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RandomQueries { RandomQuery at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Answers { float at[]; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.slot_count) return;
    RandomQuery q = RandomQueries(PROBE_INPUT).at[index];
    Sampler random = Sampler(q.pixel, q.sample_index, q.dimension, q.seed);
    vec4 u = next4(random);
    vec2 disk = sample_disk(u.xy);
    vec3 hemisphere = sample_cosine_hemisphere(u.xy);
    vec3 sphere = sample_sphere(u.xy);
    vec2 triangle = sample_triangle(u.xy);
    float values[14] = float[](u.x, u.y, u.z, u.w, disk.x, disk.y, hemisphere.x, hemisphere.y, hemisphere.z, sphere.x, sphere.y,
                               sphere.z, triangle.x, triangle.y);
    for (uint i = 0u; i < 14u; i++) Answers(PROBE_OUTPUT).at[14u * index + i] = values[i];
}
