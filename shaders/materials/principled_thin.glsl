// The thin principled BSDF (Burley 2015, "Extending the Disney BRDF to a BSDF with integrated subsurface scattering", section 5.3), with the
// conventions of Mitsuba's plugin of that name: a sheet that is met once and is the same from both sides. Light is reflected, goes straight through and
// is spread as if reflected by microfacets of a roughness that goes with the index of refraction (figure 15), and is scattered diffusely on
// either side. Light that comes from above the plane of the microfacet that passes it is dropped, as there; that is not reciprocal, so that who samples
// from the light's side says so (MATERIAL_IS_ADJOINT).
//
// m.reflectance is the base colour, m.eta the index of refraction, m.alpha_u the perceptual roughness; of Principled no metal and no clear coat.

// Roughness of what is reflected, or of what passes.
vec2 principled_thin_alpha(Material m, Principled p, bool reflected) {
    if (!reflected) m.alpha_u *= 0.65 * m.eta - 0.35;
    return principled_alpha(m, p);
}

bool principled_thin_has_broad(Material m, Principled p) {
    return p.spec_trans < 1.0 || !is_narrow(principled_thin_alpha(m, p, true)) || !is_narrow(principled_thin_alpha(m, p, false));
}

float principled_thin_passage(Principled p) { return clamp(0.5 * p.diff_trans, 0.0, 1.0); }

// Probabilities of sampling microfacets that reflect and that pass, and the diffuse lobes that do.
vec4 principled_thin_lobes(Material m, Principled p, float cosine) {
    float cos_t;
    float f = clamp(fresnel_dielectric(cosine, m.eta, cos_t), 0.1, 0.9);
    float passed = principled_thin_passage(p);
    return vec4(p.spec_trans * vec2(f, 1.0 - f), (1.0 - p.spec_trans) * vec2(1.0 - passed, passed));
}

vec3 principled_thin_eval(Material m, Principled p, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec3(0.0);
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    wo.z *= side;
    wi.z *= side;
    bool reflected = wi.z > 0.0;
    vec3 up = vec3(wi.xy, abs(wi.z));
    vec3 h = normalize(wo + up);
    float cos_h = half_cosine(wo, up);
    vec3 value = vec3(0.0);
    vec2 alpha = principled_thin_alpha(m, p, reflected);
    vec3 light = (m.flags & MATERIAL_IS_ADJOINT) != 0u ? vec3(wo.xy, -wo.z) : wi;
    if (p.spec_trans > 0.0 && (reflected || dot(light, h) < 0.0) && takes_lobes(m, is_narrow(alpha))) {
        float cos_t;
        float f = fresnel_dielectric(cos_h, m.eta, cos_t);
        float visible = p.spec_trans * ggx_d(h, alpha) * ggx_g2(wo, up, alpha, false) / (4.0 * wo.z);
        float r0 = (m.eta - 1.0) / (m.eta + 1.0);
        vec3 tinted = schlick_fresnel(principled_tint(m) * r0 * r0, cos_h, m.eta);
        value += visible * (reflected ? mix(vec3(f), tinted, p.spec_tint) : m.reflectance * (1.0 - f));
    }
    float passed = principled_thin_passage(p);
    float diffuse = (1.0 - p.spec_trans) * (reflected ? 1.0 - passed : passed);
    if (diffuse <= 0.0 || !takes_lobes(m, false)) return value;
    if (!reflected) return value + m.reflectance * (diffuse * up.z * INV_PI);
    return value + diffuse * up.z * (m.reflectance * (principled_diffuse(m, p, wo.z, up.z, cos_h) * INV_PI) + principled_sheen(m, p, cos_h));
}

float principled_thin_pdf(Material m, Principled p, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return 0.0;
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    wo.z *= side;
    wi.z *= side;
    bool reflected = wi.z > 0.0;
    vec3 h = normalize(wo + vec3(wi.xy, abs(wi.z)));
    vec4 lobes = principled_thin_lobes(m, p, wo.z);
    vec2 alpha = principled_thin_alpha(m, p, reflected);
    float pdf = 0.0;
    if (takes_lobes(m, is_narrow(alpha)))
        pdf += (reflected ? lobes.x : lobes.y) * ggx_visible_pdf(wo, h, alpha) / (4.0 * dot(wo, h));
    if (takes_lobes(m, false)) pdf += (reflected ? lobes.z : lobes.w) * abs(wi.z) * INV_PI;
    return pdf;
}

BsdfSample principled_thin_sample(Material m, Principled p, vec3 wo, vec3 u) {
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    wo.z *= side;
    vec4 lobes = principled_thin_lobes(m, p, wo.z);
    bool specular = u.z < lobes.x + lobes.y;
    bool reflected = specular ? u.z < lobes.x : u.z < lobes.x + lobes.y + lobes.z;
    bool narrow = false, valid = true;
    vec3 wi;
    if (specular) {
        vec2 alpha = principled_thin_alpha(m, p, reflected);
        narrow = is_narrow(alpha);
        vec3 h = ggx_sample_visible(wo, alpha, u.xy);
        wi = reflect(-wo, h);
        valid = wi.z > 0.0;
    } else {
        wi = sample_cosine_hemisphere(u.xy);
    }
    wi.z *= reflected ? side : -side;
    if (!valid) return bsdf_no_sample(wi);
    return bsdf_open_sample(wi, 1.0, narrow);
}
