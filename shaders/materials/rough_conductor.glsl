// A rough metal: f = F D G2 / (4 cos_o cos_i) (Walter et al. 2007, equation 20). Both directions on the side of +z.

BsdfSample rough_conductor_sample(Material m, vec3 wo, vec3 u) {
    vec2 alpha = vec2(m.alpha_u, m.alpha_v);
    vec3 h = ggx_sample_visible(wo, alpha, u.xy);
    vec3 wi = reflect(-wo, h);
    float cos_h = dot(wo, h);
    vec3 f = m.reflectance * fresnel_conductor(cos_h, m.conductor_eta, m.conductor_k);
    float pdf = ggx_visible_pdf(wo, h, alpha) / (4.0 * cos_h);
    float weight = ggx_g2(wo, wi, alpha, is_correlated(m)) / ggx_g1(wo, alpha);
    bool valid = wi.z > 0.0 && cos_h > 0.0;
    return BsdfSample(wi, valid ? f * weight : vec3(0.0), valid ? pdf : 0.0, false, 1.0);
}

vec3 rough_conductor_eval(Material m, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0) return vec3(0.0);
    vec2 alpha = vec2(m.alpha_u, m.alpha_v);
    vec3 h = normalize(wo + wi);
    vec3 f = m.reflectance * fresnel_conductor(dot(wo, h), m.conductor_eta, m.conductor_k);
    return f * (ggx_d(h, alpha) * ggx_g2(wo, wi, alpha, is_correlated(m)) / (4.0 * wo.z));
}

float rough_conductor_pdf(Material m, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0) return 0.0;
    vec2 alpha = vec2(m.alpha_u, m.alpha_v);
    vec3 h = normalize(wo + wi);
    return ggx_visible_pdf(wo, h, alpha) / (4.0 * dot(wo, h));
}
