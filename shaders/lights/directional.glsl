// Parallel light from infinitely far, of given irradiance (W/m^2) on a facing surface.

LightSample directional_light_sample(Light light, vec3 p) {
    return LightSample(-light.v1, vec3(0.0), light.radiance / light.probability, 1.0, true, true,
                       light.emission_probability * disk_pdf(p, light.v1) / light.probability);
}

EmittedRay directional_light_emit(Light light, vec2 u) {
    EmittedRay e = no_emission();
    e.direction = light.v1;
    e.origin = disk_origin(e.direction, u);
    e.pdf_a = disk_pdf(e.origin, e.direction);
    e.power = light.radiance / (e.pdf_a * light.emission_probability);
    e.delta = true;
    e.distant = true;
    return e;
}
