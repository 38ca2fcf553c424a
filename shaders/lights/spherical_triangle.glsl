// A triangle by the solid angle under which it is seen: the weight of a sample varies with the radiance only, and not with
// distance and inclination, which for close triangles vary without bound.

// Solid angles below this one are sampled by area: inclination and distance hardly vary, and differences of unit vectors lose
// their digits.
const float LEAST_SOLID_ANGLE = 1e-3;

// Solid angle of the triangle seen from p, which must lie on the side that `scaled_normal` = (v1 - v0) x (v2 - v0) points to; 0
// elsewhere (van Oosterom and Strackee 1983). The triple product by the edges, not by the vertices: far away those cancel.
float triangle_solid_angle(vec3 scaled_normal, vec3 v0, vec3 v1, vec3 v2, vec3 p) {
    vec3 a = v0 - p, b = v1 - p, c = v2 - p;
    float la = length(a), lb = length(b), lc = length(c);
    float volume = -dot(scaled_normal, a);
    float sum = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return volume > 0.0 ? 2.0 * angle_of(volume, sum) : 0.0;
}

// Barycentric weights of the second and third vertex, uniform over that solid angle (Peters 2021, "BRDF importance sampling for
// polygonal lights", section 4, a form of Arvo 1995 without inverse trigonometric functions).
vec2 sample_spherical_triangle(float solid_angle, vec3 scaled_normal, vec3 v0, vec3 v1, vec3 v2, vec3 p, vec2 u) {
    vec3 a = normalize(v0 - p), b = normalize(v1 - p), c = normalize(v2 - p);
    float volume = dot(scaled_normal, p - v0) / (distance(v0, p) * distance(v1, p) * distance(v2, p));
    // A vertex d on the edge from a to c that cuts off the share u.x, seen from b. `half_way` lies between a and d.
    float cut = 0.5 * u.x * solid_angle;
    vec3 half_way = (volume * cos(cut) - dot(a + b, c) * sin(cut)) * a + ((1.0 + dot(a, b)) * sin(cut)) * c;
    vec3 d = half_way * (2.0 * dot(a, half_way) / dot(half_way, half_way)) - a;
    // A direction on the arc from b to d, whose cosine to b is uniform: 1 - cosine, without cancellation.
    vec3 chord = d - b;
    float width = 0.5 * dot(chord, chord);
    float lowered = u.y * width;
    vec3 across = chord + width * b; // d without its part along b
    float length2 = dot(across, across);
    vec3 w = (1.0 - lowered) * b + across * (length2 > 0.0 ? sqrt(lowered * (2.0 - lowered) / length2) : 0.0);
    // Where it meets the triangle.
    vec3 e1 = v1 - v0, e2 = v2 - v0, s = p - v0;
    vec3 h = cross(w, e2);
    vec2 weights = vec2(dot(s, h), dot(w, cross(s, e1))) / dot(e1, h);
    weights = clamp(weights, 0.0, 1.0);
    return weights / max(1.0, weights.x + weights.y);
}
