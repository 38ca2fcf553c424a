// The cameras and the pixel filter.
#include "core/sampling.glsl"
#include "core/whole.glsl"

float sinc(float x) { return abs(x) < 1e-3 ? 1.0 - x * x / 6.0 : sin(x) / x; }

// The filter's value at a distance from the pixel's centre, up to a constant factor; the same formulas as
// `Filter::value` in src/scene/description/filter.rs.
float filter_value(float x) {
    float p = scene.filter_parameters.x, q = scene.filter_parameters.y;
    x = abs(x);
    if (FILTER == FILTER_TENT) return max(0.0, 1.0 - x / p);
    if (FILTER == FILTER_GAUSSIAN) return max(0.0, exp(-x * x / (2.0 * p * p)) - exp(-q * q / (2.0 * p * p)));
    if (FILTER == FILTER_LANCZOS) return x < p ? sinc(PI * x) * sinc(PI * x / p) : 0.0;
    float inner = ((12.0 - 9.0 * p - 6.0 * q) * x + (-18.0 + 12.0 * p + 6.0 * q)) * x * x + (6.0 - 2.0 * p);
    float outer = (((-p - 6.0 * q) * x + (6.0 * p + 30.0 * q)) * x + (-12.0 * p - 48.0 * q)) * x + (8.0 * p + 24.0 * q);
    return (x < 1.0 ? inner : outer) / 6.0;
}

// Where the filter ends, in pixels.
float filter_radius() {
    return FILTER == FILTER_TENT || FILTER == FILTER_LANCZOS ? scene.filter_parameters.x : FILTER == FILTER_GAUSSIAN ? scene.filter_parameters.y : FILTER == FILTER_MITCHELL ? 2.0 : 0.5;
}

// Its value anywhere.
float filter_at(float x) { return abs(x) > filter_radius() ? 0.0 : filter_value(x); }

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

// A point of the lens, from its middle; nothing of other cameras, which have none.
vec3 lens_shift(vec2 u) {
    if (CAMERA != CAMERA_THIN_LENS) return vec3(0.0);
    vec2 lens = sample_disk(u);
    return lens.x * scene.lens_x + lens.y * scene.lens_y;
}

// The ray through the image at `position`, in pixels from the upper left corner, from a point of the lens.
Ray camera_ray_from(vec3 shift, vec2 position) {
    vec3 d = scene.camera_corner + position.x * scene.camera_dx + position.y * scene.camera_dy;
    // Every ray of a pixel meets the plane of focus in the same point.
    if (CAMERA == CAMERA_THIN_LENS) return Ray(scene.camera_origin + shift, normalize(scene.focus * d - shift), INFINITY);
    if (CAMERA == CAMERA_ORTHOGRAPHIC)
        return Ray(scene.camera_origin + position.x * scene.lens_x + position.y * scene.lens_y, scene.camera_corner, INFINITY);
    return Ray(scene.camera_origin, normalize(d), INFINITY);
}

// The ray through the image at `position`; `u` chooses the point of the lens.
Ray camera_ray(vec2 position, vec2 u) { return camera_ray_from(lens_shift(u), position); }

// How the camera sees a point: the other way round, for paths from the lights.
struct CameraView {
    vec3 target;       // the point of the camera that sees it
    vec3 direction;    // unit, from the point to there
    float t_max;       // distance to there
    float distance2;   // its square, or 1 where the camera's rays are parallel
    vec2 position;     // in the image, in pixels
    float importance;  // pixels per solid angle at the camera, or per area across parallel rays
    bool visible;      // it lies before the camera, and some pixel's filter reaches it
};

// Pixels per solid angle along a ray of the camera (per area across parallel rays), in any direction that it has.
float camera_importance(vec3 direction) {
    vec3 n = cross(scene.camera_dx, scene.camera_dy);
    if (CAMERA == CAMERA_ORTHOGRAPHIC) return 1.0 / abs(dot(scene.camera_corner, cross(scene.lens_x, scene.lens_y)));
    // A pixel covers |n . e| / |e|^3, where e goes along the ray to the plane at distance one.
    float volume = dot(n, scene.camera_corner);
    vec3 e = direction * (volume / dot(n, direction));
    float length2 = dot(e, e);
    return length2 * sqrt(length2) / abs(volume);
}

bool in_image(vec2 position) {
    float reach = filter_radius();
    return all(greaterThan(position, vec2(-reach))) && all(lessThan(position, vec2(scene.width, scene.height) + reach));
}

// Where the image shows what lies in the direction w of a point of the lens, which is `shift` off its centre; false where it does not.
bool image_position(vec3 shift, vec3 w, out vec2 position) {
    vec3 a = scene.camera_dx, b = scene.camera_dy, c = scene.camera_corner;
    // Along the ray to the plane of focus, and from there back to the plane at distance one (a pinhole has all planes sharp).
    float volume = dot(c, cross(a, b));
    float depth = dot(w, cross(a, b)) / volume;
    vec3 d = CAMERA == CAMERA_THIN_LENS ? shift / scene.focus + w / depth : w / depth;
    position = vec2(dot(d, cross(b, c)), dot(d, cross(c, a))) / volume;
    return depth > 0.0 && in_image(position);
}

float lens_area() { return PI * dot(scene.lens_x, scene.lens_x); }

// Cosine of a direction to the lens's axis.
float lens_cosine(vec3 direction) { return abs(dot(direction, normalize(cross(scene.camera_dx, scene.camera_dy)))); }

// Whether a ray runs through the lens before it ends, seen by the image: where, in pixels, and at which distance.
bool lens_hit(Ray ray, float end, out vec2 position, out float t) {
    vec3 axis = cross(scene.camera_dx, scene.camera_dy);
    t = dot(axis, scene.camera_origin - ray.origin) / dot(axis, ray.direction);
    position = vec2(0.0);
    if (!(t > 0.0 && t < end)) return false;
    vec3 shift = ray.origin + t * ray.direction - scene.camera_origin;
    return dot(shift, shift) <= dot(scene.lens_x, scene.lens_x) && image_position(shift, -ray.direction, position);
}

// As seen from a point of the lens.
CameraView camera_view_from(vec3 shift, vec3 p) {
    CameraView v;
    v.target = scene.camera_origin;
    if (CAMERA == CAMERA_ORTHOGRAPHIC) {
        vec3 a = scene.lens_x, b = scene.lens_y, c = scene.camera_corner;
        vec3 w = p - scene.camera_origin;
        float volume = dot(c, cross(a, b));
        v.position = vec2(dot(w, cross(b, c)), dot(w, cross(c, a))) / volume;
        float depth = dot(w, cross(a, b)) / volume;
        v.visible = depth > 0.0 && in_image(v.position);
        v.target = p - depth * c;
        v.direction = -c;
        v.t_max = depth;
        v.distance2 = 1.0;
        v.importance = camera_importance(c);
        return v;
    }
    v.target = scene.camera_origin + shift;
    vec3 w = p - v.target;
    v.visible = image_position(shift, w, v.position);
    v.distance2 = dot(w, w);
    v.t_max = sqrt(v.distance2);
    v.direction = -w / v.t_max;
    v.importance = camera_importance(-v.direction);
    return v;
}

// How the camera sees p; `u` chooses the point of the lens.
CameraView camera_view(vec3 p, vec2 u) { return camera_view_from(lens_shift(u), p); }

// A pixel that a position in the image belongs to, chosen by the filter's absolute value at it, along one axis; multiplies `weight`
// so that each pixel gets the filter's value in the mean.
int filter_pixel(float x, float u, inout float weight) {
    int own = whole_signed(clamp(x, -1e6, 1e6)); // beside the image, as far as that
    if (FILTER == FILTER_BOX) return own;
    int reach = int(ceil(filter_radius() + 0.5));
    float total = 0.0;
    for (int i = own - reach; i <= own + reach; i++) total += abs(filter_at(x - (float(i) + 0.5)));
    float rest = u * total;
    int chosen = own;
    float value = 0.0;
    for (int i = own - reach; i <= own + reach; i++) {
        float f = filter_at(x - (float(i) + 0.5));
        if (f != 0.0 && rest >= 0.0) { chosen = i; value = f; }
        rest -= abs(f);
    }
    weight *= (value < 0.0 ? -total : total) * scene.filter_scale;
    return chosen;
}
