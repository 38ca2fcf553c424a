// The pinhole camera and the pixel filter.

// A sample of the pixel filter around a pixel's centre and its weight, whose mean is one: the filter is sampled in
// proportion to its absolute value (Ernst, Stamminger and Greiner 2006, "Filter importance sampling").
float filter_offset(float u, inout float weight) {
    if (FILTER_IS_BOX) return u - 0.5;
    Floats table = Floats(scene.filter_table);
    float x = u * float(FILTER_CELLS);
    uint cell = min(uint(x), FILTER_CELLS - 1u);
    weight *= table.at[FILTER_CELLS + 1u + cell];
    return mix(table.at[cell], table.at[cell + 1u], x - float(cell));
}

// The ray through the image at `position`, in pixels from the upper left corner.
Ray camera_ray(vec2 position) {
    vec3 d = scene.camera_corner + position.x * scene.camera_dx + position.y * scene.camera_dy;
    return Ray(scene.camera_origin, normalize(d), INFINITY);
}
