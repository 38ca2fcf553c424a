// The rays of a kernel that runs over them: records that the host gives, or that kernels/rays/make.glsl writes.
#include "kernels/probe.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer RayRecords { RayRecord at[]; };

Ray recorded_ray(uint index) {
    RayRecord record = RayRecords(PROBE_INPUT).at[index];
    return Ray(record.origin, record.direction, record.t_max);
}
