// A path as `path` makes it, from random numbers that are mutated (Kelemen et al. 2002).
#include "techniques/metropolis/chains.glsl"
#include "techniques/path/explicit.glsl"

struct Primary {
    Path path;
    vec2 position; // in the image
};

// Begins a path; `random` is at its beginning. Lengths are of one kind. Returns whether anything is left to follow.
bool primary_begin(Sampler random, uint kind, inout Estimate e, out Primary p) {
    vec4 u = next4(random);
    p.position = image_place(u.xy);
    p.path = path_from_camera(camera_ray(p.position, u.zw), random);
    return true;
}

bool primary_extend(inout Primary p, inout Estimate e) { return path_extend(p.path, e); }

float primary_share(Primary p) { return 1.0; }

// Blocks of numbers that the path has used.
uint primary_used(Primary p) { return min(p.path.random.dimension, 0xffffu); }
