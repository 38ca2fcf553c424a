// Lambertian reflection: f = albedo / pi. Both directions lie on the side of +z.

BsdfSample diffuse_sample(Material m, vec3 wo, vec3 u) {
    vec3 wi = sample_cosine_hemisphere(u.xy);
    return bsdf_sampled(wi, m.reflectance, wi.z * INV_PI, false, 1.0);
}

vec3 diffuse_eval(Material m, vec3 wo, vec3 wi) { return m.reflectance * (INV_PI * max(0.0, wi.z)); }

float diffuse_pdf(Material m, vec3 wo, vec3 wi) { return INV_PI * max(0.0, wi.z); }
