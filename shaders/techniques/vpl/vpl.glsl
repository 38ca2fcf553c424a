// `vpl`: instant radiosity (Keller 1997, "Instant radiosity"). Light subpaths leave a virtual point light at each of their vertices, and
// paths from the camera gather the indirect light of their vertices from these; light that comes straight from its source is sampled
// there. Each sample of the image has virtual point lights of its own, so that their mean has no more structure than noise.
//
// The geometry term between a vertex and a virtual point light has no bound, and makes splotches where they are close: it is clamped. What
// clamping takes is made up for by following the path to where it was taken (Kollig and Keller 2004, "Illumination in the presence of weak
// singularities"): compensate=yes is unbiased, compensate=no leaves corners dark, and finds no caustics.
//
// The pass `lights` makes the virtual point lights of a sample, the pass `camera` gathers: light_pass.glsl, camera_pass.glsl.
#version 460
#include "core/prelude.glsl"
#define SPLITS_LOBES true
#include "trace/trace.glsl"

#ifdef PASS_LIGHTS
#include "techniques/vpl/light_pass.glsl"
#else
#include "techniques/vpl/camera_pass.glsl"
#endif
