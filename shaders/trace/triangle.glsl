// Watertight ray-triangle intersection after Woop, Benthin and Wald 2013: each vertex is projected along the ray to a
// plane with the ray in the middle, and three edge functions there decide. A shared vertex projects to the same point
// for every triangle, and rounding cannot flip an edge function's sign, so no ray slips between neighbours. `precise`
// keeps the compiler from contracting the two products of an edge function, which would break exactly that.
//
// Unlike there, the distance comes from the triangle's plane: a ray that was moved off that plane then cannot meet it
// again, and planes along the axes are exact however large the triangle is.
#include "trace/triangle_plane.glsl"

// A projection along the ray: two rows of a shear along the direction's largest component. Zeroes and ones are exact,
// so each coordinate costs one rounded product.
struct Shear {
    vec3 row_x;
    vec3 row_y;
};

Shear shear_along(vec3 d) {
    vec3 a = abs(d);
    if (a.z >= a.x && a.z >= a.y) return Shear(vec3(1.0, 0.0, -d.x / d.z), vec3(0.0, 1.0, -d.y / d.z));
    if (a.x >= a.y) return Shear(vec3(-d.y / d.x, 1.0, 0.0), vec3(-d.z / d.x, 0.0, 1.0));
    return Shear(vec3(0.0, -d.z / d.y, 1.0), vec3(1.0, -d.x / d.y, 0.0));
}

vec2 project(Shear s, vec3 origin, vec3 v) {
    vec3 p = v - origin;
    return vec2(fma(p.x, s.row_x.x, fma(p.y, s.row_x.y, p.z * s.row_x.z)), fma(p.x, s.row_y.x, fma(p.y, s.row_y.y, p.z * s.row_y.z)));
}

// The nearest hit so far.
struct Nearest {
    float t;
    uint primitive;
    vec3 edges; // edge functions of a triangle: divided by their sum, the barycentric weights
};

// Twice the areas of the triangles that the origin of the plane makes with the edges of a projected one.
vec3 edge_functions(vec2 a, vec2 b, vec2 c) {
    precise float e0 = c.x * b.y - c.y * b.x;
    precise float e1 = a.x * c.y - a.y * c.x;
    precise float e2 = b.x * a.y - b.y * a.x;
    return vec3(e0, e1, e2);
}

// Whether the ray's line passes through a triangle with these edge functions. Those on an edge belong to both sides. Signs are compared as
// integers, where every value without a sign bit is above every one with it, because a float's min and max must mind NaN.
bool edges_hit(vec3 edges) {
    ivec3 e = floatBitsToInt(edges);
    ivec3 negated = floatBitsToInt(-edges);
    return max(e.x, max(e.y, e.z)) <= 0 || max(negated.x, max(negated.y, negated.z)) <= 0;
}

// Where the ray's line meets the triangle's plane.
float plane_hit(vec3 origin, vec3 direction, vec3 v0, vec3 v1, vec3 v2) {
    vec3 n = triangle_normal(v0, v1, v2);
    return plane_distance(n, v0, origin) / fma(n.x, direction.x, fma(n.y, direction.y, n.z * direction.z));
}

// Whether the ray's line passes through the triangle; then `t` is where (it may be infinite, where the triangle is seen
// edge-on) and `edges` its edge functions.
bool triangle_hit(Shear s, vec3 origin, vec3 direction, vec3 v0, vec3 v1, vec3 v2, out float t, out vec3 edges) {
    edges = edge_functions(project(s, origin, v0), project(s, origin, v1), project(s, origin, v2));
    t = plane_hit(origin, direction, v0, v1, v2);
    return edges_hit(edges);
}

// Two triangles that lie on the two sides of the edge from v1 to v2, with the vertices v0 and `other` opposite it: what triangle_hit says of the first, or
// of the second (v2 and v1 in that order after its own vertex), if the line passes through that alone. The bits are those of triangle_hit.
bool pair_hit(Shear s, vec3 origin, vec3 direction, vec3 v0, vec3 v1, vec3 v2, vec3 other, out float t, out vec3 edges, out bool first, out bool second) {
    vec2 a = project(s, origin, v0);
    vec2 b = project(s, origin, v1);
    vec2 c = project(s, origin, v2);
    vec2 d = project(s, origin, other);
    edges = edge_functions(a, b, c);
    vec3 beyond = edge_functions(d, c, b);
    first = edges_hit(edges);
    second = edges_hit(beyond);
    bool turned = second && !first;
    edges = turned ? beyond : edges;
    t = plane_hit(origin, direction, turned ? other : v0, turned ? v2 : v1, turned ? v1 : v2);
    return first || second;
}

// Weights of the second and third vertex. Seen exactly edge-on they are undetermined, and any will do.
vec2 barycentric(vec3 edges) {
    float sum = edges.x + edges.y + edges.z;
    return sum == 0.0 ? vec2(1.0 / 3.0) : edges.yz / sum;
}
