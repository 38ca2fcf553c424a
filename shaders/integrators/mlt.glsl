// `mlt`: Metropolis light transport on random numbers. Markov chains visit paths in proportion to what they bring, by changing the
// numbers that a path was made of: a path that was hard to find is followed by its neighbours.
//
// Form `primary` makes paths as `path` does (Kelemen et al. 2002, primary sample space); form `multiplexed` makes one of a given length
// by one strategy of bidirectional path tracing at a time (Hachisuka et al. 2014). Consistent: the mean over all paths, which each visit
// brings, is estimated beside them.
//
// Frames of no samples make the paths that chains may begin with; the host chooses among them.
#version 460
#define CHAINS
#include "lib/prelude.glsl"
#include "lib/chains.glsl"

#ifdef PASS_RESOLVE
#include "lib/resolve_main.glsl"
#else
#include "trace/backend.glsl"

#ifdef PASS_PRIMARY
#include "lib/primary.glsl"
#define Walk Primary
#define walk_begin primary_begin
#define walk_extend primary_extend
#define walk_share primary_share
#define walk_used primary_used
#else
const bool CONNECTS = true;
const bool MEETS_LENS = false;
const bool MERGES = false;
const bool MERGES_FIRST = false;
#include "lib/multiplexed.glsl"
#define Walk Multiplexed
#define walk_begin multiplexed_begin
#define walk_extend multiplexed_extend
#define walk_share multiplexed_share
#define walk_used multiplexed_used
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
            alive = walk_begin(p.random, p.kind, e, w);
        }
        if (alive) alive = walk_extend(w, e);
        if (!alive) {
            proposal_close(p, w.position, walk_share(w), sample_index, e);
            if (makes_candidate) candidate_at(place).candidate = Candidate(brings(e.radiance), p.kind);
            else if (chain_decide(chain, mutation, p, w.position, walk_used(w), sample_index, e)) done += 1u;
            if (makes_candidate || done == table.mutations) {
                done = 0u;
                sample_index += 1u;
            }
        }
    }
    count_rays(e.rays);
}
#endif
