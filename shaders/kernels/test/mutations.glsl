// What chains of mlt:form=paths propose to go to, with the ratio that would decide; nothing is decided. One mutation for each chain, whose
// number the host gives. The layout of the answers is src/verify/balance.rs's.
// Parameters of technique: mlt
#version 460
#define SAMPLER_OF_CHAINS
#include "core/prelude.glsl"
#include "kernels/probe.glsl"
#include "techniques/metropolis/chains.glsl"
#include "trace/trace.glsl"
#include "generated/parameters.glsl"
#include "techniques/metropolis/path_mutations.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MutationNumbers { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Answers { float at[]; };

const uint MOST = 9u;     // vertices of a path that fit
const uint ANSWER = 80u;  // floats
const uint HEAD = 8u;     // of these, before the vertices

void put_path(uint place, Route r) {
    for (uint i = 0u; i <= min(r.segments, MOST - 1u); i++) {
        PathVertex x = route_vertex(r, i);
        for (uint axis = 0u; axis < 3u; axis++) Answers(PROBE_OUTPUT).at[place + 4u * i + axis] = x.position[axis];
        Answers(PROBE_OUTPUT).at[place + 4u * i + 3u] = scatters_by_delta(x) ? 1.0 : 0.0;
    }
}

void main() {
    uint chain = gl_GlobalInvocationID.x;
    if (chain >= frame.slot_count) return;
    uint answer = ANSWER * chain;
    Proposal p = chain_propose(chain, MutationNumbers(PROBE_INPUT).at[chain], LARGE_STEP);
    Estimate e;
    estimate_clear(e);
    e.rays = 0u;
    Mutation m;
    mutation_open(p, chain, m);
    Weighed w;
    while (mutation_follow(m, p, e, w)) {}
    Answers(PROBE_OUTPUT).at[answer] = w.ratio;
    Answers(PROBE_OUTPUT).at[answer + 1u] = float(m.kind);
    Answers(PROBE_OUTPUT).at[answer + 2u] = float(m.from_segments);
    Answers(PROBE_OUTPUT).at[answer + 3u] = float(m.route.segments);
    Answers(PROBE_OUTPUT).at[answer + 4u] = float(m.first);
    Answers(PROBE_OUTPUT).at[answer + 5u] = float(m.last);
    Route current = m.route;
    current.slot = m.current;
    current.segments = m.from_segments;
    put_path(answer + HEAD, current);
    put_path(answer + HEAD + 4u * MOST, m.route);
}
