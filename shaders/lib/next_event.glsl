// Next-event estimation: the light of a sample of the lights that the vertex scatters along the path, times `carried`, weighted against
// the chance that the BSDF picks that direction. A BSDF of mirrors alone has none.
vec3 next_event(Path path, Vertex v, Bsdf b, vec3 carried, vec4 u, inout uint rays) {
    if (bsdf_is_delta(b)) return vec3(0.0);
    LightSample light = light_sample(vertex_receiver(v, b), u);
    vec3 wi = vertex_to_local(v, light.wi);
    float weight = light.delta ? 1.0 : power_heuristic(light.pdf_w, bsdf_pdf(b, v.wo, wi));
    vec3 radiance = carried * vertex_eval(v, b, path.ray, wi, light.wi) * light.weight * weight;
    return radiance == vec3(0.0) ? radiance : radiance * vertex_transmittance(v, light, vertex_absorption(v, b, path.absorption, wi), rays);
}
