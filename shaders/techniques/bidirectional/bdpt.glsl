// `bdpt`: bidirectional path tracing (Lafortune and Willems 1993; Veach and Guibas 1994; Veach 1997, chapter 10). A subpath from the
// light and one from the camera, and every way to make a whole path of their beginnings: (s, t) takes s vertices of the first
// and t of the second. s = 0 is implicit and s = 1 explicit path tracing, t = 1 is light tracing; all are combined by
// multiple importance sampling. t = 0 is there for a lens: nothing runs into a pinhole. Unbiased.
//
// To be read in this order, all in this folder; the stages that they go through are in transport/ (path, nee, light_subpath, camera_connection):
//     light_pass.glsl   follows the light subpaths, connects their vertices to the camera (t = 1) and keeps them
//     camera_pass.glsl  follows the camera subpaths and connects their vertices to those (and, for `vcm`, merges)
//     connect.glsl      one connection or one emission found: its contribution and its weight
//     mis.glsl          the recursive quantities and the sums that weights are made of
#version 460
#include "core/prelude.glsl"
#define STRATEGIES_OF_BDPT

#if defined(PASS_LIGHT)
#include "trace/trace.glsl"
#include "techniques/bidirectional/light_pass.glsl"
#elif defined(PASS_CAMERA)
#include "trace/trace.glsl"
#include "techniques/bidirectional/camera_pass.glsl"
#else
#include "core/resolve.glsl"
#endif
