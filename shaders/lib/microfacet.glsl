// The GGX distribution of microfacet normals and its Smith masking (Walter et al. 2007; Heitz 2014).

// Density of microfacet normals, per projected area of the surface: D(m), 1/sr. The quotient is formed from ratios that
// stay near one, so alpha down to 1e-5 neither overflows nor cancels.
float ggx_d(vec3 m, vec2 alpha) {
    vec2 slope = m.xy / alpha;
    float e = dot(slope, slope) + m.z * m.z;
    return 1.0 / (PI * alpha.x * alpha.y * e * e);
}

// Smith's auxiliary function: the ratio of masked to visible area seen from w.
float ggx_lambda(vec3 w, vec2 alpha) {
    vec2 s = alpha * w.xy;
    return 0.5 * (sqrt(1.0 + dot(s, s) / (w.z * w.z)) - 1.0);
}

// Share of the microfacets facing w that w sees.
float ggx_g1(vec3 w, vec2 alpha) { return 1.0 / (1.0 + ggx_lambda(w, alpha)); }

// Share seen from both directions: height-correlated (Heitz 2014, equation 99), or the product of both (equation 98),
// which is what Mitsuba's materials mean.
float ggx_g2(vec3 wo, vec3 wi, vec2 alpha, bool correlated) {
    float lambda_o = ggx_lambda(wo, alpha);
    float lambda_i = ggx_lambda(wi, alpha);
    return correlated ? 1.0 / (1.0 + lambda_o + lambda_i) : 1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i));
}

// A normal out of those visible from wo (wo.z > 0), with density ggx_visible_pdf
// (Dupuy and Benyoub 2023, "Sampling visible GGX normals with spherical caps").
vec3 ggx_sample_visible(vec3 wo, vec2 alpha, vec2 u) {
    vec3 w = normalize(vec3(alpha * wo.xy, wo.z));
    float phi = 2.0 * PI * u.x;
    float z = fma(1.0 - u.y, 1.0 + w.z, -w.z);
    float r = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    vec3 h = vec3(r * cos(phi), r * sin(phi), z) + w;
    return normalize(vec3(alpha * h.xy, max(h.z, 1e-12)));
}

// Its density over solid angle of the normal: G1(wo) (wo.m) D(m) / wo.z.
float ggx_visible_pdf(vec3 wo, vec3 m, vec2 alpha) {
    return ggx_g1(wo, alpha) * max(0.0, dot(wo, m)) * ggx_d(m, alpha) / wo.z;
}
