// Traversal of a scene of a few dozen triangles that the kernel holds as constants: no memory, no branches.
#include "generated/inline.glsl"

bool inline_closest(Ray ray, inout Nearest nearest) {
    Shear shear = shear_along(ray.direction);
    bool found = false;
#define VISIT(index, v0, v1, v2)                                                                                        \
    {                                                                                                                   \
        float t;                                                                                                        \
        vec3 edges;                                                                                                     \
        bool inside = triangle_hit(shear, ray.origin, ray.direction, v0, v1, v2, t, edges);                             \
        bool closer = inside && t > 0.0 && t < nearest.t;                                                               \
        nearest.t = closer ? t : nearest.t;                                                                             \
        nearest.edges = closer ? edges : nearest.edges;                                                                 \
        nearest.primitive = closer ? index : nearest.primitive;                                                         \
        found = found || closer;                                                                                        \
    }
    INLINE_TRIANGLES(VISIT)
#undef VISIT
    return found;
}

bool inline_any(Ray ray) {
    Shear shear = shear_along(ray.direction);
    bool found = false;
#define VISIT(index, v0, v1, v2)                                                                                           \
    {                                                                                                                      \
        float t;                                                                                                           \
        vec3 edges;                                                                                                        \
        bool inside = triangle_hit(shear, ray.origin, ray.direction, v0, v1, v2, t, edges);                                \
        found = inside && t > 0.0 && t < ray.t_max || found;                                                               \
    }
    INLINE_TRIANGLES(VISIT)
#undef VISIT
    return found;
}
