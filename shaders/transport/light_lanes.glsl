// Lanes that follow subpaths from the lights: one for each sample of a pixel, as far as a sample has so many.
#include "transport/lanes.glsl"
#include "transport/light_subpath.glsl"

struct LightLane {
    Pixel pixel; // numbers the subpath; it has nothing to do with where that is seen
    Path path;
    EmittedRay emitted;
    uint rays;
};

bool light_open(out LightLane lane) {
    lane.pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    lane.rays = 0u;
    return lane.pixel.inside && lane.pixel.index < light_subpaths.light_path_count;
}

bool light_has_next(LightLane lane) { return pixel_has_sample(lane.pixel); }

void light_begin(inout LightLane lane) { lane.path = light_path_begin(lane.pixel.index, lane.pixel.sample_index, lane.emitted); }

void light_end(inout LightLane lane) { lane.pixel.sample_index += 1u; }
void light_close(LightLane lane) { count_rays(lane.rays); }
