// Ray-sphere intersection. The discriminant comes from the component of the centre perpendicular to the ray, and the
// roots from whichever form does not cancel (Haines, Guenther and Akenine-Moller 2019, Ray Tracing Gems, chapter 7).

// Whether the ray's line meets the sphere; then `t` is the first of the two distances that is positive, or the second.
bool sphere_hit(vec3 origin, vec3 direction, vec3 centre, float radius, out float t) {
    vec3 f = origin - centre;
    float a = dot(direction, direction);
    float b = dot(f, direction);
    vec3 perpendicular = f - (b / a) * direction;
    float r2 = radius * radius;
    float discriminant = r2 - dot(perpendicular, perpendicular);
    float c = dot(f, f) - r2;
    float root = sqrt(a * max(discriminant, 0.0));
    float q = b < 0.0 ? root - b : -root - b;
    float t0 = c / q;
    float t1 = q / a;
    float near = min(t0, t1);
    t = near > 0.0 ? near : max(t0, t1);
    return discriminant >= 0.0 && q != 0.0;
}
