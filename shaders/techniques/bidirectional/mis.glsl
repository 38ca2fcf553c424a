// Multiple importance sampling of all strategies that sample the same path: (s, t) has s vertices of a light subpath and t of a camera
// subpath (Veach 1997, chapter 10), and any vertex in between can be one where both end, a merge (Georgiev, Krivanek, Davidovic and
// Slusallek 2012, "Light transport simulation with vertex connection and merging"). Each subpath carries two recursive quantities, so that
// a connection or a merge needs no more than its ends. Equation numbers are those of Georgiev 2012, "Implementing vertex connection and
// merging" (technical report); docs/mis.md derives them, with what this file adds.
//
// Densities per area are in units of one over the square of the scene's radius: weights do not depend on its scale.
#include "generated/parameters.glsl"
#include "transport/light_subpath.glsl"

// The strategies that take part. Whoever includes this file says of which technique.
//     CONNECTS       those that join two vertices by a segment, next-event estimation and light tracing among them
//     MEETS_LENS     light subpaths that run into a lens (t = 0)
//     MERGES         merges within the merge radius
//     MERGES_FIRST   of these only the one at the camera's first vertex that has broad lobes
#if defined(STRATEGIES_OF_BDPT)
const bool CONNECTS = true, MEETS_LENS = true, MERGES = false, MERGES_FIRST = false;
#elif defined(STRATEGIES_OF_MULTIPLEXED)
const bool CONNECTS = true, MEETS_LENS = false, MERGES = false, MERGES_FIRST = false;
const uint WEIGHTS_POWER = 0u, WEIGHTS_BALANCE = 1u, WEIGHTS_NONE = 2u;
#define WEIGHTS WEIGHTS_BALANCE // as Hachisuka et al. 2014 have it: no parameter of `mlt`
#elif defined(STRATEGIES_OF_VCM)
// bpm, bidirectional photon mapping: merges anywhere, and running into lights. ppm, progressive photon mapping: a merge at the camera's
// first vertex that has broad lobes. bpt, bidirectional path tracing: no merges.
const bool CONNECTS = FORM == FORM_VCM || FORM == FORM_BPT, MEETS_LENS = true;
const bool MERGES = FORM != FORM_BPT, MERGES_FIRST = FORM == FORM_PPM;
#else
#error "techniques/bidirectional/mis.glsl: define STRATEGIES_OF_BDPT, STRATEGIES_OF_MULTIPLEXED or STRATEGIES_OF_VCM before including it"
#endif

// The longest path that has vertices from both sides.
uint longest() { return MERGES_FIRST ? MAX_DEPTH : min(MAX_DEPTH, BIDIRECTIONAL_LENGTH); }

// The recursive quantities at a vertex of a subpath: sums over the strategies that have fewer vertices on its side, as ratios to a
// connection that ends there. Where connections and merges both take part, Georgiev's third one is d_vm = d_vc / eta_vcm.
struct SubpathMis {
    float d_vcm; // the strategy with one vertex less, over the reverse density of this vertex, which is still to come
    float d_vc;  // the others
};

// A bound far beyond any weight that matters: sums stay finite, and infinity never meets a factor of nothing.
const float LARGEST_SUM = 1e26;

void mis_bound(inout SubpathMis m) { m = SubpathMis(min(m.d_vcm, LARGEST_SUM), min(m.d_vc, LARGEST_SUM)); }

// A ratio of densities as the heuristic takes it (Veach 1997, sections 9.2.2 and 9.2.3): the power heuristic has the exponent 2, the balance
// heuristic 1; without weights all strategies that can sample the path count alike.
float heuristic(float ratio) {
    if (WEIGHTS == WEIGHTS_NONE) return ratio > 0.0 ? 1.0 : 0.0;
    float r = min(ratio, 1e13); // its square still fits into a float, with room for sums
    return WEIGHTS == WEIGHTS_POWER ? r * r : r;
}

float scaled_area(float area) { return area / (scene.radius * scene.radius); }

// eta_vcm = n pi r^2 (eq. 20): light subpaths that a merge at a vertex finds for each that comes there per scaled area, as the heuristic
// takes it. A mask lets both subpaths pass by chance, so that they meet there less often than they come: times its opacity.
float eta_vcm(float opacity) {
    if (!MERGES) return 0.0;
    return heuristic(PI * scaled_area(merge_radius() * merge_radius()) * light_path_count() * opacity);
}

// A term that stands for a connection.
float if_connected(float term) { return CONNECTS ? term : 0.0; }

// The beginning of a camera subpath (eqs. 31 and 32, with solid angle not turned to area yet), per scaled area of the lens: `importance` is
// pixels per solid angle, `cosine` is to the camera's axis. A pinhole has no area (lens_a = 0), and t = 0 does not take part.
SubpathMis mis_begin_camera(float importance, float lens_a, float cosine) {
    float pdf_w = importance / light_path_count(); // over those of light subpaths
    return SubpathMis(heuristic(1.0 / pdf_w), lens_a > 0.0 ? if_connected(heuristic(cosine / (lens_a * pdf_w))) : 0.0);
}

// Weight of t = 0: the light subpath has run into the lens (eqs. 37 and 43 from the other end).
float mis_lens_weight(SubpathMis m, float importance, float lens_a) {
    return 1.0 / (1.0 + m.d_vcm * heuristic(lens_a) + m.d_vc * heuristic(lens_a * importance / light_path_count()));
}

// The subpath has arrived at a vertex (g-arrow of eqs. 31 to 36): densities over solid angle become such per area there. `distance2` is the
// square of the distance; 1 where densities are per area already.
void mis_arrive(inout SubpathMis m, float distance2, float cosine) {
    m.d_vcm *= heuristic(scaled_area(distance2) / cosine);
    m.d_vc *= heuristic(1.0 / cosine);
    mis_bound(m);
}

// The camera subpath has arrived at a vertex, at this cosine. Returns the square of the distance. The density of an orthographic camera is
// one per area already.
float mis_arrive_from_camera(inout SubpathMis m, Path path, Vertex v, float cosine) {
    vec3 segment = v.at.position - path.from.position;
    float distance2 = dot(segment, segment);
    mis_arrive(m, CAMERA == CAMERA_ORTHOGRAPHIC && path.depth == 0u ? 1.0 : distance2, cosine);
    return distance2;
}

// The light subpath has arrived at a vertex, at this cosine; at its first one, eqs. 31 and 32, of a light without extent 48 and 49: what (1, t)
// would have picked its beginning with is known only there.
void mis_arrive_from_light(inout SubpathMis m, Path path, EmittedRay e, Vertex v, Bsdf b, float cosine) {
    vec3 segment = v.at.position - path.from.position;
    float distance2 = dot(segment, segment);
    if (path.depth > 0u) mis_arrive(m, distance2, cosine);
    else m = SubpathMis(heuristic(light_choice_ratio(e, vertex_reference(v, b), distance2) / cosine), e.delta ? 0.0 : heuristic(e.d_vc / cosine));
}

// The subpath goes on in a direction of density pdf_w from a vertex of that opacity (eqs. 34 and 35, of a delta lobe 53 and 54); `reverse_pdf_w` is the density of having
// come the other way. Of a delta lobe both leave out the same infinite factor, and nothing is connected there.
void mis_scatter(inout SubpathMis m, float cosine, float pdf_w, float reverse_pdf_w, bool delta, float opacity) {
    float there = heuristic(cosine / pdf_w);
    float others = m.d_vc * heuristic(reverse_pdf_w) + (delta ? 0.0 : if_connected(m.d_vcm) + eta_vcm(opacity));
    m.d_vc = there > 0.0 ? there * others : 0.0;    // eqs. 35 and 54
    m.d_vcm = delta ? 0.0 : heuristic(1.0 / pdf_w); // eqs. 34 and 53
    mis_bound(m);
}

// Chooses the direction in which the subpath goes on, and takes that step in its quantities.
BsdfSample mis_sample(inout SubpathMis m, Vertex v, Bsdf b, Ray ray, vec3 u) {
    if (v.from_light) b.m.flags |= MATERIAL_IS_ADJOINT;
    BsdfSample s = bsdf_choose(b, v.wo, u);
    b = sampled_lobes(b, s);
    vec2 pdf_w = HAS_OPEN_SAMPLES ? bsdf_pdf_both(b, v.wo, s.wi) : vec2(0.0, bsdf_pdf(b, s.wi, v.wo));
    bsdf_close(b, v.wo, pdf_w.x, s);
    vertex_check(v, ray, s);
    float cosine = abs(dot(vertex_to_world(v, s.wi), v.at.normal));
    // Refraction takes a solid angle dw_o to dw_i = dw_o |cos_o| / (eta^2 |cos_i|) (Veach 1997, section 5.2): turned round, its delta lobe has the
    // density times that ratio.
    float reverse_pdf_w = s.delta ? s.pdf_w * abs(v.wo.z / s.wi.z) / (s.eta * s.eta) : pdf_w.y;
    mis_scatter(m, cosine, s.pdf_w, reverse_pdf_w, s.delta || SPLITS && s.narrow, vertex_opacity(v));
    return s;
}

// What the strategies with fewer vertices on one side of a connection weigh together (w_light and w_camera: eqs. 40, 41, 45 and 46):
// `reverse_a` is the density, per scaled area, with which the other side would have sampled this side's end, of that opacity;
// `reverse_pdf_w` that with which that end would then have gone on. The weight is 1 / (w_light + 1 + w_camera) (eq. 37).
float mis_connection(SubpathMis m, float reverse_a, float reverse_pdf_w, float opacity) {
    float there = heuristic(reverse_a);
    return there > 0.0 ? there * (eta_vcm(opacity) + m.d_vcm + m.d_vc * heuristic(reverse_pdf_w)) : 0.0;
}

// The same sum on one side of a merge (eqs. 38 and 39).
float mis_merge(SubpathMis m, float reverse_pdf_w, float opacity) {
    return (if_connected(m.d_vcm) + m.d_vc * heuristic(reverse_pdf_w)) / eta_vcm(opacity);
}

// Weight of (0, t): the camera subpath has run into a light (eqs. 37 and 43). `choice_pdf_w` is the density with which (1, t - 1) picks that
// direction, `cosine` lies at the light, `emission_a` is the density of light subpaths beginning there, per scaled area, and `emission_w`
// that of going this way then.
float mis_emission_weight(Path path, SubpathMis m, float choice_pdf_w, float cosine, float distance2, float emission_a, float emission_w) {
    if (path.depth == 0u) return 1.0 / (1.0 + if_connected(m.d_vcm) * heuristic(emission_a)); // against (1, 1): d_vcm is one over the density of camera subpaths per area there
    float choice_a = choice_pdf_w * cosine / scaled_area(distance2);
    return 1.0 / (1.0 + if_connected(m.d_vcm) * heuristic(choice_a) + m.d_vc * heuristic(emission_a * emission_w));
}

// Weight of (0, t) for a path that is too long for any other strategy but (1, t - 1).
float mis_long_weight(Path path, float choice_pdf_w) { return CONNECTS && !path.delta ? 1.0 / (1.0 + heuristic(choice_pdf_w / path.pdf_w)) : 1.0; }
