// The layered material of glTF 2.0 (Khronos, glTF 2.0 specification, appendix B; extensions KHR_materials_specular, _ior,
// _transmission, _volume, _clearcoat, _sheen, _anisotropy, _iridescence, _diffuse_transmission, _dispersion). From the inside out: diffuse scattering or transmission, a dielectric or metallic
// reflection (GGX, correlated masking, Schlick's Fresnel), a clear coat, sheen.
//
// m.reflectance is the base colour, m.eta the index of refraction, m.alpha_u the perceptual roughness. Deviations: the clear
// coat's own Fresnel factor takes the half vector; what lies under the coat or the sheen is scaled by the lesser of what they
// leave for either direction, which is reciprocal and gives back no more than it gets.

// Whether light is refracted on the way through, as at the boundary of a volume, rather than going straight on.
bool layered_refracts(Layered l) { return HAS_LAYERED_VOLUME && l.is_volume != 0u; }

float largest_channel(vec3 c) { return max(c.x, max(c.y, c.z)); }

float layered_alpha(float roughness) { return max(1e-3, roughness * roughness); }

// The base's alpha along the direction of its anisotropy and across it (KHR_materials_anisotropy).
vec2 layered_alphas(Material m, Layered l) {
    float alpha = layered_alpha(m.alpha_u);
    return vec2(HAS_LAYERED_ANISOTROPY ? mix(alpha, 1.0, l.anisotropy * l.anisotropy) : alpha, alpha);
}

// Turns the direction of the anisotropy by the angle of another one.
void turn_anisotropy(inout Layered l, vec2 by) {
    float length2 = dot(by, by);
    if (length2 == 0.0) return;
    by *= inversesqrt(length2);
    vec2 d = l.anisotropy_direction;
    l.anisotropy_direction = vec2(by.x * d.x - by.y * d.y, by.x * d.y + by.y * d.x);
}

// A direction in the frame whose first axis is that of the anisotropy, and back (`way` -1).
vec3 layered_turned(Layered l, vec3 w, float way) {
    if (!HAS_LAYERED_ANISOTROPY) return w;
    vec2 d = vec2(l.anisotropy_direction.x, way * l.anisotropy_direction.y);
    return vec3(d.x * w.x + d.y * w.y, d.x * w.y - d.y * w.x, w.z);
}

vec3 layered_f0(Material m, Layered l) {
    float r = (m.eta - 1.0) / (m.eta + 1.0);
    return min(r * r * l.specular_colour, vec3(1.0)) * l.specular;
}

// Square of the contrast of interference under a phase, as linear sRGB, for a difference of paths in nm and phase shifts by channel (Belcour
// and Barla 2017, "A practical extension to microfacet theory for the modeling of varying iridescence", equation 18 with the fit of its
// supplement; so does KHR_materials_iridescence).
vec3 film_sensitivity(float path, vec3 shift) {
    float phase = 2.0e-9 * PI * path;
    vec3 height = vec3(5.4856e-13, 4.4201e-13, 5.2481e-13);
    vec3 centre = vec3(1.6810e6, 1.7953e6, 2.2084e6);
    vec3 variance = vec3(4.3278e9, 9.3046e9, 6.6121e9);
    vec3 xyz = height * sqrt(2.0 * PI * variance) * cos(centre * phase + shift) * exp(-phase * phase * variance);
    xyz.x += 9.7470e-14 * sqrt(2.0 * PI * 4.5282e9) * cos(2.2399e6 * phase + shift.x) * exp(-4.5282e9 * phase * phase);
    xyz /= 1.0685e-7;
    return vec3(dot(vec3(3.2404542, -1.5371385, -0.4985314), xyz), dot(vec3(-0.9692660, 1.8760108, 0.0415560), xyz),
                dot(vec3(0.0556434, -0.2040259, 1.0572252), xyz));
}

float square(float x) { return x * x; }

// Reflectance of a film over a base that reflects `base` at normal incidence, for a cosine to the half vector outside (KHR_materials_iridescence).
vec3 film_reflectance(Layered l, float cosine, vec3 base) {
    // A film that vanishes takes the outside's index with it.
    float film = mix(1.0, l.iridescence_eta, smoothstep(0.0, 0.03, l.iridescence_thickness));
    float cos2_film = 1.0 - (1.0 - cosine * cosine) / (film * film);
    if (cos2_film < 0.0) return vec3(1.0);
    float cos_film = sqrt(cos2_film);
    float first = mix(square((film - 1.0) / (film + 1.0)), 1.0, schlick_weight(cosine));
    float passed = 1.0 - first;
    vec3 root = sqrt(clamp(base, 0.0, 0.9999));
    vec3 eta = (1.0 + root) / (1.0 - root);
    vec3 ratio = (eta - film) / (eta + film);
    vec3 second = mix(ratio * ratio, vec3(1.0), schlick_weight(cos_film));
    vec3 shift = vec3(film < 1.0 ? 0.0 : PI) + vec3(eta.x < film ? PI : 0.0, eta.y < film ? PI : 0.0, eta.z < film ? PI : 0.0);
    float path = 2.0 * film * l.iridescence_thickness * cos_film;
    vec3 both = clamp(first * second, 1e-5, 0.9999);
    vec3 share = passed * passed * second / (1.0 - both);
    vec3 reflected = first + share;
    vec3 term = share - passed;
    for (int order = 1; order <= 2; order++) {
        term *= sqrt(both);
        reflected += term * (2.0 * film_sensitivity(float(order) * path, float(order) * shift));
    }
    return clamp(reflected, 0.0, 1.0);
}

// A reflectance of a base that reflects `base` at normal incidence, with the film over it.
vec3 layered_with_film(Layered l, vec3 reflectance, vec3 base, float cos_h) {
    if (!HAS_LAYERED_IRIDESCENCE || l.iridescence == 0.0) return reflectance;
    return mix(reflectance, film_reflectance(l, abs(cos_h), base), l.iridescence);
}

// Reflectance of the dielectric for a cosine to the half vector: on the side of the outside, or `inside` of a volume.
vec3 layered_fresnel(Material m, Layered l, float cos_h, bool inside) {
    float cos_outside = abs(cos_h);
    bool passes = true;
    if (inside) {
        float cos2_t = 1.0 - m.eta * m.eta * (1.0 - cos_h * cos_h);
        passes = cos2_t > 0.0;
        cos_outside = passes ? sqrt(cos2_t) : 0.0;
    }
    vec3 f0 = layered_f0(m, l);
    vec3 f = mix(f0, vec3(l.specular), schlick_weight(cos_outside));
    return passes ? layered_with_film(l, f, f0, cos_outside) : f;
}

// Reflectance of the metal.
vec3 layered_metal(Material m, Layered l, float cos_h) {
    return layered_with_film(l, mix(m.reflectance, vec3(1.0), schlick_weight(cos_h)), m.reflectance, cos_h);
}

// Share of the diffuse light that comes out on the other side.
float layered_diffuse_passage(Layered l) { return HAS_LAYERED_DIFFUSE_TRANSMISSION ? l.diffuse_transmission : 0.0; }

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

// A direction in the frame of the clear coat's normal, and back.
vec3 coat_local(Layered l, vec3 w) { return HAS_COAT_NORMALS ? to_local(basis_from_normal(l.clearcoat_normal), w) : w; }
vec3 coat_back(Layered l, vec3 w) { return HAS_COAT_NORMALS ? to_world(basis_from_normal(l.clearcoat_normal), w) : w; }

// Whether the coat is seen from the side that the surface is.
bool coat_faces(Layered l, vec3 w) { return !HAS_COAT_NORMALS || dot(l.clearcoat_normal, w) * w.z > 0.0; }

// f |cos_i| of a coat of reflectance 1. Where its normal is another than the surface's, each cosine is the larger one of both: the same both ways, and no more than
// the coat alone would give back.
float layered_coat_lobe(Layered l, vec3 wo, vec3 wi) {
    if (!coat_faces(l, wo) || !coat_faces(l, wi)) return 0.0;
    vec3 co = coat_local(l, wo), ci = coat_local(l, wi);
    vec3 h = normalize(co + ci);
    vec2 alpha = vec2(layered_alpha(l.clearcoat_roughness));
    float lobe = ggx_d(h.z < 0.0 ? -h : h, alpha) * ggx_g2(co, ci, alpha, true) * 0.25;
    if (!HAS_COAT_NORMALS) return lobe / abs(wo.z);
    return lobe * abs(wi.z) / (max(abs(co.z), abs(wo.z)) * max(abs(ci.z), abs(wi.z)));
}

// Its density where it is sampled.
float layered_coat_pdf(Layered l, vec3 wo, vec3 wi) {
    if (!coat_faces(l, wi)) return 0.0;
    vec3 co = coat_local(l, wo);
    vec3 h = normalize(co + coat_local(l, wi));
    vec3 up = co.z > 0.0 ? co : -co;
    return ggx_visible_pdf(up, h.z < 0.0 ? -h : h, vec2(layered_alpha(l.clearcoat_roughness))) / (4.0 * abs(dot(co, h)));
}

// What the clear coat leaves for the layers under it. Inside of a volume there is no coat to cross first.
float layered_under_coat(Layered l, vec3 wo, vec3 wi) {
    bool volume = layered_refracts(l);
    float coat_o = wo.z < 0.0 && volume ? 0.0 : layered_coat(l, coat_local(l, wo).z);
    float coat_i = wi.z < 0.0 && volume ? 0.0 : layered_coat(l, coat_local(l, wi).z);
    return 1.0 - max(coat_o, coat_i);
}

bool layered_has_broad(Material m, Layered l) {
    if ((1.0 - l.metallic) * (1.0 - l.transmission) > 0.0 || !is_narrow(layered_alphas(m, l))) return true;
    if (HAS_LAYERED_SHEEN && l.sheen_colour != vec3(0.0)) return true;
    return HAS_LAYERED_CLEARCOAT && l.clearcoat > 0.0 && !is_narrow(vec2(layered_alpha(l.clearcoat_roughness)));
}

// Probabilities of sampling the diffuse lobe (which serves the sheen too), the clear coat and the microfacets.
vec3 layered_lobes(Material m, Layered l, vec3 wo) {
    bool inside = wo.z < 0.0 && layered_refracts(l);
    if (inside && layered_diffuse_passage(l) == 0.0) return vec3(0.0, 0.0, 1.0);
    float f = largest_channel(layered_fresnel(m, l, wo.z, inside));
    // At grazing angles the half vectors that scatter diffusely reflect far less than the surface's normal says.
    float passed = (1.0 - l.metallic) * max(1.0 - f, 0.5);
    float diffuse = passed * (1.0 - l.transmission) + (inside ? 0.0 : 0.3 * largest_channel(l.sheen_colour));
    float coat = inside || !coat_faces(l, wo) ? 0.0 : layered_coat(l, coat_local(l, wo).z);
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

// f |cos_i| at the material's one index of refraction.
vec3 layered_eval_at(Material m, Layered l, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec3(0.0);
    bool reflected = wo.z * wi.z > 0.0;
    float diffuse_passage = layered_diffuse_passage(l);
    bool transmits = HAS_LAYERED_TRANSMISSION && l.transmission > 0.0;
    if (!reflected && !transmits && diffuse_passage == 0.0) return vec3(0.0);
    wo = layered_turned(l, wo, 1.0);
    wi = layered_turned(l, wi, 1.0);
    if (HAS_COAT_NORMALS) l.clearcoat_normal = layered_turned(l, l.clearcoat_normal, 1.0);
    bool inside = wo.z < 0.0 && layered_refracts(l);
    bool refracted = !reflected && layered_refracts(l);
    float cos_i = abs(wi.z);
    float under_sheen = layered_under_sheen(l, wo, wi);
    float under = layered_under_coat(l, wo, wi) * under_sheen;
    vec3 value = vec3(0.0);
    if (!reflected && diffuse_passage > 0.0 && takes_lobes(m, false)) {
        // What is not reflected, as through a thin wall: the same both ways.
        float passed = 1.0 - largest_channel(layered_fresnel(m, l, half_cosine(wo, mirrored(wi)), false));
        float share = (1.0 - l.metallic) * (1.0 - l.transmission) * diffuse_passage * passed;
        value = l.diffuse_transmission_colour * (share * cos_i * INV_PI * under);
    }
    if (!reflected && !transmits) return value;
    vec3 h = layered_half(m, l, wo, wi);
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    if (refracted && (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0)) return value;
    // Straight through a thin wall, microfacets scatter light as if they reflected it.
    vec3 facing = reflected || refracted ? wi : mirrored(wi);
    // Where light is refracted, the cosine outside is known from either side.
    float cos_h = refracted ? (inside ? wi_h : wo_h) : half_cosine(wo, facing);
    vec3 f = layered_fresnel(m, l, cos_h, reflected && inside);
    vec2 alpha = layered_alphas(m, l);
    float visible = takes_lobes(m, is_narrow(alpha)) ? ggx_d(h, alpha) * ggx_g2(wo, facing, alpha, true) : 0.0;
    if (!reflected) {
        vec3 through = m.reflectance * ((1.0 - l.metallic) * l.transmission) * (1.0 - largest_channel(f));
        if (!refracted) return value + through * (visible / (4.0 * abs(wo.z))) * under;
        float near = inside ? m.eta : 1.0, far = inside ? 1.0 : m.eta;
        float denominator = (near * wo_h + far * wi_h) / near;
        return value + through * (visible * abs(wo_h * wi_h / (wo.z * denominator * denominator))) * under;
    }
    float shine = visible / (4.0 * abs(wo.z));
    value = (l.metallic * layered_metal(m, l, cos_h) + (1.0 - l.metallic) * f) * shine;
    float diffuse = (1.0 - l.metallic) * (1.0 - l.transmission) * (1.0 - largest_channel(f));
    if (HAS_LAYERED_DIFFUSE_TRANSMISSION) diffuse *= 1.0 - diffuse_passage;
    if (!takes_lobes(m, false)) diffuse = 0.0;
    if (inside) return diffuse_passage > 0.0 ? value + m.reflectance * (diffuse * cos_i * INV_PI) : value;
    value += m.reflectance * (diffuse * cos_i * INV_PI);
    value *= under;
    bool takes_coat = takes_lobes(m, is_narrow(vec2(layered_alpha(l.clearcoat_roughness))));
    if (HAS_LAYERED_CLEARCOAT && l.clearcoat > 0.0 && takes_coat) value += layered_coat(l, cos_h) * under_sheen * layered_coat_lobe(l, wo, wi);
    if (HAS_LAYERED_SHEEN && l.sheen_colour != vec3(0.0) && takes_lobes(m, false)) {
        vec3 up_o = vec3(wo.xy, abs(wo.z)), up_i = vec3(wi.xy, abs(wi.z));
        value += l.sheen_colour * (charlie_sheen(up_o, up_i, charlie_alpha(l)) * cos_i);
    }
    return value;
}

float layered_pdf_at(Material m, Layered l, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return 0.0;
    bool reflected = wo.z * wi.z > 0.0;
    float diffuse_passage = layered_diffuse_passage(l);
    if (!reflected && !HAS_LAYERED_TRANSMISSION && diffuse_passage == 0.0) return 0.0;
    wo = layered_turned(l, wo, 1.0);
    wi = layered_turned(l, wi, 1.0);
    if (HAS_COAT_NORMALS) l.clearcoat_normal = layered_turned(l, l.clearcoat_normal, 1.0);
    bool inside = wo.z < 0.0 && layered_refracts(l);
    vec3 up = wo.z > 0.0 ? wo : -wo; // ggx_visible_pdf takes h on the side of +z
    vec3 lobes = layered_lobes(m, l, wo);
    float pdf = 0.0;
    if (takes_lobes(m, false)) pdf = lobes.x * abs(wi.z) * INV_PI;
    if (HAS_LAYERED_DIFFUSE_TRANSMISSION) pdf *= reflected ? 1.0 - diffuse_passage : diffuse_passage;
    else if (!reflected) pdf = 0.0;
    vec3 h = layered_half(m, l, wo, wi);
    float wo_h = dot(wo, h), wi_h = dot(wi, h);
    vec2 alpha = layered_alphas(m, l);
    float visible = takes_lobes(m, is_narrow(alpha)) ? lobes.z * ggx_visible_pdf(up, h, alpha) : 0.0;
    float passage = layered_passage(l, layered_fresnel(m, l, !reflected && inside ? wi_h : wo_h, reflected && inside));
    if (!reflected) {
        if (!HAS_LAYERED_TRANSMISSION) return pdf;
        if (!layered_refracts(l)) return pdf + passage * visible / (4.0 * abs(wo_h));
        if (wo_h * wo.z <= 0.0 || wi_h * wi.z <= 0.0) return pdf;
        float near = inside ? m.eta : 1.0, far = inside ? 1.0 : m.eta;
        float denominator = (near * wo_h + far * wi_h) / far;
        return pdf + passage * visible * abs(wi_h) / (denominator * denominator);
    }
    pdf += (1.0 - passage) * visible / (4.0 * abs(wo_h));
    bool takes_coat = takes_lobes(m, is_narrow(vec2(layered_alpha(l.clearcoat_roughness))));
    if (HAS_LAYERED_CLEARCOAT && lobes.y > 0.0 && takes_coat) pdf += lobes.y * layered_coat_pdf(l, wo, wi);
    return pdf;
}

// The index of refraction of red, green or blue (KHR_materials_dispersion: spread by (eta - 1) / 40 for each unit of dispersion).
float layered_eta(Material m, Layered l, uint channel) {
    float spread = (m.eta - 1.0) * 0.025 * l.dispersion;
    return max(1.001, m.eta + (float(channel) - 1.0) * spread);
}

// Where it disperses, each channel has an index of its own: a sample takes that of one, by chance, and its density is the mean of theirs.
vec3 layered_eval(Material m, Layered l, vec3 wo, vec3 wi) {
    if (!HAS_LAYERED_DISPERSION) return layered_eval_at(m, l, wo, wi);
    vec3 value = vec3(0.0);
    for (uint channel = 0u; channel < turns(3u); channel++) {
        Material own = m;
        own.eta = layered_eta(m, l, channel);
        value[channel] = layered_eval_at(own, l, wo, wi)[channel];
    }
    return value;
}

float layered_pdf(Material m, Layered l, vec3 wo, vec3 wi) {
    if (!HAS_LAYERED_DISPERSION) return layered_pdf_at(m, l, wo, wi);
    float pdf = 0.0;
    for (uint channel = 0u; channel < turns(3u); channel++) {
        Material own = m;
        own.eta = layered_eta(m, l, channel);
        pdf += layered_pdf_at(own, l, wo, wi) * (1.0 / 3.0);
    }
    return pdf;
}

BsdfSample layered_sample(Material m, Layered l, vec3 wo, vec3 u) {
    BsdfSample none = bsdf_no_sample(wo);
    if (HAS_LAYERED_DISPERSION) {
        uint channel = min(uint(3.0 * u.z), 2u);
        u.z = min(3.0 * u.z - float(channel), 0.99999994);
        m.eta = layered_eta(m, l, channel);
    }
    wo = layered_turned(l, wo, 1.0);
    if (HAS_COAT_NORMALS) l.clearcoat_normal = layered_turned(l, l.clearcoat_normal, 1.0);
    vec3 lobes = layered_lobes(m, l, wo);
    float side = wo.z > 0.0 ? 1.0 : -1.0;
    bool inside = wo.z < 0.0 && layered_refracts(l);
    vec3 wi;
    float eta = 1.0;
    bool through = false, narrow = false;
    if (u.z < lobes.x) {
        through = u.z < lobes.x * layered_diffuse_passage(l);
        wi = (through ? -side : side) * sample_cosine_hemisphere(u.xy);
    } else {
        bool coat = HAS_LAYERED_CLEARCOAT && u.z < lobes.x + lobes.y;
        vec2 alpha = coat ? vec2(layered_alpha(l.clearcoat_roughness)) : layered_alphas(m, l);
        narrow = is_narrow(alpha);
        vec3 h = side * ggx_sample_visible(side * (coat ? coat_local(l, wo) : wo), alpha, u.xy);
        if (coat) h = coat_back(l, h);
        float cos_h = dot(wo, h);
        through = !coat && u.z >= 1.0 - lobes.z * layered_passage(l, layered_fresnel(m, l, cos_h, inside));
        wi = reflect(-wo, h);
        if (coat && !coat_faces(l, wi)) return none;
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
    return bsdf_open_sample(layered_turned(l, wi, -1.0), eta, narrow);
}
