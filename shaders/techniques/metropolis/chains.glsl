// Metropolis light transport (Veach and Guibas 1997; Kelemen et al. 2002): a Markov chain visits paths in proportion to their scalar
// contribution, so that each visit adds the same, the mean contribution of all paths, to its pixel.
//
// Chains begin at bootstrap samples that are chosen in proportion to their contribution: then chains are in their stationary distribution from the
// start, and no burn-in is thrown away (Veach 1997, section 11.3.1). Both the current path and the proposal are splatted, by the probability
// of each (expected values; Veach 1997, section 11.2.3).
//
// A path of 10^5 times the mean contribution would hold its chain for as many mutations, and whole images have fewer. So the target function is
// compressed: with f the contribution over the density of large steps and K a bound, the target is T = f / (1 + f / K), and a visit is
// splatted with the weight 1 + f / K (importance sampling of the target). Large steps estimate the mean of T with a relative variance below
// K over that mean, whatever paths there are.
#include "techniques/metropolis/numbers.glsl"
#include "core/splat.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer BootstrapSamples { BootstrapSample bootstrap; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Chains { Chain chain; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Values { vec3 value; };

BootstrapSamples bootstrap_at(uint index) { return BootstrapSamples(unpack32(pack64(chain_table().bootstrap) + uint64_t(BOOTSTRAP_SAMPLE_BYTES) * uint64_t(index))); }
Chains chain_at(uint index) { return Chains(unpack32(pack64(chain_table().states) + uint64_t(CHAIN_BYTES) * uint64_t(index))); }

Values value_at(uint chain, uint layer) {
    ChainTable table = chain_table();
    return Values(unpack32(pack64(table.values) + uint64_t(VEC3_BYTES) * (uint64_t(layer) * uint64_t(table.chains) + uint64_t(chain))));
}

// A path that a chain may go to.
struct Proposal {
    Sampler random; // at its beginning
    uint kind;      // of large steps
    bool large;     // nothing of the current path is in it
    bool bootstrap; // it is a bootstrap sample
    Chain from;     // the chain that it is proposed to
};

// Probability that a large step is of the first `count` kinds.
float kinds_share(uint count) { return count == 0u ? 0.0 : Floats(chain_table().kinds_shares).at[count - 1u]; }

float kind_probability(uint kind) { return kinds_share(kind + 1u) - kinds_share(kind); }

// The kind of the large step that a uniform number chooses.
uint kind_of(float u) {
    uint kind = 0u;
    while (kind + 1u < chain_table().kind_count && u >= kinds_share(kind + 1u)) kind += 1u;
    return kind;
}

// The bootstrap sample of that index, as a proposal.
Proposal bootstrap_proposal(uint index) {
    Chain none;
    none.known = NONE;
    none.position = vec2(0.0);
    none.kind = 0u;
    return Proposal(Sampler(index, 0u, 0u, 0u), kind_of(decisions(index, 0u).x), true, true, none);
}

// The chain's next proposal: its first one is the bootstrap sample that it begins at.
Proposal chain_propose(uint index, uint mutation, float large_step) {
    Chain c = chain_at(index).chain;
    if (c.known == NONE) return Proposal(Sampler(c.begins_at, 0u, 0u, 0u), c.kind, true, false, c);
    vec4 u = decisions(index, mutation);
    bool large = u.x < large_step;
    return Proposal(Sampler(index, mutation, 0u, large ? 0u : c.known), large ? kind_of(u.w) : c.kind, large, false, c);
}

// The number of the mutation that makes the proposal: 0 where it is the bootstrap sample that the chain begins at.
uint mutation_number(Proposal p, uint mutation) { return p.from.known == NONE ? 0u : mutation; }

// The scalar contribution of a path: the mean of its channels.
float scalar_contribution(vec3 value) { return (value.x + value.y + value.z) * (1.0 / 3.0); }

// Target compression: a path of contribution f is visited in proportion to f / compression(f), and each visit is weighted by compression(f).
float compression(float f) { return 1.0 + f / chain_table().bound; }

// A layer of the contribution.
vec3 layer_value(Estimate e, uint layer) { return LENGTH_LAYERS > 0u ? e.by_length[layer] : e.radiance; }

// Where a bootstrap sample is from, packed for the host: its kind, the kind of large steps that made it, and in 65535ths the part of their
// density there that is the last kind's.
uint bootstrap_source(uint kind, uint made_by, float by_last) { return kind | made_by << 8u | uint(by_last * 65535.0 + 0.5) << 16u; }

// Ends the estimate of a proposal, which stands for `share` of its like; what is not finite is dropped, counted and located.
void proposal_close(vec2 position, float share, uint sample_index, inout Estimate e) {
    e.radiance *= share;
    for (uint i = 0u; i < LENGTH_LAYERS; i++) e.by_length[i] *= share;
    if (scalar_contribution(e.radiance) < INFINITY) return;
    vec2 inside = clamp(position, vec2(0.0), vec2(scene.width - 1u, scene.height - 1u));
    uvec2 pixel = uvec2(whole(inside.x), whole(inside.y));
    report_bad_sample(pixel.y * scene.width + pixel.x, sample_index);
    estimate_clear(e);
}

// Whole pixels by which filters reach into the image from beside it.
float image_border() { return ceil(max(filter_radius() - 0.5, 0.0)); }

// A position in the image and, where filters are wider than a pixel, the border from which they reach into it: uniform over
// `light_path_count` pixels.
vec2 image_place(vec2 u) {
    float border = image_border();
    return u * (vec2(scene.width, scene.height) + 2.0 * border) - border;
}

// Whether image_place comes there.
bool inside_image(vec2 position) {
    float border = image_border();
    return all(greaterThanEqual(position, vec2(-border))) && all(lessThan(position, vec2(scene.width, scene.height) + border));
}

// What a visit is of, for records.
struct Visit {
    uint chain, mutation;
    float acceptance; // of the proposal
    bool proposal;    // it is of the proposal, not of the path that the chain is at
};

void record_visit(Visit visit, uint pixel, uint sample_index, float probability, vec3 value, vec3 splatted) {
    if (!RECORDS) return;
    record_splat(pixel, sample_index, visit.chain, visit.chain, visit.mutation, splatted, probability);
    if (!record_wants(RECORD_VISIT) || !record_wants_sample(pixel, sample_index)) return;
    PathRecord r = record_of(RECORD_VISIT, visit.proposal ? visit.mutation : chain_at(visit.chain).chain.begins_at);
    r.pixel = pixel;
    r.sample_index = sample_index;
    r.s = visit.chain;
    r.t = visit.mutation;
    r.value = value;
    r.throughput = splatted;
    r.weight = probability;
    r.probability = visit.acceptance;
    r.flags = visit.proposal ? RECORDED_PROPOSAL : 0u;
    record_append(r);
}

// Adds what stands for a visit with this probability to the pixel there, layer by layer.
void visit_splat(vec2 position, vec2 u, float probability, float f, uint sample_index, Estimate e, Visit visit) {
    ChainTable table = chain_table();
    if (!(f > 0.0) || !(probability > 0.0)) return;
    vec3 weight = vec3(1.0);
    uint pixel = splat_pixel(position, u, weight);
    if (pixel == NONE) return;
    // Positions are uniform over `light_path_count` pixels, and all visits of this sample share the mean contribution.
    weight *= probability * compression(f) * table.normalisation * (float(table.light.light_path_count) / (float(table.chains_of_sample) * float(table.mutations)));
    record_visit(visit, pixel, sample_index, probability, e.radiance, e.radiance / f * weight);
    for (uint i = 0u; i < splat_layers(); i++) {
        vec3 value = layer_value(e, i);
        if (value != vec3(0.0)) splat(pixel, sample_index, i + 1u, value / f * weight);
    }
}

// What became of a proposal.
struct Decision {
    bool mutated;  // it was a mutation: the bootstrap sample that a chain begins at is none
    bool accepted;
};

// Decides on a proposal that has been followed to its end: adds both paths to the film and moves the chain. `ratio` is the
// acceptance ratio f(y) T(y -> x) / (f(x) T(x -> y)) before target compression (Metropolis et al. 1953, Hastings 1970); `used` is what the chain
// is to know of the proposal.
Decision chain_decide(uint index, uint mutation, Proposal p, vec2 position, uint used, float ratio, uint sample_index, Estimate e) {
    Chain c = p.from;
    bool begins = c.known == NONE;
    float proposed = scalar_contribution(e.radiance);
    vec4 u = decisions(index, mutation);
    ratio *= compression(c.contribution) / compression(proposed);
    float acceptance = begins || ratio >= 1.0 ? 1.0 : ratio;
    if (!begins) {
        vec4 pixels = uniform4(pcg4d(uvec4(index, mutation, NONE - 1u, frame.seed)));
        visit_splat(position, pixels.xy, acceptance, proposed, sample_index, e, Visit(index, mutation, acceptance, true));
        Estimate current;
        current.radiance = value_at(index, 0u).value;
        for (uint i = 0u; i < LENGTH_LAYERS; i++) current.by_length[i] = value_at(index, i).value;
        visit_splat(c.position, pixels.zw, 1.0 - acceptance, c.contribution, sample_index, current, Visit(index, mutation, acceptance, false));
        if (p.large) {
            vec3 sum = vec3(c.sum), low = vec3(c.sum_low);
            add_compensated(sum, low, vec3(proposed / compression(proposed)));
            c.sum = sum.x;
            c.sum_low = low.x;
            c.large_steps += 1u;
        }
    }
    bool accepted = u.y < acceptance;
    if (accepted) {
        for (uint i = 0u; i < splat_layers(); i++) value_at(index, i).value = layer_value(e, i);
        c.kind = p.kind;
        c.known = used;
        c.contribution = proposed;
        c.position = position;
        if (RECORDS) c.begins_at = mutation_number(p, mutation);
    }
    chain_at(index).chain = c;
    return Decision(!begins, accepted);
}
