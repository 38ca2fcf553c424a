// The main function of a pass over pixels. Before it is included, the technique defines
//     bool path_extend(inout Path path, inout Estimate e)
// which traces the path's ray to its next vertex and chooses the ray after it, and is false where the path ends.
layout(local_size_x = WORKGROUP) in;

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    Estimate e;
    e.rays = 0u;
    Path path;
    bool alive = false;
    // A lane whose path has ended begins its next sample at once instead of waiting for its neighbours.
    while (alive || pixel_has_sample(pixel)) {
        if (!alive) path = path_begin(pixel, e);
        alive = path_extend(path, e);
        if (!alive) sample_close(pixel, e);
    }
    pixel_close(pixel, e);
}
