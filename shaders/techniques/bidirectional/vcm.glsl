// `vcm`: vertex connection and merging (Georgiev, Krivanek, Davidovic and Slusallek 2012; Hachisuka, Pantaleoni and Jensen 2012):
// all strategies of bidirectional path tracing, and at each vertex of the camera subpath a merge with the light subpaths of the whole
// sample, under one multiple importance sampling. Light that is refracted or mirrored on both of its sides, which no connection
// finds, comes by merges. Biased by their radius, which shrinks with every sample, so that the bias vanishes.
//
// To be read as bdpt.glsl says; the passes `grid-...` (core/grid_build.glsl) sort the vertices of the light subpaths in between, and merges sum
// up what core/grid.glsl finds of them (transport/density_sums.glsl).
#version 460
#include "core/prelude.glsl"
#include "generated/parameters.glsl"
#define STRATEGIES_OF_VCM
#define SPLITS_LOBES (FORM == FORM_PPM)

#if defined(PASS_LIGHT)
#include "trace/trace.glsl"
#include "techniques/bidirectional/light_pass.glsl"
#elif defined(PASS_CAMERA)
#include "trace/trace.glsl"
#include "techniques/bidirectional/camera_pass.glsl"
#elif defined(PASS_RESOLVE)
#include "core/resolve.glsl"
#else
#include "core/grid_build.glsl"
GRID_BUILD(LIGHT_VERTEX_BYTES)
#endif
