// A diffuse base under a rough coating: as plastic, with the coating's transmittance from a table by cosine, which the host
// integrates (src/scene/compile/plastic.rs), and microfacets that reflect.

float rough_plastic_transmittance(Plastic p, float cosine) {
    Floats table = Floats(scene.tables);
    float at = cosine * float(PLASTIC_CELLS - 1u);
    uint cell = min(uint(at), PLASTIC_CELLS - 2u);
    return mix(table.at[p.table + cell], table.at[p.table + cell + 1u], at - float(cell));
}

bool rough_plastic_has_broad(Material m, Plastic p) { return m.reflectance != vec3(0.0) || !is_narrow(roughness(m)); }

vec3 rough_plastic_eval(Material m, Plastic p, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0) return vec3(0.0);
    vec3 h = normalize(wo + wi);
    float cos_t;
    float f = fresnel_dielectric(half_cosine(wo, wi), m.eta, cos_t);
    vec3 coating = p.specular * (f * microfacet_d(m, h) * microfacet_g2(m, wo, wi) / (4.0 * wo.z));
    if (!takes_lobes(m, is_narrow(roughness(m)))) coating = vec3(0.0);
    if (!takes_lobes(m, false)) return coating;
    float through = rough_plastic_transmittance(p, wo.z) * rough_plastic_transmittance(p, wi.z);
    return coating + plastic_base(m, p) * (through * wi.z * INV_PI);
}

float rough_plastic_pdf(Material m, Plastic p, vec3 wo, vec3 wi) {
    if (wi.z <= 0.0) return 0.0;
    float coating = plastic_coating_probability(p, 1.0 - rough_plastic_transmittance(p, wo.z));
    vec3 h = normalize(wo + wi);
    float pdf = 0.0;
    if (takes_lobes(m, is_narrow(roughness(m)))) pdf += coating * microfacet_pdf(m, wo, h) / (4.0 * dot(wo, h));
    if (takes_lobes(m, false)) pdf += (1.0 - coating) * wi.z * INV_PI;
    return pdf;
}

BsdfSample rough_plastic_sample(Material m, Plastic p, vec3 wo, vec3 u) {
    float coating = plastic_coating_probability(p, 1.0 - rough_plastic_transmittance(p, wo.z));
    bool coated = u.z < coating;
    vec3 wi = coated ? reflect(-wo, microfacet_sample(m, wo, u.xy)) : sample_cosine_hemisphere(u.xy);
    return bsdf_open_sample(wi, 1.0, coated && is_narrow(roughness(m)));
}
