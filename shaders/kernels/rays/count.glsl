// Counts what traversal tests for rays from memory: once for the nearest hit, once for any. Backends that can count define
// `tested_nodes` and `tested_primitives`.
#version 460
#define COUNT_TRAVERSAL
#include "core/prelude.glsl"
#include "kernels/ray_records.glsl"
#include "trace/trace.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Counts { TraversalCount at[]; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.slot_count) return;
    Ray ray = recorded_ray(index);
    tested_nodes = tested_primitives = 0u;
    Hit hit;
    trace_closest(ray, hit);
    TraversalCount count;
    count.closest_nodes = tested_nodes;
    count.closest_primitives = tested_primitives;
    tested_nodes = tested_primitives = 0u;
    trace_any(ray);
    count.any_nodes = tested_nodes;
    count.any_primitives = tested_primitives;
    Counts(PROBE_OUTPUT).at[index] = count;
}
