// An isotropic point of intensity I (W/sr): irradiance I / d^2 on a facing surface.

LightSample point_light_sample(Light light, vec3 p) {
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    float density = light.probability * distance2;
    return LightSample(wi, light.position, light.radiance / density, 1.0, true, false,
                       light.emission_probability * emission_pdf(light.position, -wi, 0.25 * INV_PI) / density);
}

EmittedRay point_light_emit(Light light, vec2 u) {
    EmittedRay e = no_emission();
    e.origin = light.position;
    if (!sample_core(light.position, u, e.direction)) e.direction = sample_sphere(u);
    e.pdf_w = emission_pdf(light.position, e.direction, 0.25 * INV_PI);
    e.power = light.radiance / (e.pdf_w * light.emission_probability);
    e.delta = true;
    return e;
}
