// Contributions to any pixel from anywhere: 64-bit fixed-point sums, whose value does not depend on their order. One plane for each
// sample of a dispatch; the pass `resolve` adds the planes to the film.
#extension GL_EXT_shader_atomic_int64 : require
#include "core/light_subpath_table.glsl"
#include "core/film.glsl"
#include "core/whole.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Splat { int64_t channel[3]; };

uint splat_layers() { return max(LENGTH_LAYERS, 1u); }

Splat splat_of(uint pixel, uint sample_index, uint layer) {
    uint64_t plane = uint64_t(sample_index - frame.first_sample);
    uint64_t index = (plane * uint64_t(scene.width * scene.height) + uint64_t(pixel)) * uint64_t(splat_layers()) + uint64_t(layer);
    return Splat(unpack32(pack64(light_subpaths.splats) + uint64_t(FIXED_RGB_BYTES) * index));
}

// Adds the contribution of a path of `length` segments to a pixel in this sample.
void splat(uint pixel, uint sample_index, uint length, vec3 value) {
    vec3 units = value / scene.splat_unit;
    if (!all(lessThan(abs(units), vec3(LARGEST_FIXED)))) {
        report_bad_sample(pixel, sample_index);
        return;
    }
    Splat sums = splat_of(pixel, sample_index, LENGTH_LAYERS > 0u ? min(length, LENGTH_LAYERS) - 1u : 0u);
    [[unroll]] for (uint i = 0u; i < 3u; i++) {
        int64_t amount = rounded64(units[i]);
        if (amount != 0l) atomicAdd(sums.channel[i], amount);
    }
}

// Adds the contribution of the strategy (s, t), by itself and with its weight among all.
void splat_strategy(uint pixel, uint sample_index, uint s, uint t, vec3 value, float weight) {
    uint k = s + t - 1u;
    uint layer = (k - 1u) * (k + 2u) + 2u * s; // of shorter paths, then of fewer vertices from the light
    if (CAMERA == CAMERA_THIN_LENS) layer += 2u * (max(k, 2u) - 2u); // t = 0 has one more for each length from 2
    splat(pixel, sample_index, layer + 1u, value);
    splat(pixel, sample_index, layer + 2u, value * weight);
}

// Adds the contribution of (s, t) with its weight: to its path length, or where strategies are told apart, to that strategy.
void splat_weighted(uint pixel, uint sample_index, uint s, uint t, vec3 value, float weight) {
    record_splat(pixel, sample_index, recorded_pixel, s, t, value * weight, weight);
    if (HAS_STRATEGIES) splat_strategy(pixel, sample_index, s, t, value, weight);
    else splat(pixel, sample_index, s + t - 1u, value * weight);
}

// Adds the estimate of a path from the camera to its own pixel.
void splat_sample(Pixel pixel, Estimate e) {
    if (HAS_STRATEGIES) return;
    if (LENGTH_LAYERS == 0u) splat(pixel.index, pixel.sample_index, 1u, e.radiance * pixel.filter_weight);
    for (uint i = 0u; i < LENGTH_LAYERS; i++) splat(pixel.index, pixel.sample_index, i + 1u, e.by_length[i] * pixel.filter_weight);
}

// The pixel of a position in the image by the pixel filter, whose weight multiplies `value`; NONE beside the image: what falls
// there is lost, as it is for the camera.
uint splat_pixel(vec2 position, vec2 u, inout vec3 value) {
    float weight = 1.0;
    int x = filter_pixel(position.x, u.x, weight), y = filter_pixel(position.y, u.y, weight);
    if (x < 0 || y < 0 || x >= int(scene.width) || y >= int(scene.height)) return NONE;
    value *= weight;
    return uint(y) * scene.width + uint(x);
}
