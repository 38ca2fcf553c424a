// The one place that knows all BSDFs. Directions are unit, point away from the surface, and are in the local shading
// frame: wo towards where light goes in the end (the previous vertex of a camera path), wi towards where it comes from.
#include "core/basis.glsl"
#include "core/sampling.glsl"
#include "core/rng.glsl"
#include "core/texture.glsl"
#include "materials/fresnel.glsl"

struct BsdfSample {
    vec3 wi;
    vec3 weight;  // f |cos_i| / pdf_w; zero where the sample is invalid
    float pdf_w;  // over solid angle of wi; of a delta lobe, the discrete probability of choosing it
    bool delta;
    bool narrow;  // it comes from a narrow lobe, a delta among them
    float eta;    // index ratio that a refraction crossed, 1 otherwise
    bool open;    // weight and pdf_w are still to be evaluated, by bsdf_eval and bsdf_pdf
};

// A sample whose weight the lobe's own formula gives.
BsdfSample bsdf_sampled(vec3 wi, vec3 weight, float pdf_w, bool delta, float eta) { return BsdfSample(wi, weight, pdf_w, delta, delta, eta, false); }

// One of a mixture of lobes, which have to be added up, by a lobe that is narrow or not.
BsdfSample bsdf_open_sample(vec3 wi, float eta, bool narrow) { return BsdfSample(wi, vec3(0.0), 0.0, false, narrow, eta, true); }

// None.
BsdfSample bsdf_no_sample(vec3 wi) { return BsdfSample(wi, vec3(0.0), 0.0, false, false, 1.0, false); }

#include "materials/lobes.glsl"
#include "materials/microfacet.glsl"

// Whether the material is of a kind; false at compile time where the scene has none of it (`present`), which no function could hand back.
#define is_kind(b, present, is) (present && (b).m.kind == is)

// The BSDFs and the branches by kind, from the list of materials in src/layout/materials.rs.
#include "generated/materials.glsl"
#include "materials/compensation.glsl"

// A material at a point: its parameters with its textures looked up.
struct Bsdf {
    Material m;
    BSDF_DETAILS
    Compensation compensation;
};

#include "materials/properties.glsl"

// The material at a place of a surface, where a path is `side` wide in them. A blend is one of its two materials, by chance: what is linear in the BSDF keeps its
// mean, and no lobe of either needs to know the other.
Bsdf bsdf_at(uint material, TexturePlace place, float side, vec4 colour, inout Sampler random) {
    Bsdf b;
    b.m = load_material(material);
    if (HAS_BLENDS) {
        while (b.m.kind == MATERIAL_BLEND) {
            Blend blend = Blends(scene.blends).at[b.m.detail];
            float weight = clamp(blend.weight * texture_scalar(blend.weight_texture, place), 0.0, 1.0);
            b.m = load_material(next4(random).x < weight ? blend.second : blend.first);
        }
    }
    LOAD_BSDF_DETAILS(b)
    if (is_compensated(b.m)) b.compensation = Compensations(scene.compensations).at[b.m.detail];
    if (HAS_COLOURS && (b.m.flags & MATERIAL_HAS_COLOURS) != 0u) b.m.reflectance *= colour.rgb;
    if (!HAS_MATERIAL_TEXTURES || b.m.textures == NONE) return b;

    apply_textures(b, place, side);
    return b;
}

// Every lobe is a delta: light sampling cannot hit it.
bool bsdf_is_delta(Bsdf b) { return ALL_LOBES_ARE_DELTA(b); }

// Some lobe passes light through: its frame is never turned round.
bool bsdf_transmits(Bsdf b) { return (b.m.flags & MATERIAL_HAS_TRANSMISSION) != 0u; }

// Whether some lobe is narrow; of a mixture that may be.
bool bsdf_has_narrow(Bsdf b) { return SPLITS && IS_ROUGH(b) && (IS_MIXTURE(b) || is_narrow(roughness(b.m))); }

// Whether some lobe is broad: neither a delta nor narrow. Of a mixture, one that has a weight.
bool bsdf_has_broad(Bsdf b) {
    if (bsdf_is_delta(b)) return false;
    bool found = true;
    if (SPLITS) {
        if (IS_ROUGH(b)) found = !is_narrow(roughness(b.m));
        MIXTURE_HAS_BROAD(found, b)
    }
    return found;
}

// The BSDF of its broad lobes alone, of its narrow ones, and of those of the class that a sample comes from. The same BSDF in techniques that
// do not split.
Bsdf broad_lobes(Bsdf b) {
    if (SPLITS) b.m.flags |= WITHOUT_NARROW_LOBES;
    return b;
}
Bsdf narrow_lobes(Bsdf b) {
    if (SPLITS) b.m.flags |= WITHOUT_BROAD_LOBES;
    return b;
}
Bsdf sampled_lobes(Bsdf b, BsdfSample s) {
    if (SPLITS) b.m.flags |= s.narrow ? WITHOUT_BROAD_LOBES : WITHOUT_NARROW_LOBES;
    return b;
}

// Whether the material is one lobe, of a class that does not take part. A mixture sees to its lobes by itself.
bool bsdf_left_out(Bsdf b) { return SPLITS && !IS_MIXTURE(b) && !takes_lobes(b.m, IS_ROUGH(b) && is_narrow(roughness(b.m))); }

// A direction for the given uniform numbers; weight and density include the choice of the lobe. It may be left open.
BsdfSample bsdf_choose(Bsdf b, vec3 wo, vec3 u) {
    BsdfSample s = bsdf_no_sample(vec3(0.0, 0.0, 1.0));
    float probability = 0.0; // of the lobe that compensates
    bool compensates = false;
    if (is_compensated(b.m)) {
        probability = compensation_probability(b.m, b.compensation, wo);
        compensates = compensation_chosen(probability, u.z);
    }
    SAMPLE_BSDF(s, b, wo, u)
    if (is_compensated(b.m)) s = compensation_sample(b.m, b.compensation, wo, u, s, probability, compensates);
    if (!IS_MIXTURE(b) && IS_ROUGH(b) && is_narrow(roughness(b.m))) s.narrow = true;
    return s;
}

// f |cos_i| of the non-delta lobes.
vec3 bsdf_eval(Bsdf b, vec3 wo, vec3 wi) {
    vec3 f = vec3(0.0);
    if (bsdf_left_out(b)) return f;
    EVALUATE_BSDF(f, b, wo, wi)
    if (is_compensated(b.m)) f += compensation_eval(b.m, b.compensation, wo, wi);
    return f;
}

// Density over solid angle with which bsdf_sample picks wi, of the non-delta lobes.
float bsdf_pdf(Bsdf b, vec3 wo, vec3 wi) {
    float pdf = 0.0;
    if (bsdf_left_out(b)) return pdf;
    BSDF_DENSITY(pdf, b, wo, wi)
    if (is_compensated(b.m)) {
        float probability = compensation_probability(b.m, b.compensation, wo);
        pdf = mix(pdf, compensation_pdf(b.m, b.compensation, wo, wi), probability);
    }
    return pdf;
}

// Some BSDF is long to compile.
const bool HAS_LONG_BSDF = HAS_LONG_MATERIAL || HAS_ENERGY_COMPENSATION;

// Densities over solid angle with which bsdf_sample picks wi for wo, and wo for wi.
vec2 bsdf_pdf_both(Bsdf b, vec3 wo, vec3 wi) {
    if (!HAS_LONG_BSDF) return vec2(bsdf_pdf(b, wo, wi), bsdf_pdf(b, wi, wo));
    vec2 pdf = vec2(0.0);
    for (uint turn = 0u; turn < turns(2u); turn++) {
        bool back = turn > 0u;
        float found = bsdf_pdf(b, back ? wi : wo, back ? wo : wi);
        if (back) pdf.y = found;
        else pdf.x = found;
    }
    return pdf;
}

// Gives a sample that was left open its weight and density, once f |cos| and that are evaluated.
void bsdf_closed(inout BsdfSample s, vec3 f, float pdf_w) {
    s.pdf_w = pdf_w;
    s.weight = pdf_w > 0.0 ? f / pdf_w : vec3(0.0);
    s.open = false;
}

// Some mixture has lobes that reach the same direction by different index ratios: refraction beside diffuse transmission, or dispersion.
// Two constants, since glslang makes a branch of `a && (b || c)`, which has no place outside of functions.
const bool HAS_MIXED_LAYERS = HAS_LAYERED_DIFFUSE_TRANSMISSION || HAS_LAYERED_DISPERSION;
const bool HAS_MIXED_REFRACTION = HAS_LAYERED_VOLUME && HAS_MIXED_LAYERS;

// Evaluates a sample that was left open, whose density is known. For power, f of the reversed pair is f times the eta^2 of the lobe (Veach
// 1997, section 5.2). Where a direction belongs to lobes of several eta, the eta of the lobe that chose it is not that of the others: such a
// mixture is evaluated for the reversed pair, and nothing is left for the caller to take out (eta is 1).
void bsdf_close(Bsdf b, vec3 wo, float pdf_w, inout BsdfSample s) {
    if (HAS_OPEN_SAMPLES && s.open) {
        bool reversed = is_kind(b, HAS_MIXED_REFRACTION, MATERIAL_LAYERED) && (b.m.flags & MATERIAL_IS_ADJOINT) != 0u;
        vec3 from = wo, to = s.wi;
        if (reversed) {
            from = s.wi;
            to = wo;
            s.eta = 1.0;
        }
        vec3 f = bsdf_eval(b, from, to);
        if (reversed) f *= abs(s.wi.z / wo.z);
        bsdf_closed(s, f, pdf_w);
    }
}

// A direction for the given uniform numbers; weight and density include the choice of the lobe, in techniques that split those of its class.
BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u) {
    BsdfSample s = bsdf_choose(b, wo, u);
    b = sampled_lobes(b, s);
    if (HAS_OPEN_SAMPLES && s.open) bsdf_close(b, wo, bsdf_pdf(b, wo, s.wi), s);
    return s;
}
