// Next-event estimation: a vertex is connected to a sample of the lights (Kajiya 1986; Shirley, Wang and Zimmerman 1996). The stages are
// choosing the sample, evaluating the BSDF towards it, and tracing the shadow ray; a technique supplies only the weight.
#include "transport/path.glsl"

// A vertex connected to a sample of the lights, before its visibility is known.
struct NextEvent {
    LightSample light;
    vec3 wi;     // local direction to the light
    vec3 f;      // f |cos| towards there; nothing where the BSDF is a delta alone
    float pdf_w; // solid angle density with which the BSDF picks that direction
};

// The ray from a surface point to the light sample, without its end points.
Ray shadow_ray(Interaction at, LightSample light) {
    vec3 origin = offset_origin(at.position, at.margin, at.normal, light.wi);
    return light.distant ? Ray(origin, light.wi, INFINITY) : ray_between(origin, light.target);
}

// Contribution of a connection to the light sample along f |cos|, unweighted and unoccluded; `carried` is the throughput of the path.
vec3 nee_unoccluded(vec3 carried, vec3 f, LightSample light) { return carried * f * light.weight; }

// Connects the vertex to the light sample. A sample of the BSDF that was left open is closed on the way: both directions are evaluated
// by the same code, in turns, so that the kernel holds the BSDF once.
NextEvent nee_connect(Path path, Vertex v, Bsdf b, LightSample light, inout BsdfSample s) {
    NextEvent n = NextEvent(light, vertex_to_local(v, light.wi), vec3(0.0), 0.0);
    bool connects = !bsdf_is_delta(b);
    for (uint turn = 0u; turn < (HAS_OPEN_SAMPLES ? turns(2u) : 1u); turn++) {
        bool onwards = HAS_OPEN_SAMPLES && turn > 0u;
        if (!(onwards ? s.open : connects)) continue;
        vec3 w = onwards ? s.wi : n.wi;
        vec3 f = bsdf_eval(b, v.wo, w);
        float pdf_w = bsdf_pdf(b, v.wo, w);
        if (onwards) {
            bsdf_closed(s, f, pdf_w);
        } else {
            n.f = f;
            n.pdf_w = pdf_w;
        }
    }
    vertex_check(v, path.ray, s);
    if (v.mapped) n.f *= vertex_passage(v, path.ray, n.wi, light.wi);
    return n;
}

// A sample of the lights as the vertex sees them, connected; none where the BSDF is a delta alone, which no sample of them hits.
NextEvent nee_sample(Path path, Vertex v, Bsdf b, vec4 u, inout BsdfSample s) {
    LightSample light = no_light();
    if (!bsdf_is_delta(b)) light = light_sample(vertex_reference(v, b), u);
    return nee_connect(path, v, b, light, s);
}

// MIS weight of the light sample against the BSDF's choice of its direction (power heuristic; Veach 1997, section 9.2.3).
float nee_weight(NextEvent n) { return n.light.delta ? 1.0 : power_heuristic(n.light.pdf_w, n.pdf_w); }

// Records a light sample, its weight, and the share of it that comes through.
void record_light_sample(Path path, Vertex v, NextEvent n, float weight, vec3 through) {
    if (!records(RECORD_LIGHT_SAMPLE) || n.light.pdf_w == 0.0) return;
    PathRecord r = record_of(RECORD_LIGHT_SAMPLE, path.depth + 1u);
    r.position = n.light.distant ? v.at.position : n.light.target;
    r.direction = n.light.wi;
    r.value = n.f;
    r.throughput = n.light.weight * through;
    r.pdf = n.light.pdf_w;
    r.other_pdf = n.pdf_w;
    r.weight = weight;
    r.probability = (through.x + through.y + through.z) / 3.0;
    r.flags = (n.light.delta ? RECORDED_DELTA : 0u) | (n.light.distant ? RECORDED_DISTANT : 0u);
    record_append(r);
}

// The weighted contribution with its visibility: traces the shadow ray unless there is nothing to lose.
vec3 nee_contribution(Path path, Vertex v, Bsdf b, NextEvent n, vec3 carried, float weight, inout uint rays) {
    vec3 contribution = nee_unoccluded(carried, n.f, n.light) * weight, through = vec3(0.0);
    if (contribution != vec3(0.0)) through = ray_transmittance(shadow_ray(v.at, n.light), false, vertex_absorption(v, b, path.absorption, n.wi), rays);
    record_light_sample(path, v, n, weight, through);
    return contribution * through;
}
