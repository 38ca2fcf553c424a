// A point that projects an image of given irradiance (W/m^2) on the plane at distance one along its axis: intensity
// E / cos^3, so E / (z^2 cos) on a facing surface at depth z.

LightSample projector_light_sample(Light light, vec3 p) {
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    vec3 local = light_space(light, -wi);
    // As a camera there would see it: +x of the light's space is left in the image, +y up. v2: tangents of half the angles.
    vec2 uv = 0.5 - 0.5 * local.xy / (local.z * light.v2.xy);
    bool lit = local.z > 0.0 && all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0)));
    vec3 irradiance = lit ? light.radiance * texture_at(light.source, uv).rgb / (distance2 * local.z * local.z * local.z) : vec3(0.0);
    return LightSample(wi, light.position, irradiance / light.probability, 1.0, true, false);
}
