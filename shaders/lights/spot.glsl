// A point with a cone: full intensity within the beam width, falling linearly with the angle to zero at the cut-off,
// which is what Mitsuba's `spot` means; or, where v2.z is 1, with the square of the way that the cosine has come, which is
// what glTF recommends (KHR_lights_punctual, "Inner and Outer Cone Angles"). A texture spans the cut-off cone.

// Intensity in a direction away from the light.
vec3 spot_intensity(Light light, vec3 away) {
    float cutoff = light.v2.x;
    float beam = light.v2.y;
    float angle = angle_between(away, light.v1);
    float falloff = angle <= beam ? 1.0 : clamp((cutoff - angle) / (cutoff - beam), 0.0, 1.0);
    if (light.v2.z != 0.0) {
        float edge = cos(cutoff);
        float way = clamp((dot(away, light.v1) - edge) / max(1e-6, cos(beam) - edge), 0.0, 1.0);
        falloff = way * way;
    }
    if (HAS_TEXTURED_SPOTS && light.source != NONE) {
        vec3 local = light_space(light, away);
        vec2 uv = 0.5 + 0.5 * local.xy / (local.z * tan(cutoff));
        light.radiance *= local.z > 0.0 ? texture_at(light.source, place_at(uv)).rgb : vec3(0.0);
    }
    return light.radiance * falloff;
}

// Density over solid angle of light subpaths: uniform over the cut-off cone, whose 1 - cos is written without cancellation.
float spot_pdf(Light light) {
    float s = sin(0.5 * light.v2.x);
    return 1.0 / (4.0 * PI * s * s);
}

LightSample spot_light_sample(Light light, vec3 p) {
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    float density = light.probability * distance2;
    return LightSample(wi, light.position, spot_intensity(light, -wi) / density, 1.0, true, false,
                       light.emission_probability * spot_pdf(light) / density);
}

EmittedRay spot_light_emit(Light light, vec2 u) {
    EmittedRay e = no_emission();
    float s = sin(0.5 * light.v2.x);
    float one_minus_cos = 2.0 * s * s * u.x;
    float sine = sqrt(one_minus_cos * (2.0 - one_minus_cos));
    float phi = 2.0 * PI * u.y;
    e.origin = light.position;
    e.direction = to_world(basis_from_normal(light.v1), vec3(sine * cos(phi), sine * sin(phi), 1.0 - one_minus_cos));
    e.pdf_w = spot_pdf(light);
    e.power = spot_intensity(light, e.direction) / (e.pdf_w * light.emission_probability);
    e.delta = true;
    return e;
}
