// One pixel's share of the film: the samples of a dispatch, their sums, and what was wrong with them.
#include "core/rng.glsl"
#include "core/camera.glsl"
#include "core/record.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer FilmPixels { FilmPixel at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Layers { vec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Tallies { Tally tally; BadSample bad[BAD_SAMPLES]; uint rays[RAY_COUNTERS]; };

// Contributions as integers in units of scene.splat_unit: beyond this many units one counts as not finite. A sum of 64 of them fits into 64 bits.
const float LARGEST_FIXED = 1.44e17; // 2^57

// What one sample has gathered so far.
struct Estimate {
    vec3 radiance;
    vec3 by_length[LENGTH_LAYERS + 1u]; // radiance by path length, only where layers are asked for
    uint rays;                          // traced since the dispatch began
};

// Begins another sample.
void estimate_clear(inout Estimate e) {
    e.radiance = vec3(0.0);
    if (LENGTH_LAYERS > 0u) {
        for (uint i = 0u; i < LENGTH_LAYERS; i++) e.by_length[i] = vec3(0.0);
    }
}

// Adds what a path of `length` segments brings to an estimate that need not be the sample's.
void gather(inout Estimate e, uint length, vec3 radiance) {
    e.radiance += radiance;
    if (LENGTH_LAYERS > 0u) e.by_length[min(length, LENGTH_LAYERS) - 1u] += radiance;
}

// Adds the contribution of a path of `length` segments to the sample (length 1: the camera sees a light).
void contribute(inout Estimate e, uint length, vec3 radiance) {
    record_contribution(length, radiance);
    gather(e, length, radiance);
}

// A pixel and its position in this dispatch's run of samples.
struct Pixel {
    bool inside;
    uvec2 xy;
    uint index;
    uint sample_index;
    float filter_weight;
    FilmPixel sums;
};

// Slots run through the image in tiles of 8 x 8, row by row of tiles, so that a workgroup's rays stay together.
Pixel pixel_open(uint slot) {
    uint tiles_across = (scene.width + 7u) / 8u;
    uint tile = slot / 64u;
    uint within = slot % 64u;
    Pixel pixel;
    pixel.xy = uvec2(tile % tiles_across * 8u + within % 8u, tile / tiles_across * 8u + within / 8u);
    pixel.inside = pixel.xy.x < scene.width && pixel.xy.y < scene.height;
    pixel.index = pixel.xy.y * scene.width + pixel.xy.x;
    pixel.sample_index = frame.first_sample;
    pixel.filter_weight = 1.0;
    if (pixel.inside) pixel.sums = FilmPixels(frame.film).at[pixel.index];
    return pixel;
}

bool pixel_has_sample(Pixel pixel) { return pixel.sample_index < frame.first_sample + frame.sample_count; }

// Begins the pixel's next sample: its random numbers, and a place under the filter, as it lies from the pixel's centre. `on_lens` chooses the
// point of the lens.
vec2 sample_offset(inout Pixel pixel, out Sampler random, out vec2 on_lens) {
    random = Sampler(pixel.index, pixel.sample_index, 0u, frame.seed);
    record_begin_pixel(pixel.index, pixel.sample_index);
    vec4 u = next4(random);
    pixel.filter_weight = 1.0;
    on_lens = u.zw;
    return vec2(filter_offset(u.x, pixel.filter_weight), filter_offset(u.y, pixel.filter_weight));
}

// The ray of the pixel's next sample.
Ray sample_open(inout Pixel pixel, inout Estimate e, out Sampler random) {
    vec2 on_lens;
    vec2 offset = sample_offset(pixel, random, on_lens);
    estimate_clear(e);
    return camera_ray(vec2(pixel.xy) + 0.5 + offset, on_lens);
}

// (sum, low) += x without losing what the sum is too coarse to hold (Knuth, The Art of Computer Programming 2, 4.2.2). The
// low part is folded back each time: left to grow it would itself become too coarse for what it takes in.
void add_compensated(inout vec3 sum, inout vec3 low, vec3 x) {
    precise vec3 total = sum + x;
    precise vec3 back = total - sum;
    precise vec3 lost = low + ((sum - (total - back)) + (x - back));
    precise vec3 folded = total + lost;
    precise vec3 left = lost - (folded - total);
    low = left;
    sum = folded;
}

// Counts and locates something that is not finite and is dropped.
void report_bad_sample(uint pixel, uint sample_index) {
    Tallies tallies = Tallies(frame.tally);
    uint n = atomicAdd(tallies.tally.bad_samples, 1u);
    if (n < BAD_SAMPLES) tallies.bad[n] = BadSample(pixel, sample_index);
}

// Adds rays that were traced to the host's count.
void count_rays(uint rays) { atomicAdd(Tallies(frame.tally).rays[gl_WorkGroupID.x % RAY_COUNTERS], rays); }

// Ends the pixel's sample: adds it to the sums, or, if it is not finite, drops, counts and locates it.
void sample_close(inout Pixel pixel, Estimate e) {
    vec3 x = e.radiance * pixel.filter_weight;
    record_value(pixel.index, pixel.sample_index, x, pixel.filter_weight);
    if (any(isnan(x)) || any(isinf(x))) {
        report_bad_sample(pixel.index, pixel.sample_index);
    } else {
        add_compensated(pixel.sums.sum, pixel.sums.sum_low, x);
        precise vec3 square = x * x;
        precise vec3 square_lost = fma(x, x, -square);
        add_compensated(pixel.sums.squares, pixel.sums.squares_low, square);
        pixel.sums.squares_low += square_lost;
        if (HAS_SOBOL) pixel.sums.difference += (pixel.sample_index & 1u) == 0u ? x : -x;
        if (LENGTH_LAYERS > 0u) {
            Layers layers = Layers(frame.layers);
            for (uint i = 0u; i < LENGTH_LAYERS; i++) {
                uint at = 2u * (pixel.index * LENGTH_LAYERS + i);
                vec3 sum = layers.at[at], low = layers.at[at + 1u];
                add_compensated(sum, low, e.by_length[i] * pixel.filter_weight);
                layers.at[at] = sum;
                layers.at[at + 1u] = low;
            }
        }
    }
    pixel.sample_index += 1u;
}

// Writes the pixel's sums back and counts its rays.
void pixel_close(Pixel pixel, Estimate e) {
    FilmPixels(frame.film).at[pixel.index] = pixel.sums;
    count_rays(e.rays);
}
