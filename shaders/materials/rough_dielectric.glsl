// Rough glass: reflection and refraction at GGX microfacets (Walter et al. 2007, equations 20 and 21). wo may lie on
// either side; eta is the index of the side that wo does not lie on over that of the side it does.

// How a microfacet takes wo to wi.
struct Microfacet {
    vec3 normal;    // on the side of +z
    bool reflected;
    float near;     // index of the medium that wo lies in: 1 above, the material's below
    float far;      // index of the medium that wi lies in
    float wo_h;     // cosine between wo and the normal, signed
    float wi_h;
    bool valid;     // neither direction sees the microfacet from behind
    float fresnel;  // reflected share
    float passed;   // transmitted share
};

Microfacet rough_dielectric_facet(Material m, vec3 wo, vec3 wi) {
    Microfacet f;
    f.near = wo.z > 0.0 ? 1.0 : m.eta;
    f.far = wi.z > 0.0 ? 1.0 : m.eta;
    f.reflected = wo.z * wi.z > 0.0;
    vec3 h = normalize(f.reflected ? wo + wi : f.near * wo + f.far * wi); // the same bits with wo and wi exchanged
    f.normal = h.z < 0.0 ? -h : h;
    f.wo_h = dot(wo, f.normal);
    f.wi_h = dot(wi, f.normal);
    f.valid = f.wo_h * wo.z > 0.0 && f.wi_h * wi.z > 0.0;
    float cos_t;
    // Both cosines are known where light is refracted, and near the critical angle finding one from the other cancels.
    // Where it is reflected they are the same but for rounding, to which Fresnel's equations are as sensitive there.
    float eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
    f.fresnel = f.reflected ? fresnel_dielectric(0.5 * abs(f.wo_h + f.wi_h), eta, cos_t) : fresnel_refracting(abs(f.wo_h), abs(f.wi_h), eta);
    f.passed = f.reflected ? 1.0 - f.fresnel : fresnel_transmittance(abs(f.wo_h), abs(f.wi_h), eta);
    return f;
}

BsdfSample rough_dielectric_sample(Material m, vec3 wo, vec3 u) {
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    float eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
    vec3 up = microfacet_sample(m, side * wo, u.xy);
    vec3 h = up * side;
    float cos_h = dot(wo, h);
    float cos_t;
    float f = fresnel_dielectric(cos_h, eta, cos_t);
    bool reflected = u.z < f;
    vec3 wi = reflected ? reflect(-wo, h) : -wo / eta + h * (cos_h / eta - cos_t);
    float wi_h = dot(wi, h);
    float jacobian = reflected ? 1.0 / (4.0 * cos_h) : eta * eta * abs(wi_h) / ((cos_h + eta * wi_h) * (cos_h + eta * wi_h));
    vec3 tint = reflected ? m.reflectance : m.transmittance / (eta * eta);
    bool valid = cos_h > 0.0 && (reflected ? wi.z * wo.z > 0.0 : wi.z * wo.z < 0.0);
    float pdf = microfacet_pdf(m, side * wo, up) * jacobian * (reflected ? f : 1.0 - f);
    return bsdf_sampled(wi, valid ? tint * microfacet_weight(m, wo, wi, up) : vec3(0.0), valid ? pdf : 0.0, false, reflected ? 1.0 : eta);
}

vec3 rough_dielectric_eval(Material m, vec3 wo, vec3 wi) {
    Microfacet f = rough_dielectric_facet(m, wo, wi);
    if (!f.valid) return vec3(0.0);
    float visible = microfacet_d(m, f.normal) * microfacet_g2(m, wo, wi);
    if (f.reflected) return m.reflectance * (f.fresnel * visible / (4.0 * abs(wo.z)));
    float denominator = (f.near * f.wo_h + f.far * f.wi_h) / f.near;
    return m.transmittance * (f.passed * visible * abs(f.wo_h * f.wi_h / (wo.z * denominator * denominator)));
}

float rough_dielectric_pdf(Material m, vec3 wo, vec3 wi) {
    Microfacet f = rough_dielectric_facet(m, wo, wi);
    if (!f.valid) return 0.0;
    float normal_pdf = microfacet_pdf(m, wo.z > 0.0 ? wo : -wo, f.normal);
    if (f.reflected) return f.fresnel * normal_pdf / (4.0 * abs(f.wo_h));
    float denominator = (f.near * f.wo_h + f.far * f.wi_h) / f.far;
    return f.passed * normal_pdf * abs(f.wi_h) / (denominator * denominator);
}
