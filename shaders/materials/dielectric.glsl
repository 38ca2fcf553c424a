// Smooth glass: mirror reflection with the Fresnel probability, refraction otherwise.

// Radiance is scaled by 1 / eta^2 as it enters a medium of relative index eta (Veach 1997, section 5.2).
BsdfSample dielectric_sample(Material m, vec3 wo, vec3 u) {
    float eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
    float cos_t;
    float f = fresnel_dielectric(abs(wo.z), eta, cos_t);
    if (u.z < f) return bsdf_sampled(vec3(-wo.xy, wo.z), m.reflectance, f, true, 1.0);
    vec3 wi = vec3(-wo.xy / eta, wo.z > 0.0 ? -cos_t : cos_t);
    return bsdf_sampled(wi, m.transmittance / (eta * eta), 1.0 - f, true, eta);
}
