// A point that projects an image of given irradiance (W/m^2) on the plane at distance one along its axis: intensity
// E / cos^3, so E / (z^2 cos) on a facing surface at depth z.

// Density over solid angle of light subpaths, uniform over the image on the plane at distance one, given the cosine to the axis.
float projector_pdf(Light light, float cosine) { return 1.0 / (4.0 * light.v2.x * light.v2.y * cosine * cosine * cosine); }

LightSample projector_light_sample(Light light, vec3 p) {
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    vec3 local = light_space(light, -wi);
    // As a camera there would see it: +x of the light's space is left in the image, +y up. v2: tangents of half the angles.
    vec2 uv = 0.5 - 0.5 * local.xy / (local.z * light.v2.xy);
    bool lit = local.z > 0.0 && all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0)));
    vec3 irradiance = lit ? light.radiance * texture_at(light.source, place_at(uv)).rgb / (distance2 * local.z * local.z * local.z) : vec3(0.0);
    return LightSample(wi, light.position, irradiance / light.probability, 1.0, true, false,
                       light.emission_probability * projector_pdf(light, local.z) / (light.probability * distance2));
}

EmittedRay projector_light_emit(Light light, vec2 u) {
    EmittedRay e = no_emission();
    vec3 local = normalize(vec3((1.0 - 2.0 * u) * light.v2.xy, 1.0));
    e.origin = light.position;
    Floats f = Floats(scene.tables);
    uint i = light.corners.x;
    e.direction = local.x * vec3(f.at[i], f.at[i + 1u], f.at[i + 2u]) + local.y * vec3(f.at[i + 3u], f.at[i + 4u], f.at[i + 5u]) +
                  local.z * vec3(f.at[i + 6u], f.at[i + 7u], f.at[i + 8u]);
    e.pdf_w = projector_pdf(light, local.z);
    // Irradiance times area of the image: intensity E / cos^3 over the density.
    e.power = light.radiance * texture_at(light.source, place_at(u)).rgb * (4.0 * light.v2.x * light.v2.y / light.emission_probability);
    e.delta = true;
    return e;
}
