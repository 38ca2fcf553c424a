// `bdpt`: bidirectional path tracing (Lafortune and Willems 1993; Veach and Guibas 1994; Veach 1997, chapter 10). A path from the
// light and one from the camera, and every way to make a whole path of their beginnings: (s, t) takes s vertices of the first
// and t of the second. s = 0 is implicit and s = 1 explicit path tracing, t = 1 is light tracing; all are combined by
// multiple importance sampling. t = 0 is there for a lens: nothing runs into a pinhole.
//
// The pass `light` follows the paths from the lights, shows their vertices to the camera (t = 1) and keeps them; the pass `camera`
// follows the others and connects. Unbiased.
#version 460
#include "core/prelude.glsl"

const bool CONNECTS = true;
const bool MEETS_LENS = true;
const bool MERGES = false;
const bool MERGES_FIRST = false;

#if defined(PASS_LIGHT)
#include "trace/trace.glsl"
#include "techniques/bidirectional/light_pass.glsl"
#elif defined(PASS_CAMERA)
#include "trace/trace.glsl"
#include "techniques/bidirectional/camera_pass.glsl"
#else
#include "core/resolve.glsl"
#endif
