// Maps from the unit square to the shapes that integrators sample, each with its density.

// A point uniform on the unit disk (Shirley and Chiu 1997).
vec2 sample_disk(vec2 u) {
    vec2 s = 2.0 * u - 1.0;
    bool wide = abs(s.x) > abs(s.y);
    float r = wide ? s.x : s.y;
    float ratio = r == 0.0 ? 0.0 : (wide ? s.y / s.x : s.x / s.y);
    float phi = wide ? 0.25 * PI * ratio : 0.5 * PI - 0.25 * PI * ratio;
    return r * vec2(cos(phi), sin(phi));
}

// A direction around +z with pdf_w = cos(theta) / pi.
vec3 sample_cosine_hemisphere(vec2 u) {
    vec2 d = sample_disk(u);
    return vec3(d, sqrt(max(0.0, 1.0 - dot(d, d))));
}

// A direction uniform on the sphere, pdf_w = 1 / (4 pi).
vec3 sample_sphere(vec2 u) {
    float z = 1.0 - 2.0 * u.x;
    float r = 2.0 * sqrt(max(0.0, u.x * (1.0 - u.x)));
    float phi = 2.0 * PI * u.y;
    return vec3(r * cos(phi), r * sin(phi), z);
}

// Barycentric weights of the second and third vertex, uniform over a triangle's area (Heitz 2019, a low-distortion map).
vec2 sample_triangle(vec2 u) {
    vec2 b = u.y > u.x ? vec2(0.5 * u.x, u.y - 0.5 * u.x) : vec2(u.x - 0.5 * u.y, 0.5 * u.y);
    return b;
}

// Weight of the first of two techniques, each with one sample (Veach 1997, section 9.2.3), the power heuristic with
// exponent 2. Written so that densities up to the largest float neither overflow nor cancel.
float power_heuristic(float pdf, float other) {
    float ratio = other / pdf;
    return pdf > 0.0 ? 1.0 / (1.0 + ratio * ratio) : 0.0;
}
