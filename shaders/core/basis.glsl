// Orthonormal frames: local space has its normal along +z.
#include "core/angle.glsl"

struct Basis {
    vec3 tangent;
    vec3 bitangent;
    vec3 normal;
};

// Duff et al. 2017, "Building an orthonormal basis, revisited".
Basis basis_from_normal(vec3 n) {
    float s = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + n.z);
    float b = n.x * n.y * a;
    return Basis(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

vec3 to_local(Basis f, vec3 w) { return vec3(dot(w, f.tangent), dot(w, f.bitangent), dot(w, f.normal)); }
vec3 to_world(Basis f, vec3 w) { return f.tangent * w.x + f.bitangent * w.y + f.normal * w.z; }

// Angle between unit vectors (Kahan 2006, "How futile are mindless assessments of roundoff", section 12): unlike the arc cosine of
// their product it keeps its digits near 0 and pi, and devices may approximate that one to three digits.
float angle_between(vec3 a, vec3 b) { return 2.0 * angle_of(length(a - b), length(a + b)); }
