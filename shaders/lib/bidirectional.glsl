// Weights of the strategies that sample the same path: (s, t) has s vertices from the light and t from the camera (Veach 1997,
// chapter 10). They are summed up along both parts as those are made (Georgiev 2012, "Implementing vertex connection and merging",
// whose names these are), so that a connection needs no more than its two ends.
//
// Densities per area are in units of one over the square of the scene's radius: weights do not depend on its scale.

// PARAM0 of techniques that combine strategies.
const uint WEIGHTS_POWER = 0u;   // the power heuristic, exponent 2
const uint WEIGHTS_BALANCE = 1u; // the balance heuristic
const uint WEIGHTS_NONE = 2u;    // all strategies that can sample the path count alike

// Partial sums at a vertex of either part, over the strategies that have fewer vertices on its side.
struct Partial {
    float d_vcm; // that with one less: the density of this vertex is turned round
    float d_vc;  // the others, for connections
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

// The path has arrived at a vertex: densities over solid angle become such per area there. `distance2` is the square of the
// distance, or nothing (1 / scaled_area(1)) where the segment has no end.
void partial_arrive(inout Partial p, float distance2, float cosine) {
    p.d_vcm *= mis(scaled_area(distance2) / cosine);
    p.d_vc *= mis(1.0 / cosine);
    partial_bound(p);
}

// The path goes on in a direction of density pdf_w; `reverse_pdf_w` is that of having come the other way.
void partial_scatter(inout Partial p, float cosine, float pdf_w, float reverse_pdf_w, bool delta) {
    if (delta) {
        p.d_vc *= mis(cosine);
        p.d_vcm = 0.0;
        return;
    }
    float there = mis(cosine / pdf_w);
    p.d_vc = there > 0.0 ? there * (p.d_vc * mis(reverse_pdf_w) + p.d_vcm) : 0.0;
    p.d_vcm = mis(1.0 / pdf_w);
    partial_bound(p);
}

// What the strategies with fewer vertices on one side of a connection weigh together: `reverse_a` is the density, per scaled area, with
// which the other side would have sampled this side's end, `reverse_pdf_w` with which that end would then have gone on.
float partial_sum(Partial p, float reverse_a, float reverse_pdf_w) {
    float there = mis(reverse_a);
    return there > 0.0 ? there * (p.d_vcm + p.d_vc * mis(reverse_pdf_w)) : 0.0;
}
