// Rays that meet a surface, and a second ray that leaves from there: where it starts, and what it meets. The layout of queries and
// answers is src/verify/leaving.rs's.
#version 460
#include "core/prelude.glsl"
#include "kernels/probe.glsl"
#include "trace/trace.glsl"
#include "trace/interaction.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Answers { uint at[]; };

const uint QUERY = 10u;  // floats: origin, direction, length, direction of the second ray
const uint ANSWER = 12u; // words, those of floats by their bits

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.slot_count) return;
    Floats query = Floats(PROBE_INPUT);
    uint q = QUERY * index, a = ANSWER * index;
    Ray ray = Ray(vec3(query.at[q], query.at[q + 1u], query.at[q + 2u]), vec3(query.at[q + 3u], query.at[q + 4u], query.at[q + 5u]), query.at[q + 6u]);
    vec3 w = vec3(query.at[q + 7u], query.at[q + 8u], query.at[q + 9u]);
    Answers answers = Answers(PROBE_OUTPUT);
    Hit hit;
    if (!trace_closest(ray, hit)) {
        for (uint i = 0u; i < ANSWER; i++) answers.at[a + i] = floatBitsToUint(-1.0);
        return;
    }
    Interaction from = interaction_at(ray, hit);
    vec3 start = offset_origin(from.position, from.margin, from.normal, w);
    Hit next;
    bool found = trace_closest(Ray(start, w, INFINITY), next);
    answers.at[a] = floatBitsToUint(hit.t);
    answers.at[a + 1u] = hit.primitive;
    answers.at[a + 2u] = hit.instance;
    answers.at[a + 3u] = floatBitsToUint(from.margin);
    for (uint i = 0u; i < 3u; i++) {
        answers.at[a + 4u + i] = floatBitsToUint(from.position[i]);
        answers.at[a + 7u + i] = floatBitsToUint(start[i]);
    }
    answers.at[a + 10u] = floatBitsToUint(found ? next.t : -1.0);
    answers.at[a + 11u] = found ? next.primitive : NONE;
}
