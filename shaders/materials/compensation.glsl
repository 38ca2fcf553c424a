// What rough metals and rough glass lose because their models follow light through one scattering among microfacets only
// comes back as a second lobe (Kulla and Conty 2017, "Revisiting physically based shading at Imageworks"; for one interface with
// F = 1, Kelemen and Szirmay-Kalos 2001). M(w) is the share of light from w that one scattering loses when no facet absorbs, m_x its
// cosine-weighted mean on side x of the surface; both come from tables that the host integrates (src/scene/compile/compensation.rs).
//
// A metal: f = S M(wo) M(wi) / (pi m), S = F^2 (1 - m) / (1 - F m), the series of what escapes after two reflections, three, and so
// on, by the mean Fresnel reflectance F. With F = 1 the integral of f |cos_i| is M(wo), which is what was lost.
//
// Glass, wo on side o and wi on side i: of what is lost on side o the share t_o leaves on the other side, the rest on the
// same one. Reflected, f = (1 - t_o) M(wo) M(wi) / (pi m_o). Passed, f = t_i M(wo) M(wi) / (pi m_o): all that light from wi loses,
// M(wi), leaves in the share t_i with density M(wo) / (pi m_o). Reciprocity, f(wi, wo) / n_o^2 = f(wo, wi) / n_i^2 with the indices
// n, asks for t_i m_i n_i^2 = t_o m_o n_o^2. T_x = 1 - F_x, the mean transmittance of a smooth boundary from side x, has
// T_i n_i^2 = T_o n_o^2, so t_o = T_o m_i / (m_o + m_i) is a choice that does it, and f = T_i M(wo) M(wi) / (pi (m_o + m_i)) holds the
// 1 / eta^2 that radiance scales with.

bool is_compensated(Material m) { return HAS_ENERGY_COMPENSATION && (m.flags & MATERIAL_IS_COMPENSATED) != 0u; }
bool is_glass(Material m) { return m.kind == MATERIAL_ROUGH_DIELECTRIC; }

// A row of the table: between which two, and where it begins in the float tables on the side of w.
struct MissingRow {
    uint first;  // its mean; COMPENSATION_CELLS values follow
    uint step;   // to the next row; 0 where there is one
    float share; // of the next row
};

MissingRow missing_row(Material m, Compensation c, vec3 w) {
    uint sides = is_glass(m) ? 2u : 1u;
    uint line = COMPENSATION_CELLS + 1u;
    uint first = c.table + (is_glass(m) && w.z < 0.0 ? line : 0u);
    if (c.rows == 1u) return MissingRow(first, 0u, 0.0);
    float across2 = w.y * w.y, along2 = w.x * w.x;
    float at = c.alpha > 0.0 ? sqrt(sqrt(m.alpha_u * m.alpha_v) / c.alpha) : across2 / max(across2 + along2, 1e-30);
    at = clamp(at, 0.0, 1.0) * float(c.rows - 1u);
    uint row = min(uint(at), c.rows - 2u);
    return MissingRow(first + row * sides * line, sides * line, at - float(row));
}

float missing_entry(MissingRow row, uint index) {
    Floats table = Floats(scene.tables);
    float value = table.at[row.first + index];
    return row.step == 0u ? value : mix(value, table.at[row.first + row.step + index], row.share);
}

float missing_mean(Material m, Compensation c, vec3 w) { return max(missing_entry(missing_row(m, c, w), 0u), 1e-20); }

float missing_share(Material m, Compensation c, vec3 w) {
    MissingRow row = missing_row(m, c, w);
    float at = sqrt(min(abs(w.z), 1.0)) * float(COMPENSATION_CELLS - 1u);
    uint cell = min(uint(at), COMPENSATION_CELLS - 2u);
    return mix(missing_entry(row, 1u + cell), missing_entry(row, 2u + cell), at - float(cell));
}

// Of what a metal loses when no facet absorbs, the share that escapes in the end.
vec3 compensation_series(Material m, Compensation c, float mean) {
    vec3 f = m.reflectance * c.mean_fresnel;
    return f * f * (1.0 - mean) / (1.0 - f * mean);
}

// Mean transmittance of the smooth boundary from the side of w.
float compensation_transmittance(Material m, Compensation c, vec3 w) {
    float outside = 1.0 - c.mean_fresnel.x;
    return w.z > 0.0 ? outside : outside / (m.eta * m.eta);
}

// Of what is lost on the side of wo, the share that leaves on the other side.
float compensation_passage(Material m, Compensation c, vec3 wo) {
    if (!is_glass(m)) return 0.0;
    float far = missing_mean(m, c, -wo);
    return compensation_transmittance(m, c, wo) * far / (missing_mean(m, c, wo) + far);
}

// f |cos_i| of the second lobe.
vec3 compensation_eval(Material m, Compensation c, vec3 wo, vec3 wi) {
    bool reflected = wo.z * wi.z > 0.0;
    if (!reflected && !is_glass(m)) return vec3(0.0);
    float near = missing_mean(m, c, wo);
    float lobe = missing_share(m, c, wo) * missing_share(m, c, wi) * abs(wi.z) * INV_PI;
    if (!is_glass(m)) return compensation_series(m, c, near) * (lobe / near);
    if (reflected) return m.reflectance * ((1.0 - compensation_passage(m, c, wo)) * lobe / near);
    return m.transmittance * (compensation_transmittance(m, c, wi) * lobe / (near + missing_mean(m, c, wi)));
}

// Directions of the second lobe, by their cosine z with density proportional to z / (z^2 + a^2): as M falls off, which is about
// 1 / (1 + (z / a)^2), where a cosine lobe would find the grazing angles too seldom when the roughness a is small.
float compensation_cosine(Material m, float u) {
    float a2 = 0.25 * (m.alpha_u + m.alpha_v) * (m.alpha_u + m.alpha_v);
    return min(sqrt(a2 * (exp(u * log(1.0 + 1.0 / a2)) - 1.0)), 1.0);
}

float compensation_lobe_pdf(Material m, float cosine) {
    float a2 = 0.25 * (m.alpha_u + m.alpha_v) * (m.alpha_u + m.alpha_v);
    return cosine * INV_PI / ((cosine * cosine + a2) * log(1.0 + 1.0 / a2));
}

// Density over solid angle of wi, once the second lobe is chosen.
float compensation_pdf(Material m, Compensation c, vec3 wo, vec3 wi) {
    float passage = compensation_passage(m, c, wo);
    return (wo.z * wi.z > 0.0 ? 1.0 - passage : passage) * compensation_lobe_pdf(m, abs(wi.z));
}

// Probability of choosing it: about its share of the light that comes from wo.
float compensation_probability(Material m, Compensation c, vec3 wo) {
    float missing = min(missing_share(m, c, wo), 0.999);
    if (is_glass(m)) return missing;
    vec3 f = m.reflectance * c.mean_fresnel;
    vec3 series = compensation_series(m, c, missing_mean(m, c, wo));
    float lobe = missing * max(series.x, max(series.y, series.z));
    float total = lobe + (1.0 - missing) * max(f.x, max(f.y, f.z));
    return total > 0.0 ? lobe / total : 0.0;
}

// Whether to take the second lobe; what is left of the number that makes the choice is as good as new.
bool compensation_chosen(float probability, inout float u) {
    bool chosen = u < probability;
    u = min(chosen ? u / probability : (u - probability) / (1.0 - probability), 0.9999999);
    return chosen;
}

// A sample of both lobes: `s` is one of the first, which is left aside where the second was chosen.
BsdfSample compensation_sample(Material m, Compensation c, vec3 wo, vec3 u, BsdfSample s, float probability, bool chosen) {
    vec3 value = s.weight * s.pdf_w;
    if (chosen) {
        bool through = u.z < compensation_passage(m, c, wo);
        float z = compensation_cosine(m, u.x);
        float sine = sqrt(max(0.0, 1.0 - z * z));
        float phi = 2.0 * PI * u.y;
        s.wi = vec3(sine * cos(phi), sine * sin(phi), (wo.z > 0.0) != through ? z : -z);
        s.eta = through ? (wo.z > 0.0 ? m.eta : 1.0 / m.eta) : 1.0;
        value = is_glass(m) ? rough_dielectric_eval(m, wo, s.wi) : rough_conductor_eval(m, wo, s.wi);
        s.pdf_w = is_glass(m) ? rough_dielectric_pdf(m, wo, s.wi) : rough_conductor_pdf(m, wo, s.wi);
    } else if (s.pdf_w == 0.0) {
        return s;
    }
    value += compensation_eval(m, c, wo, s.wi);
    s.pdf_w = mix(s.pdf_w, compensation_pdf(m, c, wo, s.wi), probability);
    s.weight = s.pdf_w > 0.0 ? value / s.pdf_w : vec3(0.0);
    return s;
}
