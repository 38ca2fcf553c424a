// Traces rays from memory and nothing else: whether anything is hit.
#version 460
#include "core/prelude.glsl"
#include "kernels/ray_records.glsl"
#include "trace/trace.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Distances { float at[]; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.slot_count) return;
    Ray ray = recorded_ray(index);
    Distances(PROBE_OUTPUT).at[index] = trace_any(ray) ? 1.0 : 0.0;
}
