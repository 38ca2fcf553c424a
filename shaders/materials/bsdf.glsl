// The one place that knows all BSDFs. Directions are unit, point away from the surface, and are in the local shading
// frame: wo towards where light goes in the end (the previous vertex of a camera path), wi towards where it comes from.
#include "lib/frame.glsl"
#include "lib/sampling.glsl"
#include "lib/fresnel.glsl"

struct BsdfSample {
    vec3 wi;
    vec3 weight;  // f |cos_i| / pdf_w; zero where the sample is invalid
    float pdf_w;  // over solid angle of wi; of a delta lobe, the discrete probability of choosing it
    bool delta;
    float eta;    // index ratio that a refraction crossed, 1 otherwise
};

bool is_correlated(Material m) { return (m.flags & MASKING_CORRELATED) != 0u; }

#include "lib/microfacet.glsl"
#include "materials/diffuse.glsl"
#include "materials/conductor.glsl"
#include "materials/rough_conductor.glsl"
#include "materials/dielectric.glsl"
#include "materials/rough_dielectric.glsl"

// Every lobe is a delta: light sampling cannot hit it.
bool bsdf_is_delta(Material m) {
    return HAS_CONDUCTOR && m.kind == MATERIAL_CONDUCTOR || HAS_DIELECTRIC && m.kind == MATERIAL_DIELECTRIC;
}

// Some lobe passes light through: its frame is never turned round.
bool bsdf_transmits(Material m) {
    return HAS_DIELECTRIC && m.kind == MATERIAL_DIELECTRIC || HAS_ROUGH_DIELECTRIC && m.kind == MATERIAL_ROUGH_DIELECTRIC;
}

// A direction for the given uniform numbers; weight and density include the choice of the lobe.
BsdfSample bsdf_sample(Material m, vec3 wo, vec3 u) {
    BsdfSample s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, false, 1.0);
    if (HAS_DIFFUSE && m.kind == MATERIAL_DIFFUSE) s = diffuse_sample(m, wo, u);
    if (HAS_CONDUCTOR && m.kind == MATERIAL_CONDUCTOR) s = conductor_sample(m, wo, u);
    if (HAS_ROUGH_CONDUCTOR && m.kind == MATERIAL_ROUGH_CONDUCTOR) s = rough_conductor_sample(m, wo, u);
    if (HAS_DIELECTRIC && m.kind == MATERIAL_DIELECTRIC) s = dielectric_sample(m, wo, u);
    if (HAS_ROUGH_DIELECTRIC && m.kind == MATERIAL_ROUGH_DIELECTRIC) s = rough_dielectric_sample(m, wo, u);
    return s;
}

// f |cos_i| of the non-delta lobes.
vec3 bsdf_eval(Material m, vec3 wo, vec3 wi) {
    vec3 f = vec3(0.0);
    if (HAS_DIFFUSE && m.kind == MATERIAL_DIFFUSE) f = diffuse_eval(m, wo, wi);
    if (HAS_ROUGH_CONDUCTOR && m.kind == MATERIAL_ROUGH_CONDUCTOR) f = rough_conductor_eval(m, wo, wi);
    if (HAS_ROUGH_DIELECTRIC && m.kind == MATERIAL_ROUGH_DIELECTRIC) f = rough_dielectric_eval(m, wo, wi);
    return f;
}

// Density over solid angle with which bsdf_sample picks wi, of the non-delta lobes.
float bsdf_pdf(Material m, vec3 wo, vec3 wi) {
    float pdf = 0.0;
    if (HAS_DIFFUSE && m.kind == MATERIAL_DIFFUSE) pdf = diffuse_pdf(m, wo, wi);
    if (HAS_ROUGH_CONDUCTOR && m.kind == MATERIAL_ROUGH_CONDUCTOR) pdf = rough_conductor_pdf(m, wo, wi);
    if (HAS_ROUGH_DIELECTRIC && m.kind == MATERIAL_ROUGH_DIELECTRIC) pdf = rough_dielectric_pdf(m, wo, wi);
    return pdf;
}
