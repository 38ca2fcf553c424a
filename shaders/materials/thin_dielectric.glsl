// A thin sheet of glass: reflections within it are summed, and light passes straight through (the series of the slab:
// R = 2 r / (1 + r) where nothing is absorbed).

BsdfSample thin_dielectric_sample(Material m, vec3 wo, vec3 u) {
    float cos_t;
    float r = fresnel_dielectric(abs(wo.z), m.eta, cos_t);
    r = r < 1.0 ? 2.0 * r / (1.0 + r) : r;
    bool reflected = u.z < r;
    return bsdf_sampled(reflected ? vec3(-wo.xy, wo.z) : -wo, reflected ? m.reflectance : m.transmittance, reflected ? r : 1.0 - r, true, 1.0);
}
