// The cameras and the pixel filter.
#include "lib/sampling.glsl"

// The filter's value at a distance from the pixel's centre, up to a constant factor; the same formulas as
// `Filter::value` in src/scene/filter.rs.
float filter_value(float x) {
    float p = scene.filter_parameters.x, q = scene.filter_parameters.y;
    x = abs(x);
    if (FILTER == FILTER_TENT) return max(0.0, 1.0 - x / p);
    if (FILTER == FILTER_GAUSSIAN) return max(0.0, exp(-x * x / (2.0 * p * p)) - exp(-q * q / (2.0 * p * p)));
    float inner = ((12.0 - 9.0 * p - 6.0 * q) * x + (-18.0 + 12.0 * p + 6.0 * q)) * x * x + (6.0 - 2.0 * p);
    float outer = (((-p - 6.0 * q) * x + (6.0 * p + 30.0 * q)) * x + (-12.0 * p - 48.0 * q)) * x + (8.0 * p + 24.0 * q);
    return (x < 1.0 ? inner : outer) / 6.0;
}

// A sample of the pixel filter around a pixel's centre; multiplies `weight` by its weight, whose mean is one: cells that
// hold equal parts of the filter are equally likely (Ernst, Stamminger and Greiner 2006, "Filter importance sampling").
float filter_offset(float u, inout float weight) {
    if (FILTER == FILTER_BOX) return u - 0.5;
    Floats cells = Floats(scene.filter_table);
    float at = u * float(FILTER_CELLS);
    uint cell = min(uint(at), FILTER_CELLS - 1u);
    float left = cells.at[cell], right = cells.at[cell + 1u];
    float x = mix(left, right, at - float(cell));
    weight *= filter_value(x) * scene.filter_scale * (right - left) * float(FILTER_CELLS);
    return x;
}

// The ray through the image at `position`, in pixels from the upper left corner; `u` chooses the point on a lens.
Ray camera_ray(vec2 position, vec2 u) {
    vec3 d = scene.camera_corner + position.x * scene.camera_dx + position.y * scene.camera_dy;
    if (CAMERA == CAMERA_THIN_LENS) {
        // Every ray of a pixel meets the plane of focus in the same point.
        vec2 lens = sample_disk(u);
        vec3 shift = lens.x * scene.lens_x + lens.y * scene.lens_y;
        return Ray(scene.camera_origin + shift, normalize(scene.focus * d - shift), INFINITY);
    }
    if (CAMERA == CAMERA_ORTHOGRAPHIC)
        return Ray(scene.camera_origin + position.x * scene.lens_x + position.y * scene.lens_y, scene.camera_corner, INFINITY);
    return Ray(scene.camera_origin, normalize(d), INFINITY);
}
