// The main function of the pass `resolve`: takes the splats of each sample as that sample's value, and clears them.
#include "core/splat.glsl"

layout(local_size_x = WORKGROUP) in;

vec3 take(uint pixel, uint sample_index, uint layer) {
    Splat sums = splat_of(pixel, sample_index, layer);
    vec3 value;
    [[unroll]] for (uint i = 0u; i < 3u; i++) {
        value[i] = float(sums.channel[i]) * scene.splat_unit;
        sums.channel[i] = 0l;
    }
    return value;
}

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    Estimate e;
    e.rays = 0u;
    while (pixel_has_sample(pixel)) {
        e.radiance = vec3(0.0);
        for (uint layer = 0u; layer < splat_layers(); layer++) {
            vec3 value = take(pixel.index, pixel.sample_index, layer);
            if (!HAS_STRATEGIES || layer % 2u == 1u) e.radiance += value; // the image is the sum of what is weighted
            if (LENGTH_LAYERS > 0u) e.by_length[layer] = value;
        }
        pixel.filter_weight = 1.0;
        sample_close(pixel, e);
    }
    pixel_close(pixel, e);
}
