// An isotropic point of intensity I (W/sr): irradiance I / d^2 on a facing surface.

LightSample point_light_sample(Light light, vec3 p) {
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    return LightSample(d * inversesqrt(distance2), light.position, light.radiance / (light.probability * distance2), 1.0, true, false,
                       light.emission_probability * 0.25 * INV_PI / (light.probability * distance2));
}

EmittedRay point_light_emit(Light light, vec2 u) {
    EmittedRay e = no_emission();
    e.origin = light.position;
    e.direction = sample_sphere(u);
    e.power = light.radiance * (4.0 * PI / light.emission_probability);
    e.pdf_w = 0.25 * INV_PI;
    e.delta = true;
    return e;
}
