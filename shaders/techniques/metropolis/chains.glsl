// Metropolis light transport on chains of random numbers (Veach and Guibas 1997, "Metropolis light transport"; Kelemen et al. 2002): a
// chain visits paths in proportion to what they bring, so that each visit brings the same, the mean over all paths, to its pixel.
//
// Chains begin with candidates that were chosen in proportion to what these bring: then they are distributed as they will be for ever,
// and nothing needs to be thrown away (Veach 1997, section 11.3.1). Both the path that is proposed and the one that it is proposed to are
// counted, by the probability of each (Veach 1997, section 11.2.3).
//
// A path that brings 10^5 times the mean would hold its chain for as many mutations, and whole images have fewer. So paths are visited
// in proportion to what they bring as long as that is not much more than others, and to a bound where it is; each visit counts for
// as much as it was held back by (importance sampling of the target). With w what a path brings over the density of large steps and K the bound, the
// target is T = w / (1 + w / K): large steps find its mean with a relative variance below K over that, whatever paths there are.
#include "techniques/metropolis/numbers.glsl"
#include "core/splat.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Candidates { Candidate candidate; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Chains { Chain chain; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Values { vec3 value; };

Candidates candidate_at(uint index) { return Candidates(unpack32(pack64(chain_table().candidates) + uint64_t(CANDIDATE_BYTES) * uint64_t(index))); }
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
    bool candidate; // for a chain to begin with
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

// The candidate as a path.
Proposal candidate_proposal(uint index) {
    Chain none;
    none.known = NONE;
    none.position = vec2(0.0);
    none.kind = 0u;
    return Proposal(Sampler(index, 0u, 0u, 0u), kind_of(decisions(index, 0u).x), true, true, none);
}

// The chain's next proposal: its first one is the candidate that it begins with.
Proposal chain_propose(uint index, uint mutation, float large_step) {
    Chain c = chain_at(index).chain;
    if (c.known == NONE) return Proposal(Sampler(c.candidate, 0u, 0u, 0u), c.kind, true, false, c);
    vec4 u = decisions(index, mutation);
    bool large = u.x < large_step;
    return Proposal(Sampler(index, mutation, 0u, large ? 0u : c.known), large ? kind_of(u.w) : c.kind, large, false, c);
}

// What a path brings, as the chains see it.
float brings(vec3 value) { return (value.x + value.y + value.z) * (1.0 / 3.0); }

// By how much a path that brings this is visited less often than in proportion to that; each visit counts for as much more.
float held_back(float brought) { return 1.0 + brought / chain_table().bound; }

// The layers of what a path brings.
vec3 layer_value(Estimate e, uint layer) { return LENGTH_LAYERS > 0u ? e.by_length[layer] : e.radiance; }

// What the host is to know of where a candidate is from: its kind, the kind of large steps that made it, and in 65535ths the part of their
// density there that is the last kind's.
uint candidate_source(uint kind, uint made_by, float by_last) { return kind | made_by << 8u | uint(by_last * 65535.0 + 0.5) << 16u; }

// Ends the estimate of a proposal, which stands for `share` of its like; what is not finite is dropped, counted and located.
void proposal_close(vec2 position, float share, uint sample_index, inout Estimate e) {
    e.radiance *= share;
    for (uint i = 0u; i < LENGTH_LAYERS; i++) e.by_length[i] *= share;
    if (brings(e.radiance) < INFINITY) return;
    uvec2 pixel = uvec2(clamp(position, vec2(0.0), vec2(frame.width - 1u, frame.height - 1u)));
    report_bad_sample(pixel.y * frame.width + pixel.x, sample_index);
    estimate_clear(e);
}

// Whole pixels by which filters reach into the image from beside it.
float image_border() { return ceil(max(filter_radius() - 0.5, 0.0)); }

// A position in the image and, where filters are wider than a pixel, the border from which they reach into it: uniform over
// `light_path_count` pixels.
vec2 image_place(vec2 u) {
    float border = image_border();
    return u * (vec2(frame.width, frame.height) + 2.0 * border) - border;
}

// Whether image_place comes there.
bool inside_image(vec2 position) {
    float border = image_border();
    return all(greaterThanEqual(position, vec2(-border))) && all(lessThan(position, vec2(frame.width, frame.height) + border));
}

// Adds what stands for a visit with this probability to the pixel there, layer by layer.
void visit_splat(vec2 position, vec2 u, float probability, float brought, uint sample_index, Estimate e) {
    ChainTable table = chain_table();
    if (!(brought > 0.0) || !(probability > 0.0)) return;
    vec3 weight = vec3(1.0);
    uint pixel = splat_pixel(position, u, weight);
    if (pixel == NONE) return;
    // Positions are uniform over `light_path_count` pixels, and all visits of this sample share what they bring.
    weight *= probability * held_back(brought) * table.normalisation * (float(frame.light_path_count) / (float(table.chains_of_sample) * float(table.mutations)));
    for (uint i = 0u; i < splat_layers(); i++) {
        vec3 value = layer_value(e, i);
        if (value != vec3(0.0)) splat(pixel, sample_index, i + 1u, value / brought * weight);
    }
}

// What became of a proposal.
struct Decision {
    bool mutated;  // it was a mutation: the candidate that a chain begins with is none
    bool accepted;
};

// Decides on a proposal that has been followed to its end: adds both paths to the film and moves the chain. `ratio` of what speaks for it
// to what speaks for the current path, by what they bring (Metropolis et al. 1953, Hastings 1970); `used` is what the chain is to know of it.
Decision chain_decide(uint index, uint mutation, Proposal p, vec2 position, uint used, float ratio, uint sample_index, Estimate e) {
    Chain c = p.from;
    bool begins = c.known == NONE;
    float proposed = brings(e.radiance);
    vec4 u = decisions(index, mutation);
    ratio *= held_back(c.brings) / held_back(proposed);
    float acceptance = begins || ratio >= 1.0 ? 1.0 : ratio;
    if (!begins) {
        vec4 pixels = uniform4(pcg4d(uvec4(index, mutation, NONE - 1u, frame.seed)));
        visit_splat(position, pixels.xy, acceptance, proposed, sample_index, e);
        Estimate current;
        current.radiance = value_at(index, 0u).value;
        for (uint i = 0u; i < LENGTH_LAYERS; i++) current.by_length[i] = value_at(index, i).value;
        visit_splat(c.position, pixels.zw, 1.0 - acceptance, c.brings, sample_index, current);
        if (p.large) {
            vec3 sum = vec3(c.sum), low = vec3(c.sum_low);
            add_compensated(sum, low, vec3(proposed / held_back(proposed)));
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
        c.brings = proposed;
        c.position = position;
    }
    chain_at(index).chain = c;
    return Decision(!begins, accepted);
}
