// Traversal of a scene of a few dozen primitives that the kernel holds as constants: no memory, no branches.
#include "generated/inline.glsl"

bool inline_closest(Ray ray, inout Nearest nearest) {
    Shear shear = shear_along(ray.direction);
    bool found = false;
#define TAKE(index, hit)                                                                                                \
    bool closer = hit && t > 0.0 && t < nearest.t;                                                                      \
    nearest.t = closer ? t : nearest.t;                                                                                 \
    nearest.edges = closer ? edges : nearest.edges;                                                                     \
    nearest.primitive = closer ? index : nearest.primitive;                                                             \
    found = found || closer;
#define VISIT_TRIANGLE(index, v0, v1, v2)                                                                               \
    {                                                                                                                   \
        float t;                                                                                                        \
        vec3 edges;                                                                                                     \
        TAKE(index, triangle_hit(shear, ray.origin, ray.direction, v0, v1, v2, t, edges))                               \
    }
#define VISIT_SPHERE(index, centre, radius)                                                                             \
    {                                                                                                                   \
        float t;                                                                                                        \
        vec3 edges = vec3(0.0);                                                                                         \
        TAKE(index, sphere_hit(ray.origin, ray.direction, centre, radius, t))                                           \
    }
    INLINE_PRIMITIVES(VISIT_TRIANGLE, VISIT_SPHERE)
#undef VISIT_SPHERE
#undef VISIT_TRIANGLE
#undef TAKE
    return found;
}

bool inline_any(Ray ray) {
    Shear shear = shear_along(ray.direction);
    bool found = false;
#define TAKE(hit) found = hit && t > 0.0 && t < ray.t_max || found;
#define VISIT_TRIANGLE(index, v0, v1, v2)                                                                               \
    {                                                                                                                   \
        float t;                                                                                                        \
        vec3 edges;                                                                                                     \
        TAKE(triangle_hit(shear, ray.origin, ray.direction, v0, v1, v2, t, edges))                                      \
    }
#define VISIT_SPHERE(index, centre, radius)                                                                             \
    {                                                                                                                   \
        float t;                                                                                                        \
        TAKE(sphere_hit(ray.origin, ray.direction, centre, radius, t))                                                  \
    }
    INLINE_PRIMITIVES(VISIT_TRIANGLE, VISIT_SPHERE)
#undef VISIT_SPHERE
#undef VISIT_TRIANGLE
#undef TAKE
    return found;
}
