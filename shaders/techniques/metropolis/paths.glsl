// Chains whose mutations change the vertices of paths themselves (Veach and Guibas 1997): as many segments as the path has are its kind.
#include "techniques/metropolis/path_mutations.glsl"

struct Walk {
    Mutation mutation;
    vec2 position; // in the image
    Weighed weighed;
};

bool walk_begin(Proposal p, uint room, inout Estimate e, out Walk w) {
    mutation_open(p, room, w.mutation);
    return true;
}

bool walk_extend(inout Walk w, Proposal p, inout Estimate e) {
    bool goes_on = mutation_follow(w.mutation, p, e, w.weighed);
    w.position = w.mutation.position;
    return goes_on;
}

uint walk_kind(Walk w, Proposal p) { return w.mutation.route.segments - 1u; }
float walk_share(Walk w, Proposal p) { return w.weighed.share; }
float walk_ratio(Walk w, Proposal p, float proposed) { return w.weighed.ratio; }
uint walk_source(Walk w, Proposal p) { return bootstrap_source(walk_kind(w, p), p.kind, w.weighed.ran); }
uint walk_known(Walk w) { return w.mutation.route.slot; }

// A perturbation from the camera that turns directions at vertices in between is a multi-chain perturbation.
uint walk_sort(Walk w, Proposal p) {
    Mutation m = w.mutation;
    if (m.kind == INDEPENDENT) return m.runs ? MUTATION_RUN : MUTATION_LARGE;
    if (m.kind == BIDIRECTIONAL) return MUTATION_BIDIRECTIONAL;
    if (m.kind == TOWARDS_CAMERA) return MUTATION_CAUSTIC;
    for (uint i = 1u; i + 1u < m.last; i++) {
        if (!scatters_by_delta(route_vertex(m.route, i))) return MUTATION_MULTI_CHAIN;
    }
    return MUTATION_LENS;
}

void walk_keep(Walk w, Proposal p, uint chain) {} // its vertices are in place
