// Weights of the strategies that sample the same path: (s, t) has s vertices from the light and t from the camera (Veach 1997,
// chapter 10), and any vertex in between can be one where both parts meet, a merge (Georgiev, Krivanek, Davidovic and Slusallek
// 2012). They are summed up along both parts as those are made (Georgiev 2012, "Implementing vertex connection and merging", whose
// names these are), so that a connection or a merge needs no more than its ends.
//
// Densities per area are in units of one over the square of the scene's radius: weights do not depend on its scale. Before this is
// included, the technique defines
//     bool CONNECTS       strategies that join two vertices by a segment take part, next-event estimation and light tracing among them
//     bool MEETS_LENS     so do light paths that run into a lens
//     bool MERGES         merges do, within frame.merge_radius
//     bool MERGES_FIRST   of these only the one at the camera's first vertex that is not a mirror or smooth glass

// PARAM0 of techniques that combine strategies.
const uint WEIGHTS_POWER = 0u;   // the power heuristic, exponent 2
const uint WEIGHTS_BALANCE = 1u; // the balance heuristic
const uint WEIGHTS_NONE = 2u;    // all strategies that can sample the path count alike

// The longest path that has vertices from both sides.
uint longest() { return MERGES_FIRST ? MAX_DEPTH : min(MAX_DEPTH, BIDIRECTIONAL_LENGTH); }

// Partial sums at a vertex of either part, over the strategies that have fewer vertices on its side, as ratios to a connection that
// ends there. Where connections and merges both take part, Georgiev's third sum is d_vc over the density of merges.
struct Partial {
    float d_vcm; // that with one less: the density of this vertex is turned round
    float d_vc;  // the others
};

// A bound far beyond any weight that matters: sums stay finite, and infinity never meets a factor of nothing.
const float LARGEST_PARTIAL = 1e26;

void partial_bound(inout Partial p) { p = Partial(min(p.d_vcm, LARGEST_PARTIAL), min(p.d_vc, LARGEST_PARTIAL)); }

// A ratio of densities as the heuristic takes it.
float mis(float ratio) {
    if (PARAM0 == WEIGHTS_NONE) return ratio > 0.0 ? 1.0 : 0.0;
    float r = min(ratio, 1e13);
    return PARAM0 == WEIGHTS_POWER ? r * r : r;
}

float scaled_area(float area) { return area / (scene.radius * scene.radius); }

// Light paths that a merge at a vertex finds for each that comes there per scaled area, as the heuristic takes it. A mask lets both
// parts pass by chance, so that they meet there less often than they come.
float merge_share(float opacity) {
    if (!MERGES) return 0.0;
    return mis(PI * scaled_area(frame.merge_radius * frame.merge_radius) * float(frame.light_path_count) * opacity);
}

// A term that stands for a connection.
float connected(float ratio) { return CONNECTS ? ratio : 0.0; }

// The camera as the beginning of paths, per scaled area of its lens: `importance` is pixels per solid angle, `cosine` is to its axis. A
// pinhole has no area (lens_a = 0), and t = 0 does not take part.
Partial partial_camera(float importance, float lens_a, float cosine) {
    float pdf_w = importance / float(frame.light_path_count); // over those of light paths
    return Partial(mis(1.0 / pdf_w), lens_a > 0.0 ? connected(mis(cosine / (lens_a * pdf_w))) : 0.0);
}

// Weight of t = 0: the light path has run into the lens.
float lens_weight(Partial p, float importance, float lens_a) {
    return 1.0 / (1.0 + p.d_vcm * mis(lens_a) + p.d_vc * mis(lens_a * importance / float(frame.light_path_count)));
}

// The path has arrived at a vertex: densities over solid angle become such per area there. `distance2` is the square of the
// distance, or nothing (1 / scaled_area(1)) where the segment has no end.
void partial_arrive(inout Partial p, float distance2, float cosine) {
    p.d_vcm *= mis(scaled_area(distance2) / cosine);
    p.d_vc *= mis(1.0 / cosine);
    partial_bound(p);
}

// The path goes on in a direction of density pdf_w from a vertex of that opacity; `reverse_pdf_w` is that of having come the other way.
// Of a delta lobe both leave out the same infinite factor, and nothing is joined there.
void partial_scatter(inout Partial p, float cosine, float pdf_w, float reverse_pdf_w, bool delta, float opacity) {
    float there = mis(cosine / pdf_w);
    float others = p.d_vc * mis(reverse_pdf_w) + (delta ? 0.0 : connected(p.d_vcm) + merge_share(opacity));
    p.d_vc = there > 0.0 ? there * others : 0.0;
    p.d_vcm = delta ? 0.0 : mis(1.0 / pdf_w);
    partial_bound(p);
}

// What the strategies with fewer vertices on one side of a connection weigh together: `reverse_a` is the density, per scaled area, with
// which the other side would have sampled this side's end, of that opacity; `reverse_pdf_w` with which that end would then have gone on.
float partial_sum(Partial p, float reverse_a, float reverse_pdf_w, float opacity) {
    float there = mis(reverse_a);
    return there > 0.0 ? there * (merge_share(opacity) + p.d_vcm + p.d_vc * mis(reverse_pdf_w)) : 0.0;
}

// The same on one side of a merge.
float partial_merge_sum(Partial p, float reverse_pdf_w, float opacity) {
    return (connected(p.d_vcm) + p.d_vc * mis(reverse_pdf_w)) / merge_share(opacity);
}
