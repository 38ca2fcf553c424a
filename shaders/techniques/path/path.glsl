// `path`: explicit path tracing. At each vertex light is gathered twice, by sampling a light (next-event estimation) and
// by the direction that the BSDF chooses anyway, and both are combined by multiple importance sampling (Veach 1997,
// sections 9.2 and 10.2). Paths end by Russian roulette on their throughput. Unbiased.
//
// The step from one vertex to the next is techniques/path/explicit.glsl, which `mlt:form=primary` takes as well; its stages are those of
// transport/path.glsl, emission.glsl and nee.glsl.
#version 460
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "techniques/path/explicit.glsl"
#include "transport/camera_lanes.glsl"

bool extend(inout CameraLane lane) { return explicit_extend(lane.path, lane.e); }

CAMERA_LANES(extend)
