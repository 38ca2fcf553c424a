// A diffuse base under a smooth dielectric coating: light that enters scatters, is thrown back by the coating from inside any
// number of times, and leaves. f = (1 - F(o)) (1 - F(i)) a / (pi eta^2 (1 - a' Fi)), where Fi is the diffuse Fresnel
// reflectance from inside and a' the base's albedo a, or 1 where it keeps its colour (nonlinear = 0) (Jakob et al. 2014,
// "A comprehensive framework for rendering layered materials", section 2; the model of Mitsuba's `plastic`).

vec3 plastic_base(Material m, Plastic p) {
    vec3 thrown_back = p.nonlinear != 0u ? m.reflectance * p.internal_reflectance : vec3(p.internal_reflectance);
    return m.reflectance / ((1.0 - thrown_back) * m.eta * m.eta);
}

// Probability of sampling the coating, which reflects the share `f`.
float plastic_coating_probability(Plastic p, float f) {
    float coating = f * p.specular_weight;
    float total = coating + (1.0 - f) * (1.0 - p.specular_weight);
    return total > 0.0 ? coating / total : 1.0; // a coating that reflects nothing, met along the surface
}

BsdfSample plastic_sample(Material m, Plastic p, vec3 wo, vec3 u) {
    float cos_t;
    float f_o = fresnel_dielectric(wo.z, m.eta, cos_t);
    float coating = plastic_coating_probability(p, f_o);
    if (u.z < coating) return bsdf_sampled(vec3(-wo.xy, wo.z), p.specular * (f_o / coating), coating, true, 1.0);
    vec3 wi = sample_cosine_hemisphere(u.xy);
    float f_i = fresnel_dielectric(wi.z, m.eta, cos_t);
    return bsdf_sampled(wi, plastic_base(m, p) * ((1.0 - f_o) * (1.0 - f_i) / (1.0 - coating)), (1.0 - coating) * wi.z * INV_PI, false, 1.0);
}

vec3 plastic_eval(Material m, Plastic p, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0) return vec3(0.0);
    float cos_t;
    float through = (1.0 - fresnel_dielectric(wo.z, m.eta, cos_t)) * (1.0 - fresnel_dielectric(wi.z, m.eta, cos_t));
    return plastic_base(m, p) * (through * wi.z * INV_PI);
}

float plastic_pdf(Material m, Plastic p, vec3 wo, vec3 wi) {
    float cos_t;
    float coating = plastic_coating_probability(p, fresnel_dielectric(wo.z, m.eta, cos_t));
    return (1.0 - coating) * INV_PI * max(0.0, wi.z);
}
