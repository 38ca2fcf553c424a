// Parallel light from infinitely far, of given irradiance (W/m^2) on a facing surface.

LightSample directional_light_sample(Light light) {
    return LightSample(-light.v1, vec3(0.0), light.radiance / light.probability, 1.0, true, true);
}
