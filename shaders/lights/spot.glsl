// A point with a cone: full intensity within the beam width, falling linearly with the angle to zero at the cut-off,
// which is what Mitsuba's `spot` means; or, where v2.z is 1, with the square of the way that the cosine has come, which is
// what glTF recommends (KHR_lights_punctual, "Inner and Outer Cone Angles"). A texture spans the cut-off cone.

LightSample spot_light_sample(Light light, vec3 p) {
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    float cutoff = light.v2.x;
    float beam = light.v2.y;
    float angle = angle_between(-wi, light.v1);
    float falloff = angle <= beam ? 1.0 : clamp((cutoff - angle) / (cutoff - beam), 0.0, 1.0);
    if (light.v2.z != 0.0) {
        float edge = cos(cutoff);
        float way = clamp((-dot(wi, light.v1) - edge) / max(0.001, cos(beam) - edge), 0.0, 1.0);
        falloff = way * way;
    }
    if (HAS_PROJECTORS && light.source != NONE) {
        vec3 local = light_space(light, -wi);
        vec2 uv = 0.5 + 0.5 * local.xy / (local.z * tan(cutoff));
        light.radiance *= local.z > 0.0 ? texture_at(light.source, uv).rgb : vec3(0.0);
    }
    return LightSample(wi, light.position, light.radiance * (falloff / (light.probability * distance2)), 1.0, true, false);
}
