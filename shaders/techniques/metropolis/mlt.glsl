// `mlt`: Metropolis light transport. Markov chains visit paths in proportion to their contribution, by mutating the path that they are at, or
// the random numbers that it was made of: a path that was hard to find is followed by its neighbours.
//
// Form `primary` makes paths as `path` does (Kelemen et al. 2002, primary sample space); form `multiplexed` makes one of a given length
// by one strategy of bidirectional path tracing at a time (Hachisuka et al. 2014); form `paths` mutates the vertices of paths themselves
// (Veach and Guibas 1997). Consistent: the mean contribution, which scales the histogram of visits, is estimated beside them.
//
// Frames of no samples make the bootstrap samples; the host chooses among them where chains begin.
//
// To be read in this order: chains.glsl (proposals, acceptance, splats), numbers.glsl (random numbers as a chain's state), then a form:
// primary.glsl, multiplexed.glsl, or paths.glsl with path_mutations.glsl, path_value.glsl, path_vertices.glsl and path_record.glsl.
#version 460
#include "core/prelude.glsl"

#ifdef PASS_RESOLVE
#include "core/resolve.glsl"
#else
#define SAMPLER_OF_CHAINS
#include "trace/trace.glsl"
#include "generated/parameters.glsl"
#include "transport/lanes.glsl"

// Each form has a Walk, the path that a proposal makes on its way, with
//     bool walk_begin(proposal, room, inout estimate, out walk)     false where it ends at once
//     bool walk_extend(inout walk, proposal, inout estimate)        to the next vertex; false where it ends
//     float walk_share(walk, proposal)       one over the density of large steps that its contribution is to be taken over
//     float walk_ratio(walk, proposal, f)    acceptance ratio against the current path, but for target compression
//     uint walk_kind(walk, proposal)         of path
//     uint walk_known(walk)                  what the chain is to know of it
//     uint walk_source(walk, proposal)       of a bootstrap sample: see bootstrap_source
//     uint walk_sort(walk, proposal)         of mutation, for records: MUTATION_*
//     void walk_keep(walk, proposal, chain)  makes it the chain's current path
#if defined(PASS_PATHS)
#include "techniques/metropolis/paths.glsl"
#elif defined(PASS_PRIMARY)
#include "techniques/metropolis/primary.glsl"
#else
#include "techniques/metropolis/multiplexed.glsl"
#endif

struct Lane {
    uint place;         // of the bootstrap sample, or of the chain among those of a sample
    uint sample_index, end, done; // samples from here to there, and mutations that the one at hand has had
    uint chain, mutation;
    Proposal proposal;
    Walk walk;
    Estimate e;
};

bool makes_bootstrap() { return frame.sample_count == 0u; } // one for each lane

bool open(out Lane lane) {
    lane.place = frame.first_slot + gl_GlobalInvocationID.x;
    lane.sample_index = frame.first_sample;
    lane.end = frame.first_sample + max(frame.sample_count, 1u);
    lane.done = 0u;
    lane.chain = lane.mutation = 0u;
    lane.e.rays = 0u;
    return makes_bootstrap() || lane.place < chain_table().chains_of_sample;
}

bool has_next(Lane lane) { return lane.sample_index < lane.end; }

bool begin(inout Lane lane) {
    ChainTable table = chain_table();
    lane.chain = lane.place + table.chains_of_sample * (lane.sample_index % (table.chains / table.chains_of_sample));
    lane.mutation = lane.sample_index * table.mutations + lane.done + 1u;
    if (makes_bootstrap()) lane.proposal = bootstrap_proposal(lane.place);
    else lane.proposal = chain_propose(lane.chain, lane.mutation, LARGE_STEP);
    if (RECORDS && !makes_bootstrap()) record_begin_proposal(lane.chain, mutation_number(lane.proposal, lane.mutation), lane.sample_index);
    estimate_clear(lane.e);
    return walk_begin(lane.proposal, makes_bootstrap() ? gl_GlobalInvocationID.x : lane.chain, lane.e, lane.walk);
}

bool extend(inout Lane lane) { return walk_extend(lane.walk, lane.proposal, lane.e); }

void end(inout Lane lane) {
    Proposal p = lane.proposal;
    Walk w = lane.walk;
    if (RECORDS) {
        uint made_by = mutation_number(p, lane.mutation);
        record_mutation(lane.chain, made_by, made_by == 0u ? MUTATION_BEGINS : walk_sort(w, p), walk_share(w, p));
    }
    proposal_close(w.position, walk_share(w, p), lane.sample_index, lane.e);
    if (makes_bootstrap()) {
        bootstrap_at(lane.place).bootstrap = BootstrapSample(scalar_contribution(lane.e.radiance), walk_source(w, p));
    } else {
        p.kind = walk_kind(w, p);
        float ratio = walk_ratio(w, p, scalar_contribution(lane.e.radiance));
        Decision d = chain_decide(lane.chain, lane.mutation, p, w.position, walk_known(w), ratio, lane.sample_index, lane.e);
        if (d.accepted) walk_keep(w, p, lane.chain);
        if (d.mutated) lane.done += 1u;
    }
    if (makes_bootstrap() || lane.done == chain_table().mutations) {
        lane.done = 0u;
        lane.sample_index += 1u;
    }
}

void close(Lane lane) { count_rays(lane.e.rays); }

LANES(Lane, open, has_next, begin, extend, end, close)
#endif
