// Traces rays from memory and nothing else: the nearest hit.
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
    Hit hit;
    bool found = trace_closest(ray, hit);
    Distances(PROBE_OUTPUT).at[index] = found ? hit.t : -1.0;
}
