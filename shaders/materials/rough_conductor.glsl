// A rough metal: f = F D G2 / (4 cos_o cos_i) (Walter et al. 2007, equation 20). Both directions on the side of +z.

BsdfSample rough_conductor_sample(Material m, vec3 wo, vec3 u) {
    vec3 h = microfacet_sample(m, wo, u.xy);
    vec3 wi = reflect(-wo, h);
    float cos_h = dot(wo, h);
    vec3 f = m.reflectance * fresnel_conductor(cos_h, m.conductor_eta, m.conductor_k);
    float pdf = microfacet_pdf(m, wo, h) / (4.0 * cos_h);
    bool valid = wi.z > 0.0 && cos_h > 0.0;
    return bsdf_sampled(wi, valid ? f * microfacet_weight(m, wo, wi, h) : vec3(0.0), valid ? pdf : 0.0, false, 1.0);
}

vec3 rough_conductor_eval(Material m, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0) return vec3(0.0);
    vec3 h = normalize(wo + wi);
    vec3 f = m.reflectance * fresnel_conductor(half_cosine(wo, wi), m.conductor_eta, m.conductor_k);
    return f * (microfacet_d(m, h) * microfacet_g2(m, wo, wi) / (4.0 * wo.z));
}

float rough_conductor_pdf(Material m, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0) return 0.0;
    vec3 h = normalize(wo + wi);
    return microfacet_pdf(m, wo, h) / (4.0 * dot(wo, h));
}
