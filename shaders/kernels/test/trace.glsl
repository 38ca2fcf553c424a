// Traces the rays that the host gives, both ways.
#version 460
#include "core/prelude.glsl"
#include "kernels/ray_records.glsl"
#include "trace/trace.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer HitRecords { HitRecord at[]; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.slot_count) return;
    Ray ray = recorded_ray(index);
    Hit hit;
    bool found = trace_closest(ray, hit);
    uint blocked = trace_any(ray) ? 1u : 0u;
    HitRecords(PROBE_OUTPUT).at[index] = HitRecord(found ? hit.t : -1.0, hit.primitive, hit.instance, hit.uv.x, hit.uv.y, blocked);
}
