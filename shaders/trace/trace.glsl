// What kernels call: the backend's one function by its two uses. Code that needs both at run time calls `trace` itself, so that it is
// compiled once.
#include "trace/backend.glsl"

// The nearest hit in (0, t_max).
bool trace_closest(Ray ray, out Hit hit) { return trace(ray, false, hit); }

// Whether anything lies in (0, t_max).
bool trace_any(Ray ray) {
    Hit hit;
    return trace(ray, true, hit);
}
