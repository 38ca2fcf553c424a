// A path as `path` makes it, from random numbers that are mutated (Kelemen et al. 2002, primary sample space).
#include "techniques/metropolis/chains.glsl"
#include "techniques/path/explicit.glsl"

struct Walk {
    Path path;
    vec2 position; // in the image
};

// Lengths are of one kind.
bool walk_begin(Proposal p, uint room, inout Estimate e, out Walk w) {
    vec4 u = next4(p.random);
    w.position = image_place(u.xy);
    w.path = path_from_camera(camera_ray(w.position, u.zw), p.random);
    return true;
}

bool walk_extend(inout Walk w, Proposal p, inout Estimate e) { return explicit_extend(w.path, e); }

float walk_share(Walk w, Proposal p) { return 1.0 / kind_probability(p.kind); }

// Blocks of numbers that the path has used.
uint walk_known(Walk w) { return min(w.path.random.dimension, 0xffffu); }

#include "techniques/metropolis/numbers_walk.glsl"
