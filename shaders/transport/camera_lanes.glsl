// Lanes that follow paths from the camera, one for each sample of a pixel, whose contributions go to that pixel.
#include "transport/lanes.glsl"
#include "transport/path.glsl"

struct CameraLane {
    Pixel pixel;
    Path path;
    Estimate e; // of the sample at hand
};

bool camera_open(out CameraLane lane) {
    lane.pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    lane.e.rays = 0u;
    return lane.pixel.inside;
}

bool camera_has_next(CameraLane lane) { return pixel_has_sample(lane.pixel); }

bool camera_begin(inout CameraLane lane) {
    Sampler random;
    Ray ray = sample_open(lane.pixel, lane.e, random);
    lane.path = path_from_camera(ray, random);
    return true;
}

void camera_end(inout CameraLane lane) { sample_close(lane.pixel, lane.e); }
void camera_close(CameraLane lane) { pixel_close(lane.pixel, lane.e); }

// The main function of a pass over pixels whose paths are extended by `bool extend(inout CameraLane)`.
#define CAMERA_LANES(extend) LANES(CameraLane, camera_open, camera_has_next, camera_begin, extend, camera_end, camera_close)
