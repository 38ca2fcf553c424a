// Next-event estimation, and the BSDF's own choice of a direction, which it is weighted against.

// The light of a sample of the lights that the vertex scatters along the path, times `carried`, weighted against the chance that the BSDF picks
// that direction; nothing from a BSDF of mirrors alone. A sample of the BSDF that was left open is closed on the way: both directions
// are evaluated by the same code, in turns.
vec3 next_event(Path path, Vertex v, Bsdf b, vec3 carried, vec4 u, inout BsdfSample s, inout uint rays) {
    bool aims = !bsdf_is_delta(b);
    LightSample light = no_light();
    vec3 wi = vec3(0.0), f = vec3(0.0);
    float pdf_w = 0.0;
    if (aims) {
        light = light_sample(vertex_receiver(v, b), u);
        wi = vertex_to_local(v, light.wi);
    }
    for (uint turn = 0u; turn < (HAS_OPEN_SAMPLES ? turns(2u) : 1u); turn++) {
        bool onwards = HAS_OPEN_SAMPLES && turn > 0u;
        if (!(onwards ? s.open : aims)) continue;
        vec3 w = onwards ? s.wi : wi;
        vec3 value = bsdf_eval(b, v.wo, w);
        float found = bsdf_pdf(b, v.wo, w);
        if (onwards) {
            s.weight = found > 0.0 ? value / found : vec3(0.0);
            s.pdf_w = found;
            s.open = false;
        } else {
            f = value;
            pdf_w = found;
        }
    }
    vertex_check(v, path.ray, s);
    if (!aims || !vertex_scatters(v, path.ray, wi, light.wi)) return vec3(0.0);
    float weight = light.delta ? 1.0 : power_heuristic(light.pdf_w, pdf_w);
    vec3 radiance = carried * f * light.weight * weight;
    return radiance == vec3(0.0) ? radiance : radiance * vertex_transmittance(v, light, vertex_absorption(v, b, path.absorption, wi), rays);
}
