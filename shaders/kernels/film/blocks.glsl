// Adds each pixel's sums over a block of samples to sums in whole numbers, and clears them. Whole numbers have the same sum in whatever order they
// are added, so a rendering whose blocks are divided among machines has the bits of one run (docs/clusters.md). The host runs this after each block.
#version 460
#include "core/prelude.glsl"
#include "core/film.glsl"

// A sum of 128 bits, the lowest word first, in two's complement.
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer BlockSums { uvec4 at[]; };

// The most that a word of a float is moved up: then 2^26 blocks have a sum.
const int MOST_SHIFT = 77;

// x in units of 2^unit, rounded to the nearest; what is beyond 2^101 of them counts as about that.
uvec4 fixed_point(float x, int unit) {
    uint bits = floatBitsToUint(x);
    int exponent = int(bits >> 23u & 0xffu);
    if (exponent == 0) return uvec4(0u); // below the smallest normal number
    uint mantissa = bits & 0x7fffffu | 0x800000u;
    int shift = min(exponent - 150 - unit, MOST_SHIFT);
    if (shift < 0) {
        uint down = uint(min(-shift, 31));
        mantissa = (mantissa + (1u << (down - 1u))) >> down;
        shift = 0;
    }
    uint within = uint(shift) & 31u;
    uint word = uint(shift) >> 5u;
    uint low = mantissa << within;
    uint high = within > 0u ? mantissa >> (32u - within) : 0u;
    uvec4 value = word == 0u ? uvec4(low, high, 0u, 0u) : word == 1u ? uvec4(0u, low, high, 0u) : uvec4(0u, 0u, low, high);
    if ((bits & 0x80000000u) == 0u) return value;
    value = ~value;
    value.x += 1u;
    if (value.x == 0u) value.y += 1u;
    if (value.x == 0u && value.y == 0u) value.z += 1u;
    if (value.x == 0u && value.y == 0u && value.z == 0u) value.w += 1u;
    return value;
}

uvec4 added(uvec4 a, uvec4 b) {
    uvec4 sum;
    uint carry = 0u;
    [[unroll]] for (uint i = 0u; i < 4u; i++) {
        uint partial = a[i] + b[i];
        sum[i] = partial + carry;
        carry = uint(partial < a[i]) + uint(sum[i] < partial);
    }
    return sum;
}

// Adds a sum and its low part to a pixel's three whole numbers.
void fold(uint pixel, vec3 sum, vec3 low, int unit) {
    BlockSums sums = BlockSums(unpack32(pack64(frame.technique) + uint64_t(48u) * uint64_t(pixel)));
    for (uint i = 0u; i < 3u; i++) {
        uvec4 block = added(fixed_point(sum[i], unit), fixed_point(low[i], unit));
        sums.at[i] = added(sums.at[i], block);
    }
}

layout(local_size_x = WORKGROUP) in;

// The technique's own word says which sums: of samples, of squares, of differences, then of each layer.
void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    // The exponent of the splats' unit, and from it those of sums and of squares: src/render/blocks.rs has the same.
    int unit = int(floatBitsToUint(scene.splat_unit) >> 23u & 0xffu) - 127;
    int unit_of_sums = unit - int(BLOCK_SUM_BITS), unit_of_squares = 2 * unit + int(BLOCK_SQUARE_BITS);
    FilmPixel sums = pixel.sums;
    if (frame.word == 0u) {
        fold(pixel.index, sums.sum, sums.sum_low, unit_of_sums);
        sums.sum = sums.sum_low = vec3(0.0);
    } else if (frame.word == 1u) {
        fold(pixel.index, sums.squares, sums.squares_low, unit_of_squares);
        sums.squares = sums.squares_low = vec3(0.0);
    } else if (frame.word == 2u) {
        fold(pixel.index, sums.difference, vec3(0.0), unit_of_sums);
        sums.difference = vec3(0.0);
    } else if (LENGTH_LAYERS > 0u) {
        Layers layers = Layers(frame.layers);
        uint at = 2u * (pixel.index * LENGTH_LAYERS + frame.word - 3u);
        fold(pixel.index, layers.at[at], layers.at[at + 1u], unit_of_sums);
        layers.at[at] = layers.at[at + 1u] = vec3(0.0);
    }
    FilmPixels(frame.film).at[pixel.index] = sums;
}
