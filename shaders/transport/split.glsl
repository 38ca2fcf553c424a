// A vertex where broad lobes and narrow ones are told apart (materials/lobes.glsl): next-event estimation for each class by itself, and the sample by
// which the path goes on. Narrow lobes are followed, so that their light samples compete with them.
#include "transport/nee.glsl"

// A vertex connected to a sample of the lights, by class of lobes.
struct SplitEvent {
    NextEvent broad, narrow;
};

// Connects the vertex to the light sample; without `connects` only closes the BSDF's sample. All are evaluated by the same code, in turns.
SplitEvent split_connect(Path path, Vertex v, Bsdf b, LightSample light, bool connects, inout BsdfSample s) {
    NextEvent n = NextEvent(light, vertex_to_local(v, light.wi), vec3(0.0), 0.0);
    SplitEvent both = SplitEvent(n, n);
    for (uint turn = 0u; turn < turns(3u); turn++) {
        bool wanted = connects && bsdf_has_broad(b);
        if (turn == 1u) wanted = connects && bsdf_has_narrow(b);
        if (turn == 2u) wanted = HAS_OPEN_SAMPLES && s.open;
        if (!wanted) continue;
        Bsdf lobes = broad_lobes(b);
        if (turn == 1u) lobes = narrow_lobes(b);
        if (turn == 2u) lobes = sampled_lobes(b, s);
        vec3 w = turn == 2u ? s.wi : n.wi;
        n.f = bsdf_eval(lobes, v.wo, w);
        n.pdf_w = bsdf_pdf(lobes, v.wo, w);
        if (turn == 0u) both.broad = n;
        else if (turn == 1u) both.narrow = n;
        else bsdf_closed(s, n.f, n.pdf_w);
    }
    vertex_check(v, path.ray, s);
    float passage = vertex_passage(v, path.ray, n.wi, light.wi);
    both.broad.f *= passage;
    both.narrow.f *= passage;
    return both;
}

// The contribution of both classes with its visibility, broad lobes with this weight.
vec3 split_contribution(Path path, Vertex v, Bsdf b, SplitEvent both, float broad_weight, float narrow_weight, inout uint rays) {
    NextEvent n = both.broad;
    n.f = both.broad.f * broad_weight + both.narrow.f * narrow_weight;
    return nee_contribution(path, v, b, n, path.throughput, 1.0, rays);
}
