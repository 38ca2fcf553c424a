// Counter-based random numbers: a pure function of (seed, pixel, sample, dimension), so that frame size, order and
// backend change nothing.

struct Sampler {
    uint pixel;
    uint sample_index;
    uint dimension; // blocks of four numbers drawn so far
    uint seed;
};

// Jarzynski and Olano 2020, "Hash functions for GPU rendering", pcg4d.
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// The next four independent numbers, uniform on [0, 1) in steps of 2^-24.
vec4 next4(inout Sampler s) {
    uvec4 bits = pcg4d(uvec4(s.pixel, s.sample_index, s.dimension, s.seed));
    s.dimension += 1u;
    return vec4(bits >> 8u) * (1.0 / 16777216.0);
}
