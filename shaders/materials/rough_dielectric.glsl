// Rough glass: reflection and refraction at GGX microfacets (Walter et al. 2007, equations 20 and 21). wo may lie on
// either side; eta is the index of the side that wo does not lie on over that of the side it does.

// The microfacet normal that takes wo to wi, on the side of +z; which event it is; and the index ratio.
vec3 rough_dielectric_half(Material m, vec3 wo, vec3 wi, out bool reflected, out float eta) {
    eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
    reflected = wo.z * wi.z > 0.0;
    vec3 h = normalize(reflected ? wo + wi : wo + eta * wi);
    return h.z < 0.0 ? -h : h;
}

BsdfSample rough_dielectric_sample(Material m, vec3 wo, vec3 u) {
    vec2 alpha = vec2(m.alpha_u, m.alpha_v);
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    float eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
    vec3 h = ggx_sample_visible(side * wo, alpha, u.xy) * side;
    float cos_h = dot(wo, h);
    float cos_t;
    float f = fresnel_dielectric(cos_h, eta, cos_t);
    float normal_pdf = ggx_visible_pdf(side * wo, side * h, alpha);
    bool reflected = u.z < f;
    vec3 wi = reflected ? reflect(-wo, h) : -wo / eta + h * (cos_h / eta - cos_t);
    float wi_h = dot(wi, h);
    float jacobian = reflected ? 1.0 / (4.0 * cos_h) : eta * eta * abs(wi_h) / ((cos_h + eta * wi_h) * (cos_h + eta * wi_h));
    float masking = ggx_g2(wo, wi, alpha, is_correlated(m)) / ggx_g1(wo, alpha);
    vec3 tint = reflected ? m.reflectance : m.transmittance / (eta * eta);
    bool valid = cos_h > 0.0 && (reflected ? wi.z * wo.z > 0.0 : wi.z * wo.z < 0.0);
    float pdf = normal_pdf * jacobian * (reflected ? f : 1.0 - f);
    return BsdfSample(wi, valid ? tint * masking : vec3(0.0), valid ? pdf : 0.0, false, reflected ? 1.0 : eta);
}

vec3 rough_dielectric_eval(Material m, vec3 wo, vec3 wi) {
    vec2 alpha = vec2(m.alpha_u, m.alpha_v);
    bool reflected;
    float eta;
    vec3 h = rough_dielectric_half(m, wo, wi, reflected, eta);
    float wo_h = dot(wo, h);
    float wi_h = dot(wi, h);
    // A microfacet seen from behind carries nothing.
    if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return vec3(0.0);
    float cos_t;
    float f = fresnel_dielectric(abs(wo_h), eta, cos_t);
    float unsplit = ggx_d(h, alpha) * ggx_g2(wo, wi, alpha, is_correlated(m));
    if (reflected) return m.reflectance * (f * unsplit / (4.0 * abs(wo.z)));
    float denominator = wo_h + eta * wi_h;
    // Equation 21 with the eta^2 of importance divided out: radiance.
    return m.transmittance * ((1.0 - f) * unsplit * abs(wo_h * wi_h / (wo.z * denominator * denominator)));
}

float rough_dielectric_pdf(Material m, vec3 wo, vec3 wi) {
    vec2 alpha = vec2(m.alpha_u, m.alpha_v);
    bool reflected;
    float eta;
    vec3 h = rough_dielectric_half(m, wo, wi, reflected, eta);
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    float wo_h = dot(wo, h);
    float wi_h = dot(wi, h);
    if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return 0.0;
    float cos_t;
    float f = fresnel_dielectric(abs(wo_h), eta, cos_t);
    float normal_pdf = ggx_visible_pdf(side * wo, h, alpha);
    if (reflected) return f * normal_pdf / (4.0 * abs(wo_h));
    float denominator = wo_h + eta * wi_h;
    return (1.0 - f) * normal_pdf * eta * eta * abs(wi_h) / (denominator * denominator);
}
