// The layered material of glTF 2.0 (Khronos, glTF 2.0 specification, appendix B; extensions KHR_materials_specular, _ior,
// _transmission, _volume, _clearcoat, _sheen). From the inside out: diffuse scattering or transmission, a dielectric or metallic
// reflection (GGX, correlated masking, Schlick's Fresnel), a clear coat, sheen.
//
// m.reflectance is the base colour, m.eta the index of refraction, m.alpha_u the perceptual roughness. Deviations: the clear
// coat's Fresnel factor takes the half vector, and the base is seen through the coat twice, which keeps it reciprocal; sheen
// scales what lies under it by the albedo of both directions.

float layered_alpha(float roughness) { return max(1e-3, roughness * roughness); }

vec3 layered_f0(Material m, Layered l) {
    float r = (m.eta - 1.0) / (m.eta + 1.0);
    return min(r * r * l.specular_colour, vec3(1.0)) * l.specular;
}

// Reflectance of the dielectric, whose far side is seen from inside where `inside`.
vec3 layered_fresnel(Material m, Layered l, float cos_h, bool inside) {
    float weight;
    if (inside && l.is_volume != 0u) {
        float cos2_t = 1.0 - m.eta * m.eta * (1.0 - cos_h * cos_h);
        weight = cos2_t > 0.0 ? schlick_weight(sqrt(cos2_t)) : 1.0;
    } else {
        weight = schlick_weight(abs(cos_h));
    }
    return mix(layered_f0(m, l), vec3(l.specular), weight);
}

// Charlie sheen (Estevez and Kulla 2017): distribution and a fit of its masking.
float charlie_d(float cos_h, float alpha) {
    float inverse = 1.0 / alpha;
    float sin2 = max(1.0 - cos_h * cos_h, 1e-6);
    return (2.0 + inverse) * pow(sin2, 0.5 * inverse) * (0.5 * INV_PI);
}

float charlie_fit(float x, float alpha) {
    float t = (1.0 - alpha) * (1.0 - alpha);
    float a = mix(21.5473, 25.3245, t), b = mix(3.82987, 3.32435, t), c = mix(0.19823, 0.16801, t);
    float d = mix(-1.97760, -1.27393, t), e = mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * pow(x, c)) + d * x + e;
}

float charlie_lambda(float cosine, float alpha) {
    return cosine < 0.5 ? exp(charlie_fit(cosine, alpha)) : exp(2.0 * charlie_fit(0.5, alpha) - charlie_fit(1.0 - cosine, alpha));
}

float charlie_alpha(Layered l) { return max(0.07, l.sheen_roughness * l.sheen_roughness); }

// f of the sheen of colour 1, without its cosine.
float charlie_sheen(vec3 wo, vec3 wi, float alpha) {
    float cos_h = normalize(wo + wi).z;
    float masking = 1.0 / (1.0 + charlie_lambda(wo.z, alpha) + charlie_lambda(wi.z, alpha));
    return charlie_d(cos_h, alpha) * masking / (4.0 * wo.z * wi.z);
}

// An upper bound of the sheen's albedo, for sharing light with what is under it (a fit to its integral).
float charlie_albedo(float cosine, float alpha) {
    float x = 1.0 - cosine;
    return clamp(0.05 + 0.6 * alpha * (1.0 - alpha) + (0.35 + 0.9 * alpha * (1.0 - 0.6 * alpha)) * x * x * x, 0.0, 1.0);
}

// What the sheen leaves for the layers under it.
float layered_under_sheen(Layered l, vec3 wo, vec3 wi) {
    float strongest = max(l.sheen_colour.x, max(l.sheen_colour.y, l.sheen_colour.z));
    if (strongest == 0.0) return 1.0;
    float alpha = charlie_alpha(l);
    return min(1.0 - strongest * charlie_albedo(abs(wo.z), alpha), 1.0 - strongest * charlie_albedo(abs(wi.z), alpha));
}

// Probabilities of sampling the diffuse lobe, the reflection, the transmission and the clear coat.
vec4 layered_lobes(Material m, Layered l, vec3 wo) {
    vec3 dielectric = layered_fresnel(m, l, abs(wo.z), wo.z < 0.0);
    float f = max(dielectric.x, max(dielectric.y, dielectric.z));
    float base = (1.0 - l.metallic) * (1.0 - f);
    float coat = wo.z > 0.0 ? l.clearcoat * mix(0.04, 1.0, schlick_weight(wo.z)) : 0.0;
    vec4 lobes = vec4(base * (1.0 - l.transmission), (1.0 - l.metallic) * f + l.metallic, base * l.transmission, coat);
    if (max(l.sheen_colour.x, max(l.sheen_colour.y, l.sheen_colour.z)) > 0.0) lobes.x += 0.3;
    lobes.y = max(lobes.y, 0.02);
    return lobes / (lobes.x + lobes.y + lobes.z + lobes.w);
}

// The direction from which light would have been reflected to leave as `w` does through a thin wall.
vec3 mirrored(vec3 w) { return vec3(w.xy, -w.z); }

// The half vector of a refraction, on the side of +z, or of a reflection.
vec3 layered_half(Material m, Layered l, vec3 wo, vec3 wi) {
    vec3 h;
    if (wo.z * wi.z > 0.0) h = wo + wi;
    else if (l.is_volume == 0u) h = wo + mirrored(wi);
    else h = (wo.z > 0.0 ? 1.0 : m.eta) * wo + (wi.z > 0.0 ? 1.0 : m.eta) * wi;
    h = normalize(h);
    return h.z < 0.0 ? -h : h;
}

vec3 layered_eval(Material m, Layered l, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec3(0.0);
    bool reflected = wo.z * wi.z > 0.0;
    bool front = wo.z > 0.0;
    vec2 alpha = vec2(layered_alpha(m.alpha_u));
    vec3 h = layered_half(m, l, wo, wi);
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    float cos_i = abs(wi.z);
    vec3 value = vec3(0.0);
    if (!reflected) {
        if (l.transmission == 0.0) return vec3(0.0);
        vec3 f = layered_fresnel(m, l, abs(wo_h), !front);
        vec3 through = m.reflectance * ((1.0 - l.metallic) * l.transmission) * (1.0 - max(f.x, max(f.y, f.z)));
        if (l.is_volume == 0u) {
            vec3 back = mirrored(wi);
            value = through * (ggx_d(h, alpha) * ggx_g2(wo, back, alpha, true) / (4.0 * abs(wo.z)));
        } else {
            if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return vec3(0.0);
            float eta = front ? m.eta : 1.0 / m.eta;
            float denominator = wo_h + eta * wi_h;
            value = through * (ggx_d(h, alpha) * ggx_g2(wo, wi, alpha, true) * abs(wo_h * wi_h / (wo.z * denominator * denominator)));
        }
        return value * layered_under_sheen(l, wo, wi);
    }
    vec3 f = layered_fresnel(m, l, abs(wo_h), !front);
    float shine = ggx_d(h, alpha) * ggx_g2(wo, wi, alpha, true) / (4.0 * abs(wo.z));
    vec3 metal = mix(m.reflectance, vec3(1.0), schlick_weight(abs(wo_h)));
    value = (l.metallic * metal + (1.0 - l.metallic) * f) * shine;
    if (!front && l.is_volume != 0u) return value;
    float diffuse = (1.0 - l.metallic) * (1.0 - l.transmission) * (1.0 - max(f.x, max(f.y, f.z)));
    value += m.reflectance * (diffuse * cos_i * INV_PI);
    if (l.clearcoat > 0.0) {
        vec2 coat_alpha = vec2(layered_alpha(l.clearcoat_roughness));
        float coat = l.clearcoat * mix(0.04, 1.0, schlick_weight(abs(wo_h)));
        value = value * (1.0 - coat) + vec3(coat * ggx_d(h, coat_alpha) * ggx_g2(wo, wi, coat_alpha, true) / (4.0 * abs(wo.z)));
    }
    value *= layered_under_sheen(l, wo, wi);
    vec3 up_o = vec3(wo.xy, abs(wo.z)), up_i = vec3(wi.xy, abs(wi.z));
    if (l.sheen_colour != vec3(0.0)) value += l.sheen_colour * (charlie_sheen(up_o, up_i, charlie_alpha(l)) * cos_i);
    return value;
}

float layered_pdf(Material m, Layered l, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return 0.0;
    bool reflected = wo.z * wi.z > 0.0;
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    vec2 alpha = vec2(layered_alpha(m.alpha_u));
    vec4 lobes = layered_lobes(m, l, wo);
    vec3 h = layered_half(m, l, wo, wi);
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    float visible = ggx_visible_pdf(side * wo, h, alpha);
    if (!reflected) {
        if (l.is_volume == 0u) return lobes.z * visible / (4.0 * abs(wo_h));
        if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return 0.0;
        float eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
        float denominator = wo_h / eta + wi_h;
        return lobes.z * visible * abs(wi_h) / (denominator * denominator);
    }
    float pdf = lobes.x * abs(wi.z) * INV_PI + lobes.y * visible / (4.0 * abs(wo_h));
    if (lobes.w > 0.0) pdf += lobes.w * ggx_visible_pdf(wo, h, vec2(layered_alpha(l.clearcoat_roughness))) / (4.0 * wo_h);
    return pdf;
}

BsdfSample layered_sample(Material m, Layered l, vec3 wo, vec3 u) {
    BsdfSample none = BsdfSample(wo, vec3(0.0), 0.0, false, 1.0);
    vec4 lobes = layered_lobes(m, l, wo);
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    vec3 wi;
    float eta = 1.0;
    bool through = false;
    if (u.z < lobes.x) {
        wi = side * sample_cosine_hemisphere(u.xy);
    } else {
        bool coat = u.z < lobes.x + lobes.w;
        vec2 alpha = vec2(layered_alpha(coat ? l.clearcoat_roughness : m.alpha_u));
        vec3 h = ggx_sample_visible(side * wo, alpha, u.xy) * side;
        through = u.z >= lobes.x + lobes.w + lobes.y;
        if (through && l.is_volume != 0u) {
            eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
            float cos_h = dot(wo, h);
            float cos_t;
            fresnel_dielectric(cos_h, eta, cos_t);
            if (cos_t == 0.0) return none;
            wi = -wo / eta + h * (cos_h / eta - cos_t);
        } else {
            wi = reflect(-wo, h);
            if (through) wi = mirrored(wi);
        }
    }
    if ((wi.z * wo.z < 0.0) != through) return none;
    float pdf = layered_pdf(m, l, wo, wi);
    return BsdfSample(wi, pdf > 0.0 ? layered_eval(m, l, wo, wi) / pdf : vec3(0.0), pdf, false, eta);
}
