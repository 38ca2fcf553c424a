// Counter-based uniform numbers: a pure function of (seed, pixel, sample, dimension), so that frame size, order and
// backend change nothing. A technique that defines SAMPLER_OF_CHAINS takes them from techniques/metropolis/numbers.glsl instead.

// Random numbers of light subpaths begin here: no path from the camera comes so far.
const uint LIGHT_DIMENSION = 0x10000u;

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

// Uniform on [0, 1) in steps of 2^-24.
vec4 uniform4(uvec4 bits) { return vec4(bits >> 8u) * (1.0 / 16777216.0); }

#ifndef SAMPLER_OF_CHAINS
struct Sampler {
    uint pixel;
    uint sample_index;
    uint dimension; // blocks of four numbers drawn so far
    uint seed;
};

// The bits of x, each flipped or not by a hash of the bits below it: a nested uniform scramble (Owen 1995) of the number
// whose bits are those of x in reverse (Laine and Karras 2011; constants by Vegdahl 2021, "Building a better LK hash").
uint owen_hash(uint x, uint key) {
    x ^= x * 0x3d20adeau;
    x += key;
    x *= (key >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// The second dimension of the Sobol sequence with its bits in reverse, as the first dimension has those of the index: Pascal's
// triangle modulo 2, by halves (Ahmed 2024, "An implementation algorithm of 2D Sobol sequence, fast, elegant and compact").
uint sobol_second(uint index) {
    index ^= (index >> 16u) & 0x0000ffffu;
    index ^= (index >> 8u) & 0x00ff00ffu;
    index ^= (index >> 4u) & 0x0f0f0f0fu;
    index ^= (index >> 2u) & 0x33333333u;
    index ^= (index >> 1u) & 0x55555555u;
    return index;
}

// A point of the sequence, its order shuffled and its coordinates scrambled by keys: 32 bits each. `reversed` is the index
// with its bits in reverse. Shuffling one index and scrambling each dimension keeps the net (Burley 2020, "Practical hash-based
// Owen scrambling", sections 3 and 4).
uvec2 sobol_pair(uint reversed, uint shuffle, uint key_x, uint key_y) {
    uint index = bitfieldReverse(owen_hash(reversed, shuffle));
    return bitfieldReverse(uvec2(owen_hash(index, key_x), owen_hash(sobol_second(index), key_y)));
}

// Four numbers: two pairs, each of which the points of a sequence spread evenly over the unit square. Sequences of other numbers are
// scrambled independently.
uvec4 sobol_pairs(Sampler s, uint sequence, uint index) {
    uvec4 key = pcg4d(uvec4(s.pixel, s.dimension, s.seed, 0x5b0e1u + sequence));
    uvec4 more = pcg4d(key);
    uint reversed = bitfieldReverse(index);
    return uvec4(sobol_pair(reversed, key.x, key.y, key.z), sobol_pair(reversed, more.x, more.y, more.z));
}

// The next four numbers, uniform on [0, 1) in steps of 2^-24: independent ones, or two pairs, each of which is spread evenly over the unit
// square by the samples of even index and by those of odd index. The two halves are independent, so their difference tells the error
// (FilmPixel.difference).
vec4 next4(inout Sampler s) {
    uvec4 bits;
    if (HAS_SOBOL) bits = sobol_pairs(s, s.sample_index & 1u, s.sample_index >> 1u);
    else bits = pcg4d(uvec4(s.pixel, s.sample_index, s.dimension, s.seed));
    s.dimension += 1u;
    return uniform4(bits);
}

// The next four numbers as two pairs that all samples together spread evenly over the unit square, whatever the sampler.
vec4 next4_spread(inout Sampler s) {
    uvec4 bits = sobol_pairs(s, 0u, s.sample_index);
    s.dimension += 1u;
    return uniform4(bits);
}
#endif
