// Random numbers as the state of a Markov chain (Kelemen, Szirmay-Kalos, Antal and Csonka 2002, "A simple and robust mutation strategy
// for the Metropolis light transport algorithm"): what draws them needs to know nothing of that.
//
// Each chain stores the numbers that made its current path. A proposal draws either new ones for all (a large step) or perturbs each.
// Numbers that the current path did not use, or that there is no room for, are drawn anew: the path does not depend on the former, and
// with the latter the path's value is one sample of a random value, which leaves the chain's distribution what it was (Andrieu and Roberts
// 2009, "The pseudo-marginal approach"). Either way a proposal is as likely as its reverse.
#include "core/rng.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer ChainTables { ChainTable at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Numbers { vec4 block; };

ChainTable chain_table() { return ChainTables(frame.technique).at[0]; }

// Numbers of one proposal. Nothing is drawn from what a chain has accepted since.
struct Sampler {
    uint chain;     // or the bootstrap sample, where `mutation` is 0
    uint mutation;
    uint dimension; // blocks of four numbers drawn so far
    uint known;     // blocks that the current path used: of the camera's in the lower half, of the light's in the upper one
};

// The longest and shortest perturbations (Kelemen et al., section 3.3).
const float LARGEST_STEP = 1.0 / 64.0;
const float SMALLEST_STEP = 1.0 / 1024.0;

bool is_of_light(uint dimension) { return dimension >= LIGHT_DIMENSION; }

// Where a chain keeps a block; false beyond what there is room for.
bool block_place(uint chain, uint dimension, out Numbers place) {
    ChainTable table = chain_table();
    bool light = is_of_light(dimension);
    uint block = light ? dimension - LIGHT_DIMENSION : dimension;
    uint room = light ? table.light_blocks : table.camera_blocks;
    uint64_t index = uint64_t(light ? table.camera_blocks + block : block) * uint64_t(table.chains) + uint64_t(chain);
    place = Numbers(unpack32(pack64(table.numbers) + uint64_t(VEC4_BYTES) * index));
    return block < room;
}

// Four numbers perturbed, on a circle: each way as likely, distances with equal density of their logarithm. The highest bit says which
// way: the lowest ones of consecutive mutations are correlated (by up to -0.25), and a chain whose steps remember the
// last one goes elsewhere: lamps of the Cornell box came out 4 % too bright.
vec4 perturbed(vec4 u, uvec4 bits) {
    vec4 step = LARGEST_STEP * exp(uniform4(bits << 1u) * -log(LARGEST_STEP / SMALLEST_STEP));
    vec4 moved = fract(u + mix(step, -step, greaterThanEqual(bits, uvec4(0x80000000u))));
    return mix(moved, vec4(0.0), greaterThanEqual(moved, vec4(1.0))); // fract of what is just below nothing rounds to one
}

// The next four numbers, uniform on [0, 1) over the proposals that large steps make.
vec4 next4(inout Sampler s) {
    uvec4 bits = pcg4d(uvec4(s.chain, s.mutation, s.dimension, frame.seed));
    uint block = is_of_light(s.dimension) ? s.dimension - LIGHT_DIMENSION : s.dimension;
    uint known = is_of_light(s.dimension) ? s.known >> 16u : s.known & 0xffffu;
    vec4 u = uniform4(bits);
    Numbers place;
    if (block < known && block_place(s.chain, s.dimension, place)) u = perturbed(place.block, bits);
    s.dimension += 1u;
    return u;
}

// Makes `count` blocks from `first` on, as this proposal drew them, those of the chain.
void keep_blocks(Sampler s, uint chain, uint first, uint count) {
    s.dimension = first;
    for (uint i = 0u; i < count; i++) {
        Numbers place;
        if (!block_place(chain, s.dimension, place)) return;
        place.block = next4(s);
    }
}

// Keeps the blocks that the path has used: of the camera's in the lower half of `used`, of the light's in the upper one.
void keep_numbers(Sampler s, uint chain, uint used) {
    keep_blocks(s, chain, 0u, used & 0xffffu);
    keep_blocks(s, chain, LIGHT_DIMENSION, used >> 16u);
}

// What belongs to a proposal as a whole: whether it is a large step, whether it is accepted, and which pixel takes it.
vec4 decisions(uint chain, uint mutation) { return uniform4(pcg4d(uvec4(chain, mutation, NONE, frame.seed))); }
