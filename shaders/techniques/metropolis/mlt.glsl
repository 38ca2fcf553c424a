// `mlt`: Metropolis light transport. Markov chains visit paths in proportion to what they bring, by changing the path that they are at, or
// the random numbers that it was made of: a path that was hard to find is followed by its neighbours.
//
// Form `primary` makes paths as `path` does (Kelemen et al. 2002, primary sample space); form `multiplexed` makes one of a given length
// by one strategy of bidirectional path tracing at a time (Hachisuka et al. 2014); form `paths` mutates the vertices of paths themselves
// (Veach and Guibas 1997). Consistent: the mean over all paths, which each visit brings, is estimated beside them.
//
// Frames of no samples make the paths that chains may begin with; the host chooses among them.
#version 460
#define CHAINS
#include "core/prelude.glsl"
#include "techniques/metropolis/chains.glsl"

#ifdef PASS_RESOLVE
#include "core/resolve.glsl"
#else
#include "trace/trace.glsl"

// Each form says what is on its way (Walk), and of that at its end: `walk_share`, by which what it brings stands for its like; `walk_ratio`, of
// what speaks for it to what speaks for the current path; `walk_kind` of path; `walk_known`, which the chain is to know of it; and `walk_source`,
// the kind of a candidate with that of large steps which made it, and how much of the density of large steps there is not its kind's but the last one's.
#ifdef PASS_PATHS
#include "techniques/metropolis/path_mutations.glsl"
struct Walk {
    Mutation mutation;
    vec2 position;
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
uint walk_source(Walk w, Proposal p) { return candidate_source(walk_kind(w, p), p.kind, w.weighed.ran); }
uint walk_known(Walk w) { return w.mutation.route.slot; }
void walk_keep(Walk w, Proposal p, uint chain) {} // its vertices are in place
#else
#ifdef PASS_PRIMARY
#include "techniques/metropolis/primary.glsl"
#define Walk Primary
#define numbers_begin primary_begin
#define numbers_extend primary_extend
#define numbers_share primary_share
#define walk_known primary_used
#else
const bool CONNECTS = true;
const bool MEETS_LENS = false;
const bool MERGES = false;
const bool MERGES_FIRST = false;
#include "techniques/metropolis/multiplexed.glsl"
#define Walk Multiplexed
#define numbers_begin multiplexed_begin
#define numbers_extend multiplexed_extend
#define numbers_share multiplexed_share
#define walk_known multiplexed_used
#endif
bool walk_begin(Proposal p, uint room, inout Estimate e, out Walk w) { return numbers_begin(p.random, p.kind, e, w); }
bool walk_extend(inout Walk w, Proposal p, inout Estimate e) { return numbers_extend(w, e); }
float walk_share(Walk w, Proposal p) { return numbers_share(w) / kind_probability(p.kind); }
float walk_ratio(Walk w, Proposal p, float proposed) { return proposed / p.from.brings; }
uint walk_kind(Walk w, Proposal p) { return p.kind; }
uint walk_source(Walk w, Proposal p) { return candidate_source(p.kind, p.kind, 0.0); }
void walk_keep(Walk w, Proposal p, uint chain) { keep_numbers(p.random, chain, walk_known(w)); }
#endif

layout(local_size_x = WORKGROUP) in;

void main() {
    ChainTable table = chain_table();
    uint place = frame.first_slot + gl_GlobalInvocationID.x;
    bool makes_candidate = frame.sample_count == 0u; // this one alone
    if (gl_GlobalInvocationID.x >= frame.slot_count || !makes_candidate && place >= table.chains_of_sample) return;
    uint sample_index = frame.first_sample, end = frame.first_sample + max(frame.sample_count, 1u), done = 0u;
    Estimate e;
    e.rays = 0u;
    Proposal p;
    Walk w;
    uint chain = 0u, mutation = 0u;
    bool alive = false;
    // A lane whose proposal has ended begins its next one at once instead of waiting for its neighbours.
    while (alive || sample_index < end) {
        if (!alive) {
            chain = place + table.chains_of_sample * (sample_index % (table.chains / table.chains_of_sample));
            mutation = sample_index * table.mutations + done + 1u;
            if (makes_candidate) p = candidate_proposal(place);
            else p = chain_propose(chain, mutation, uintBitsToFloat(PARAM1));
            estimate_clear(e);
            alive = walk_begin(p, makes_candidate ? gl_GlobalInvocationID.x : chain, e, w);
        }
        if (alive) alive = walk_extend(w, p, e);
        if (!alive) {
            proposal_close(w.position, walk_share(w, p), sample_index, e);
            if (makes_candidate) {
                candidate_at(place).candidate = Candidate(brings(e.radiance), walk_source(w, p));
            } else {
                p.kind = walk_kind(w, p);
                float ratio = walk_ratio(w, p, brings(e.radiance));
                Decision d = chain_decide(chain, mutation, p, w.position, walk_known(w), ratio, sample_index, e);
                if (d.accepted) walk_keep(w, p, chain);
                if (d.mutated) done += 1u;
            }
            if (makes_candidate || done == table.mutations) {
                done = 0u;
                sample_index += 1u;
            }
        }
    }
    count_rays(e.rays);
}
#endif
