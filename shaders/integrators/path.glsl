// `path`: explicit path tracing. At each vertex light is gathered twice, by sampling a light (next-event estimation) and
// by the direction that the BSDF chooses anyway, and both are combined by multiple importance sampling (Veach 1997,
// sections 9.2 and 10.2). Paths end by Russian roulette on their throughput. Unbiased.
#version 460
#include "lib/prelude.glsl"
#include "trace/trace.glsl"
#include "lib/explicit_path.glsl"
#include "lib/pixel_main.glsl"
