// `photon`: progressive photon mapping (Hachisuka, Ogaki and Jensen 2008) in the form of Knaus and Zwicker 2011: each sample of the
// image is a photon map of its own, with a smaller radius than the one before, and the image is their mean. Biased at any number of
// samples, but the bias vanishes as that grows.
//
// The pass `light` follows paths from the lights and keeps photons where they meet what is not as smooth as a mirror; the passes
// `grid-...` sort them; the pass `camera` follows narrow lobes only, deltas among them, and at each vertex gathers photons for all other lobes.
//
// To be read in this order: light_pass.glsl, camera_pass.glsl, photons.glsl.
#version 460
#include "core/prelude.glsl"
#define SPLITS_LOBES true

#if defined(PASS_LIGHT)
#include "trace/trace.glsl"
#include "techniques/photon/light_pass.glsl"
#elif defined(PASS_CAMERA)
#include "trace/trace.glsl"
#include "techniques/photon/camera_pass.glsl"
#else
#include "core/grid_build.glsl"
GRID_BUILD(PHOTON_BYTES)
#endif
