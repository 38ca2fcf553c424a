// The principled BSDF (Burley 2012, "Physically based shading at Disney"; 2015, "Extending the Disney BRDF to a BSDF"), with
// the conventions of Mitsuba's plugin of that name: separable Smith masking, the exact dielectric Fresnel term where there is
// no metal and no tint, and a clear coat with the GTR1 distribution.
//
// m.reflectance is the base colour, m.eta the index of refraction, m.alpha_u the perceptual roughness.

float schlick_weight(float cosine) {
    float x = clamp(1.0 - cosine, 0.0, 1.0);
    float x2 = x * x;
    return x2 * x2 * x;
}

// Schlick's approximation for a reflectance of r0 at normal incidence on an index of eta; from the denser side by the
// refracted angle.
vec3 schlick_fresnel(vec3 r0, float cos_i, float eta) {
    bool outside = cos_i >= 0.0;
    float ratio = outside ? 1.0 / eta : eta; // of the index that the ray is in to the other
    float cos_t = sqrt(max(0.0, 1.0 - ratio * ratio * (1.0 - cos_i * cos_i)));
    return r0 + (1.0 - r0) * schlick_weight(ratio < 1.0 ? abs(cos_i) : cos_t);
}

vec2 principled_alpha(Material m, Principled p) {
    float aspect = sqrt(1.0 - 0.9 * p.anisotropic);
    float a = m.alpha_u * m.alpha_u;
    return max(vec2(0.001), vec2(a / aspect, a * aspect));
}

// The base colour at luminance one.
vec3 principled_tint(Material m) {
    float luminance = dot(m.reflectance, vec3(0.212671, 0.715160, 0.072169));
    return luminance > 0.0 ? m.reflectance / luminance : vec3(1.0);
}

vec3 principled_fresnel(Material m, Principled p, float dielectric, float cos_h, bool front, float bsdf) {
    if (!front) return vec3(bsdf * dielectric);
    float r0 = (m.eta - 1.0) / (m.eta + 1.0);
    vec3 schlick = vec3(0.0);
    if (p.metallic > 0.0) schlick += p.metallic * schlick_fresnel(m.reflectance, cos_h, m.eta);
    if (p.spec_tint > 0.0) schlick += (1.0 - p.metallic) * p.spec_tint * schlick_fresnel(principled_tint(m) * r0 * r0, cos_h, m.eta);
    return (1.0 - p.metallic) * (1.0 - p.spec_tint) * dielectric + schlick;
}

// The clear coat's distribution (Burley 2012, equation 4), isotropic. Sines and cosines apart: 1 - cos^2 would cancel where the
// coat is glossy.
float gtr1_d(vec3 h, float alpha) {
    float a2 = alpha * alpha;
    return (a2 - 1.0) / (PI * log(a2) * (dot(h.xy, h.xy) + a2 * h.z * h.z));
}

// A normal with density gtr1_d cos (equation B.2 of the same).
vec3 gtr1_sample(float alpha, vec2 u) {
    float a2 = alpha * alpha;
    float cos2 = (1.0 - pow(a2, 1.0 - u.x)) / (1.0 - a2);
    float sin2 = a2 * (pow(a2, -u.x) - 1.0) / (1.0 - a2);
    float phi = 2.0 * PI * u.y;
    return normalize(vec3(sqrt(max(0.0, sin2)) * vec2(cos(phi), sin(phi)), sqrt(max(0.0, cos2))));
}

float principled_coat_alpha(Principled p) { return mix(0.1, 0.001, p.clearcoat_gloss); }

bool principled_has_broad(Material m, Principled p) {
    bool diffuse = (1.0 - p.metallic) * (1.0 - p.spec_trans) > 0.0;
    return diffuse || !is_narrow(principled_alpha(m, p)) || p.clearcoat > 0.0 && !is_narrow(vec2(principled_coat_alpha(p)));
}

// Probabilities of sampling the diffuse lobe, the clear coat and the microfacets.
vec3 principled_lobes(Principled p, bool front) {
    if (!front) return vec3(0.0, 0.0, 1.0);
    vec3 lobes = vec3((1.0 - p.metallic) * (1.0 - p.spec_trans), 0.25 * p.clearcoat, 1.0);
    return lobes / (lobes.x + lobes.y + lobes.z);
}

// Probability of refracting at a microfacet that transmits this share. By the microfacet and not by the surface: where
// the surface as a whole reflects totally, some of its microfacets do not.
float principled_refraction(Principled p, bool front, float passed) {
    return (front ? (1.0 - p.metallic) * p.spec_trans : 1.0) * passed;
}

// The diffuse lobe, with its retro-reflection, over that of a Lambertian surface.
float principled_diffuse(Material m, Principled p, float cos_o, float cos_i, float cos_h) {
    float fo = schlick_weight(cos_o), fi = schlick_weight(cos_i);
    float retro = 2.0 * m.alpha_u * cos_h * cos_h;
    float diffuse = (1.0 - 0.5 * fo) * (1.0 - 0.5 * fi) + retro * (fo + fi + fo * fi * (retro - 1.0));
    if (p.flatness > 0.0) {
        float ss90 = 0.5 * retro;
        float ss = mix(1.0, ss90, fo) * mix(1.0, ss90, fi);
        diffuse = mix(diffuse, 1.25 * (ss * (1.0 / (cos_o + cos_i) - 0.5) + 0.5), p.flatness);
    }
    return diffuse;
}

// f of the sheen.
vec3 principled_sheen(Material m, Principled p, float cos_h) {
    vec3 tint = p.sheen_tint > 0.0 ? mix(vec3(1.0), principled_tint(m), p.sheen_tint) : vec3(1.0);
    return tint * (p.sheen * schlick_weight(cos_h));
}

vec3 principled_eval(Material m, Principled p, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec3(0.0);
    float brdf = (1.0 - p.metallic) * (1.0 - p.spec_trans);
    float bsdf = (1.0 - p.metallic) * p.spec_trans;
    bool front = wo.z > 0.0;
    Microfacet facet = rough_dielectric_facet(m, wo, wi);
    if (!facet.valid) return vec3(0.0);
    vec2 alpha = principled_alpha(m, p);
    float visible = takes_lobes(m, is_narrow(alpha)) ? ggx_d(facet.normal, alpha) * ggx_g2(wo, wi, alpha, false) : 0.0;
    if (!facet.reflected) {
        float denominator = (facet.near * facet.wo_h + facet.far * facet.wi_h) / facet.near;
        return sqrt(m.reflectance) * (bsdf * facet.passed * visible * abs(facet.wo_h * facet.wi_h / (wo.z * denominator * denominator)));
    }
    float cos_h = half_cosine(wo, wi);
    vec3 value = principled_fresnel(m, p, facet.fresnel, cos_h, front, bsdf) * (visible / (4.0 * abs(wo.z)));
    if (!front) return value;
    float cos_i = wi.z;
    if (p.clearcoat > 0.0 && takes_lobes(m, is_narrow(vec2(principled_coat_alpha(p))))) {
        vec2 coat = vec2(0.25);
        float shine = gtr1_d(facet.normal, principled_coat_alpha(p)) * ggx_g1(wo, coat) * ggx_g1(wi, coat) * cos_i;
        value += 0.25 * p.clearcoat * schlick_fresnel(vec3(0.04), cos_h, m.eta) * shine;
    }
    if (brdf > 0.0 && takes_lobes(m, false)) {
        value += m.reflectance * (brdf * principled_diffuse(m, p, wo.z, cos_i, cos_h) * cos_i * INV_PI);
        // Sheen goes with the diffuse lobe: without one, there is none.
        value += principled_sheen(m, p, cos_h) * ((1.0 - p.metallic) * cos_i);
    }
    return value;
}

float principled_pdf(Material m, Principled p, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return 0.0;
    bool front = wo.z > 0.0;
    Microfacet facet = rough_dielectric_facet(m, wo, wi);
    if (!facet.valid) return 0.0;
    vec3 lobes = principled_lobes(p, front);
    float refraction = principled_refraction(p, front, facet.passed);
    vec2 alpha = principled_alpha(m, p);
    float visible = takes_lobes(m, is_narrow(alpha)) ? lobes.z * ggx_visible_pdf(front ? wo : -wo, facet.normal, alpha) : 0.0;
    if (!facet.reflected) {
        float denominator = (facet.near * facet.wo_h + facet.far * facet.wi_h) / facet.far;
        return refraction * visible * abs(facet.wi_h) / (denominator * denominator);
    }
    float pdf = (1.0 - refraction) * visible / (4.0 * abs(facet.wo_h));
    if (front && takes_lobes(m, false)) pdf += lobes.x * wi.z * INV_PI;
    if (lobes.y > 0.0 && takes_lobes(m, is_narrow(vec2(principled_coat_alpha(p))))) pdf += lobes.y * gtr1_d(facet.normal, principled_coat_alpha(p)) * facet.normal.z / (4.0 * facet.wo_h);
    return pdf;
}

BsdfSample principled_sample(Material m, Principled p, vec3 wo, vec3 u) {
    BsdfSample none = bsdf_no_sample(wo);
    bool front = wo.z > 0.0;
    vec3 lobes = principled_lobes(p, front);
    bool refracted = false, narrow = false;
    float eta = front ? m.eta : 1.0 / m.eta;
    vec3 wi;
    if (u.z < lobes.x) {
        wi = sample_cosine_hemisphere(u.xy);
    } else if (u.z < lobes.x + lobes.y) {
        narrow = is_narrow(vec2(principled_coat_alpha(p)));
        wi = reflect(-wo, gtr1_sample(principled_coat_alpha(p), u.xy));
    } else {
        float side = front ? 1.0 : -1.0;
        vec2 alpha = principled_alpha(m, p);
        narrow = is_narrow(alpha);
        vec3 h = ggx_sample_visible(side * wo, alpha, u.xy) * side;
        float cos_h = dot(wo, h);
        float cos_t;
        float f = fresnel_dielectric(cos_h, eta, cos_t);
        refracted = u.z >= 1.0 - lobes.z * principled_refraction(p, front, 1.0 - f);
        wi = refracted ? -wo / eta + h * (cos_h / eta - cos_t) : reflect(-wo, h);
    }
    if ((wi.z * wo.z < 0.0) != refracted) return none;
    return bsdf_open_sample(wi, refracted ? eta : 1.0, narrow);
}
