// A triangle's plane, written once: traversal decides with it on which side of the triangle a ray begins, and whoever
// starts a ray on the triangle moves it off the very same plane. Every product that is summed is an explicit fma, so that
// no compiler contracts one use and not the other: both are the same bits.

// (v1 - v0) x (v2 - v0): twice the area long, towards the front. The loader puts the vertex opposite the longest edge
// first, which keeps the product well conditioned for slivers.
vec3 triangle_normal(vec3 v0, vec3 v1, vec3 v2) {
    vec3 a = v1 - v0;
    vec3 b = v2 - v0;
    return vec3(fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)), fma(a.x, b.y, -(a.y * b.x)));
}

// n . (v0 - origin): positive where the plane lies in front of the origin, seen along n.
float plane_distance(vec3 n, vec3 v0, vec3 origin) {
    vec3 p = v0 - origin;
    return fma(n.x, p.x, fma(n.y, p.y, n.z * p.z));
}

// The point with barycentric weights uv of the second and third vertex.
vec3 triangle_point(vec3 v0, vec3 v1, vec3 v2, vec2 uv) { return (1.0 - uv.x - uv.y) * v0 + uv.x * v1 + uv.y * v2; }

// How far along its unit normal a ray's origin at `p` must move so that plane_distance has the right sign whatever was
// rounded: what p is off the plane already, a bound on the rounding of plane_distance itself (three differences, three
// products, two sums), and one on the rounding of the move.
float triangle_margin(vec3 normal, vec3 v0, vec3 p) {
    return abs(dot(normal, p - v0)) + gamma(8.0) * dot(abs(normal), abs(p - v0)) + gamma(4.0) * dot(abs(normal), abs(p));
}
