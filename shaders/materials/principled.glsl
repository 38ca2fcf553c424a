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

// The clear coat's distribution (Burley 2012, equation 4), isotropic.
float gtr1_d(float cos_h, float alpha) {
    float a2 = alpha * alpha;
    return (a2 - 1.0) / (PI * log(a2) * (1.0 + (a2 - 1.0) * cos_h * cos_h));
}

float principled_coat_alpha(Principled p) { return mix(0.1, 0.001, p.clearcoat_gloss); }

// Probabilities of sampling the diffuse lobe, the reflection, the transmission and the clear coat.
vec4 principled_lobes(Material m, Principled p, vec3 wo) {
    float brdf = (1.0 - p.metallic) * (1.0 - p.spec_trans);
    float bsdf = (1.0 - p.metallic) * p.spec_trans;
    float cos_t;
    float f = fresnel_dielectric(abs(wo.z), wo.z > 0.0 ? m.eta : 1.0 / m.eta, cos_t);
    if (wo.z <= 0.0) return vec4(0.0, f, 1.0 - f, 0.0);
    vec4 lobes = vec4(brdf, 1.0 - bsdf * (1.0 - f), bsdf * (1.0 - f), 0.25 * p.clearcoat);
    return lobes / (lobes.x + lobes.y + lobes.z + lobes.w);
}

vec3 principled_eval(Material m, Principled p, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec3(0.0);
    float brdf = (1.0 - p.metallic) * (1.0 - p.spec_trans);
    float bsdf = (1.0 - p.metallic) * p.spec_trans;
    bool front = wo.z > 0.0;
    bool reflected = wo.z * wi.z > 0.0;
    float eta = front ? m.eta : 1.0 / m.eta;
    vec2 alpha = principled_alpha(m, p);
    vec3 h = normalize(wo + wi * (reflected ? 1.0 : eta));
    h = h.z < 0.0 ? -h : h;
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return vec3(0.0);
    float cos_t;
    float f = fresnel_dielectric(abs(wo_h), eta, cos_t);
    float d = ggx_d(h, alpha);
    float g = ggx_g2(wo, wi, alpha, false);
    float cos_i = abs(wi.z);
    if (!reflected) {
        if (bsdf == 0.0) return vec3(0.0);
        float denominator = wo_h + eta * wi_h;
        return sqrt(m.reflectance) * (bsdf * (1.0 - f) * d * g * abs(wo_h * wi_h / (wo.z * denominator * denominator)));
    }
    vec3 value = principled_fresnel(m, p, f, wo_h, front, bsdf) * (d * g / (4.0 * abs(wo.z)));
    if (!front) return value;
    if (p.clearcoat > 0.0) {
        vec2 coat = vec2(0.25);
        float shine = gtr1_d(h.z, principled_coat_alpha(p)) * ggx_g1(wo, coat) * ggx_g1(wi, coat) * cos_i;
        value += 0.25 * p.clearcoat * schlick_fresnel(vec3(0.04), wo_h, m.eta) * shine;
    }
    float fo = schlick_weight(abs(wo.z)), fi = schlick_weight(cos_i);
    if (brdf > 0.0) {
        float retro = 2.0 * m.alpha_u * wi_h * wi_h;
        float diffuse = (1.0 - 0.5 * fo) * (1.0 - 0.5 * fi) + retro * (fo + fi + fo * fi * (retro - 1.0));
        if (p.flatness > 0.0) {
            float ss90 = 0.5 * retro;
            float ss = mix(1.0, ss90, fo) * mix(1.0, ss90, fi);
            diffuse = mix(diffuse, 1.25 * (ss * (1.0 / (abs(wo.z) + cos_i) - 0.5) + 0.5), p.flatness);
        }
        value += m.reflectance * (brdf * diffuse * cos_i * INV_PI);
    }
    if (p.sheen > 0.0) {
        vec3 tint = p.sheen_tint > 0.0 ? mix(vec3(1.0), principled_tint(m), p.sheen_tint) : vec3(1.0);
        value += tint * (p.sheen * (1.0 - p.metallic) * schlick_weight(abs(wi_h)) * cos_i);
    }
    return value;
}

float principled_pdf(Material m, Principled p, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return 0.0;
    bool front = wo.z > 0.0;
    bool reflected = wo.z * wi.z > 0.0;
    float eta = front ? m.eta : 1.0 / m.eta;
    vec4 lobes = principled_lobes(m, p, wo);
    vec2 alpha = principled_alpha(m, p);
    vec3 h = normalize(wo + wi * (reflected ? 1.0 : eta));
    h = h.z < 0.0 ? -h : h;
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return reflected && front ? lobes.x * wi.z * INV_PI : 0.0;
    float visible = ggx_visible_pdf(front ? wo : -wo, h, alpha);
    if (!reflected) {
        float denominator = wo_h / eta + wi_h;
        return lobes.z * visible * abs(wi_h) / (denominator * denominator);
    }
    float pdf = lobes.y * visible / (4.0 * abs(wo_h));
    if (front) pdf += lobes.x * wi.z * INV_PI + lobes.w * gtr1_d(h.z, principled_coat_alpha(p)) * h.z / (4.0 * wo_h);
    return pdf;
}

BsdfSample principled_sample(Material m, Principled p, vec3 wo, vec3 u) {
    vec4 lobes = principled_lobes(m, p, wo);
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    float eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
    vec3 wi;
    float crossed = 1.0;
    if (u.z < lobes.x) {
        wi = sample_cosine_hemisphere(u.xy);
    } else if (u.z < lobes.x + lobes.w) {
        float a2 = principled_coat_alpha(p) * principled_coat_alpha(p);
        float cos2 = (1.0 - pow(a2, 1.0 - u.x)) / (1.0 - a2);
        float sine = sqrt(max(0.0, 1.0 - cos2)), phi = 2.0 * PI * u.y;
        wi = reflect(-wo, vec3(sine * cos(phi), sine * sin(phi), sqrt(max(0.0, cos2))));
    } else {
        vec3 h = ggx_sample_visible(side * wo, principled_alpha(m, p), u.xy) * side;
        float cos_h = dot(wo, h);
        float cos_t;
        fresnel_dielectric(cos_h, eta, cos_t);
        bool refracted = u.z >= lobes.x + lobes.w + lobes.y;
        if (refracted && cos_t == 0.0) return BsdfSample(wo, vec3(0.0), 0.0, false, 1.0);
        wi = refracted ? -wo / eta + h * (cos_h / eta - cos_t) : reflect(-wo, h);
        crossed = refracted ? eta : 1.0;
        if ((wi.z * wo.z < 0.0) != refracted) return BsdfSample(wo, vec3(0.0), 0.0, false, 1.0);
    }
    if (wi.z * side <= 0.0 && crossed == 1.0) return BsdfSample(wo, vec3(0.0), 0.0, false, 1.0);
    float pdf = principled_pdf(m, p, wo, wi);
    return BsdfSample(wi, pdf > 0.0 ? principled_eval(m, p, wo, wi) / pdf : vec3(0.0), pdf, false, crossed);
}
