// Parallel light from infinitely far, of given irradiance (W/m^2) on a facing surface.

LightSample directional_light_sample(Light light) {
    return LightSample(-light.v1, vec3(0.0), light.radiance / light.probability, 1.0, true, true,
                       light.emission_probability / (light.probability * disk_area()));
}

EmittedRay directional_light_emit(Light light, vec2 u) {
    EmittedRay e = no_emission();
    e.direction = light.v1;
    e.origin = disk_origin(e.direction, u);
    e.power = light.radiance * (disk_area() / light.emission_probability);
    e.delta = true;
    e.distant = true;
    return e;
}
