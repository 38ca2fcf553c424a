// The layered material of glTF 2.0 (Khronos, glTF 2.0 specification, appendix B; extensions KHR_materials_specular, _ior,
// _transmission, _volume, _clearcoat, _sheen). From the inside out: diffuse scattering or transmission, a dielectric or metallic
// reflection (GGX, correlated masking, Schlick's Fresnel), a clear coat, sheen.
//
// m.reflectance is the base colour, m.eta the index of refraction, m.alpha_u the perceptual roughness. Deviations: the clear
// coat's own Fresnel factor takes the half vector; what lies under the coat or the sheen is scaled by the lesser of what they
// leave for either direction, which is reciprocal and gives back no more than it gets.

// Whether light is refracted on the way through, as at the boundary of a volume, rather than going straight on.
bool layered_refracts(Layered l) { return HAS_LAYERED_VOLUME && l.is_volume != 0u; }

float largest_channel(vec3 c) { return max(c.x, max(c.y, c.z)); }

float layered_alpha(float roughness) { return max(1e-3, roughness * roughness); }

vec3 layered_f0(Material m, Layered l) {
    float r = (m.eta - 1.0) / (m.eta + 1.0);
    return min(r * r * l.specular_colour, vec3(1.0)) * l.specular;
}

// Reflectance of the dielectric for a cosine to the half vector: on the side of the outside, or `inside` of a volume.
vec3 layered_fresnel(Material m, Layered l, float cos_h, bool inside) {
    float weight;
    if (inside) {
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

// The sheen's albedo (its integral over the hemisphere by quadrature, 3 % up so that interpolation never falls below it):
// rows by perceptual roughness from sqrt(0.07) to 1, columns by the square root of the cosine from 0 to 1.
const uint CHARLIE_COLUMNS = 9u;
const float CHARLIE_ALBEDO[72] = float[](
    1.000, 0.960, 0.699, 0.453, 0.261, 0.128, 0.048, 0.011, 0.000,
    0.870, 0.838, 0.657, 0.473, 0.317, 0.192, 0.099, 0.039, 0.005,
    0.830, 0.810, 0.661, 0.504, 0.366, 0.248, 0.150, 0.077, 0.022,
    0.847, 0.830, 0.694, 0.547, 0.416, 0.301, 0.200, 0.119, 0.050,
    0.891, 0.877, 0.742, 0.597, 0.467, 0.351, 0.246, 0.160, 0.083,
    0.943, 0.929, 0.791, 0.643, 0.512, 0.394, 0.287, 0.198, 0.116,
    0.979, 0.964, 0.823, 0.675, 0.543, 0.425, 0.317, 0.228, 0.146,
    0.971, 0.956, 0.820, 0.677, 0.550, 0.437, 0.333, 0.247, 0.169);

float charlie_albedo(float cosine, float alpha) {
    const float first = 0.264575; // sqrt(0.07)
    float row = 7.0 * (sqrt(alpha) - first) / (1.0 - first);
    float column = 8.0 * sqrt(min(cosine, 1.0));
    uint i = min(uint(max(row, 0.0)), 6u), j = min(uint(column), 7u);
    uint at = i * CHARLIE_COLUMNS + j;
    vec2 lower = mix(vec2(CHARLIE_ALBEDO[at], CHARLIE_ALBEDO[at + CHARLIE_COLUMNS]),
                     vec2(CHARLIE_ALBEDO[at + 1u], CHARLIE_ALBEDO[at + CHARLIE_COLUMNS + 1u]), column - float(j));
    return mix(lower.x, lower.y, row - float(i));
}

// What the sheen leaves for the layers under it.
float layered_under_sheen(Layered l, vec3 wo, vec3 wi) {
    float strongest = largest_channel(l.sheen_colour);
    if (!HAS_LAYERED_SHEEN || strongest == 0.0) return 1.0;
    float alpha = charlie_alpha(l);
    return min(1.0 - strongest * charlie_albedo(abs(wo.z), alpha), 1.0 - strongest * charlie_albedo(abs(wi.z), alpha));
}

// What the clear coat reflects, seen from outside under this cosine.
float layered_coat(Layered l, float cosine) { return !HAS_LAYERED_CLEARCOAT ? 0.0 : l.clearcoat * mix(0.04, 1.0, schlick_weight(abs(cosine))); }

// What the clear coat leaves for the layers under it. Inside of a volume there is no coat to cross first.
float layered_under_coat(Layered l, vec3 wo, vec3 wi) {
    bool volume = layered_refracts(l);
    float coat_o = wo.z < 0.0 && volume ? 0.0 : layered_coat(l, wo.z);
    float coat_i = wi.z < 0.0 && volume ? 0.0 : layered_coat(l, wi.z);
    return 1.0 - max(coat_o, coat_i);
}

// Probabilities of sampling the diffuse lobe (which serves the sheen too), the clear coat and the microfacets.
vec3 layered_lobes(Material m, Layered l, vec3 wo) {
    bool inside = wo.z < 0.0 && layered_refracts(l);
    if (inside) return vec3(0.0, 0.0, 1.0);
    float f = largest_channel(layered_fresnel(m, l, wo.z, false));
    // At grazing angles the half vectors that scatter diffusely reflect far less than the surface's normal says.
    float passed = (1.0 - l.metallic) * max(1.0 - f, 0.5);
    float diffuse = passed * (1.0 - l.transmission) + 0.3 * largest_channel(l.sheen_colour);
    float coat = layered_coat(l, wo.z);
    float microfacets = max(l.metallic + (1.0 - l.metallic) * f + passed * l.transmission, 0.02);
    return vec3(diffuse, coat, microfacets) / (diffuse + coat + microfacets);
}

// Probability of passing a microfacet whose dielectric reflectance is f, rather than being reflected. By the microfacet and
// not by the surface: where the surface as a whole reflects totally, some of its microfacets do not.
float layered_passage(Layered l, vec3 f) {
    if (!HAS_LAYERED_TRANSMISSION) return 0.0;
    float reflected = l.metallic + (1.0 - l.metallic) * largest_channel(f);
    float passed = (1.0 - l.metallic) * l.transmission * (1.0 - largest_channel(f));
    return passed > 0.0 ? passed / (passed + reflected) : 0.0;
}

// The direction from which light would have been reflected to leave as `w` does through a thin wall.
vec3 mirrored(vec3 w) { return vec3(w.xy, -w.z); }

// The half vector of a refraction, on the side of +z, or of a reflection.
vec3 layered_half(Material m, Layered l, vec3 wo, vec3 wi) {
    vec3 h;
    if (wo.z * wi.z > 0.0) h = wo + wi;
    else if (!layered_refracts(l)) h = wo + mirrored(wi);
    else h = (wo.z > 0.0 ? 1.0 : m.eta) * wo + (wi.z > 0.0 ? 1.0 : m.eta) * wi;
    h = normalize(h);
    return h.z < 0.0 ? -h : h;
}

vec3 layered_eval(Material m, Layered l, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec3(0.0);
    bool reflected = wo.z * wi.z > 0.0;
    if (!reflected && (!HAS_LAYERED_TRANSMISSION || l.transmission == 0.0)) return vec3(0.0);
    bool inside = wo.z < 0.0 && layered_refracts(l);
    bool refracted = !reflected && layered_refracts(l);
    vec3 h = layered_half(m, l, wo, wi);
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    if (refracted && (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0)) return vec3(0.0);
    // Straight through a thin wall, microfacets scatter light as if they reflected it.
    vec3 facing = reflected || refracted ? wi : mirrored(wi);
    // Where light is refracted, the cosine outside is known from either side.
    float cos_h = refracted ? (inside ? wi_h : wo_h) : half_cosine(wo, facing);
    vec3 f = layered_fresnel(m, l, cos_h, reflected && inside);
    vec2 alpha = vec2(layered_alpha(m.alpha_u));
    float visible = takes_lobes(m, is_narrow(alpha)) ? ggx_d(h, alpha) * ggx_g2(wo, facing, alpha, true) : 0.0;
    float cos_i = abs(wi.z);
    float under_sheen = layered_under_sheen(l, wo, wi);
    float under = layered_under_coat(l, wo, wi) * under_sheen;
    if (!reflected) {
        vec3 through = m.reflectance * ((1.0 - l.metallic) * l.transmission) * (1.0 - largest_channel(f));
        if (!refracted) return through * (visible / (4.0 * abs(wo.z))) * under;
        float near = inside ? m.eta : 1.0, far = inside ? 1.0 : m.eta;
        float denominator = (near * wo_h + far * wi_h) / near;
        return through * (visible * abs(wo_h * wi_h / (wo.z * denominator * denominator))) * under;
    }
    float shine = visible / (4.0 * abs(wo.z));
    vec3 metal = mix(m.reflectance, vec3(1.0), schlick_weight(cos_h));
    vec3 value = (l.metallic * metal + (1.0 - l.metallic) * f) * shine;
    if (inside) return value;
    float diffuse = (1.0 - l.metallic) * (1.0 - l.transmission) * (1.0 - largest_channel(f));
    if (takes_lobes(m, false)) value += m.reflectance * (diffuse * cos_i * INV_PI);
    value *= under;
    vec2 coat_alpha = vec2(layered_alpha(l.clearcoat_roughness));
    if (HAS_LAYERED_CLEARCOAT && l.clearcoat > 0.0 && takes_lobes(m, is_narrow(coat_alpha))) {
        float coat = layered_coat(l, cos_h) * under_sheen;
        value += coat * ggx_d(h, coat_alpha) * ggx_g2(wo, wi, coat_alpha, true) / (4.0 * abs(wo.z));
    }
    if (HAS_LAYERED_SHEEN && l.sheen_colour != vec3(0.0) && takes_lobes(m, false)) {
        vec3 up_o = vec3(wo.xy, abs(wo.z)), up_i = vec3(wi.xy, abs(wi.z));
        value += l.sheen_colour * (charlie_sheen(up_o, up_i, charlie_alpha(l)) * cos_i);
    }
    return value;
}

float layered_pdf(Material m, Layered l, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return 0.0;
    bool reflected = wo.z * wi.z > 0.0;
    if (!reflected && !HAS_LAYERED_TRANSMISSION) return 0.0;
    bool inside = wo.z < 0.0 && layered_refracts(l);
    vec3 up = wo.z > 0.0 ? wo : -wo; // ggx_visible_pdf takes h on the side of +z
    vec3 lobes = layered_lobes(m, l, wo);
    vec3 h = layered_half(m, l, wo, wi);
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    vec2 alpha = vec2(layered_alpha(m.alpha_u)), coat_alpha = vec2(layered_alpha(l.clearcoat_roughness));
    float visible = takes_lobes(m, is_narrow(alpha)) ? lobes.z * ggx_visible_pdf(up, h, alpha) : 0.0;
    float passage = layered_passage(l, layered_fresnel(m, l, !reflected && inside ? wi_h : wo_h, reflected && inside));
    if (!reflected) {
        if (!layered_refracts(l)) return passage * visible / (4.0 * abs(wo_h));
        if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return 0.0;
        float near = inside ? m.eta : 1.0, far = inside ? 1.0 : m.eta;
        float denominator = (near * wo_h + far * wi_h) / far;
        return passage * visible * abs(wi_h) / (denominator * denominator);
    }
    float pdf = (1.0 - passage) * visible / (4.0 * abs(wo_h));
    if (takes_lobes(m, false)) pdf += lobes.x * abs(wi.z) * INV_PI;
    if (HAS_LAYERED_CLEARCOAT && lobes.y > 0.0 && takes_lobes(m, is_narrow(coat_alpha)))
        pdf += lobes.y * ggx_visible_pdf(up, h, coat_alpha) / (4.0 * abs(wo_h));
    return pdf;
}

BsdfSample layered_sample(Material m, Layered l, vec3 wo, vec3 u) {
    BsdfSample none = bsdf_no_sample(wo);
    vec3 lobes = layered_lobes(m, l, wo);
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    bool inside = wo.z < 0.0 && layered_refracts(l);
    vec3 wi;
    float eta = 1.0;
    bool through = false, narrow = false;
    if (u.z < lobes.x) {
        wi = side * sample_cosine_hemisphere(u.xy);
    } else {
        bool coat = HAS_LAYERED_CLEARCOAT && u.z < lobes.x + lobes.y;
        vec2 alpha = vec2(layered_alpha(coat ? l.clearcoat_roughness : m.alpha_u));
        narrow = is_narrow(alpha);
        vec3 h = ggx_sample_visible(side * wo, alpha, u.xy) * side;
        float cos_h = dot(wo, h);
        through = !coat && u.z >= 1.0 - lobes.z * layered_passage(l, layered_fresnel(m, l, cos_h, inside));
        wi = reflect(-wo, h);
        if (through && !layered_refracts(l)) wi = mirrored(wi);
        if (through && layered_refracts(l)) {
            eta = wo.z > 0.0 ? m.eta : 1.0 / m.eta;
            float cos_t;
            fresnel_dielectric(cos_h, eta, cos_t);
            if (cos_t == 0.0) return none;
            wi = -wo / eta + h * (cos_h / eta - cos_t);
        }
    }
    if ((wi.z * wo.z < 0.0) != through) return none;
    return bsdf_open_sample(wi, eta, narrow);
}
