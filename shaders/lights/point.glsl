// An isotropic point of intensity I (W/sr): irradiance I / d^2 on a facing surface.

LightSample point_light_sample(Light light, vec3 p) {
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    return LightSample(d * inversesqrt(distance2), light.position, light.radiance / (light.probability * distance2), 1.0, true, false);
}
