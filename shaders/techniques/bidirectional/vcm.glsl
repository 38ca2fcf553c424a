// `vcm`: vertex connection and merging (Georgiev, Krivanek, Davidovic and Slusallek 2012; Hachisuka, Pantaleoni and Jensen 2012):
// all strategies of bidirectional path tracing, and at each vertex of the camera's path a merge with the light paths of the whole
// sample, under one multiple importance sampling. Light that is refracted or mirrored on both of its sides, which no connection
// finds, comes by merges. Biased by their radius, which shrinks with every sample, so that the bias vanishes.
//
// The pass `light` follows the light paths of a sample, shows their vertices to the camera and keeps them; the passes `grid-...` sort
// them; the pass `camera` connects and merges.
#version 460
#include "core/prelude.glsl"
#include "techniques/bidirectional/vcm_forms.glsl"

#if defined(PASS_LIGHT)
#include "trace/trace.glsl"
#include "techniques/bidirectional/light_pass.glsl"
#elif defined(PASS_CAMERA)
#include "trace/trace.glsl"
#include "techniques/bidirectional/camera_pass.glsl"
#elif defined(PASS_RESOLVE)
#include "core/resolve.glsl"
#else
#include "techniques/bidirectional/kept_paths.glsl"
#include "core/grid_build.glsl"
#endif
