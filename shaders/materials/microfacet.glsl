// The GGX distribution of microfacet normals and its Smith masking (Walter et al. 2007; Heitz 2014).

// Cosine between either direction of a reflection and the normal half way: the same bits with both exchanged, and free of the
// cancellation that dot(wo, h) suffers between grazing directions.
float half_cosine(vec3 wo, vec3 wi) { return 0.5 * length(wo + wi); }

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

// The same for either distribution, which the material's flags name.

bool is_correlated(Material m) { return (m.flags & MASKING_CORRELATED) != 0u; }
bool is_beckmann(Material m) { return HAS_BECKMANN && (m.flags & MICROFACET_BECKMANN) != 0u; }
vec2 roughness(Material m) { return vec2(m.alpha_u, m.alpha_v); }

float microfacet_d(Material m, vec3 h) {
    vec2 alpha = roughness(m);
    if (!is_beckmann(m)) return ggx_d(h, alpha);
    // Beckmann's distribution (Walter et al. 2007, equation 25).
    vec2 slope = h.xy / alpha;
    float cos2 = h.z * h.z;
    float falloff = exp(-dot(slope, slope) / cos2);
    return falloff > 0.0 ? falloff / (PI * alpha.x * alpha.y * cos2 * cos2) : 0.0;
}

// Share of the microfacets facing w that w sees; Beckmann's by the rational approximation of Walter et al. 2007, section 5.2.
float microfacet_g1(Material m, vec3 w) {
    vec2 alpha = roughness(m);
    if (!is_beckmann(m)) return ggx_g1(w, alpha);
    vec2 s = alpha * w.xy;
    float a = abs(w.z) / max(length(s), 1e-20);
    return a >= 1.6 ? 1.0 : (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a);
}

float microfacet_g2(Material m, vec3 wo, vec3 wi) {
    if (!is_beckmann(m)) return ggx_g2(wo, wi, roughness(m), is_correlated(m));
    return microfacet_g1(m, wo) * microfacet_g1(m, wi);
}

// A microfacet normal for wo (wo.z > 0), with density microfacet_pdf: GGX's visible ones; of Beckmann's, all.
vec3 microfacet_sample(Material m, vec3 wo, vec2 u) {
    vec2 alpha = roughness(m);
    if (!is_beckmann(m)) return ggx_sample_visible(wo, alpha, u);
    float radius = sqrt(-log(1.0 - u.x));
    float phi = 2.0 * PI * u.y;
    return normalize(vec3(-alpha * radius * vec2(cos(phi), sin(phi)), 1.0));
}

float microfacet_pdf(Material m, vec3 wo, vec3 h) {
    return is_beckmann(m) ? microfacet_d(m, h) * h.z : ggx_visible_pdf(wo, h, roughness(m));
}

// D G2 (wo.h) / (wo.z pdf) of a sampled normal: what a sample weighs besides Fresnel.
float microfacet_weight(Material m, vec3 wo, vec3 wi, vec3 h) {
    float g2 = microfacet_g2(m, wo, wi);
    return is_beckmann(m) ? g2 * abs(dot(wo, h) / (wo.z * h.z)) : g2 / microfacet_g1(m, wo);
}
