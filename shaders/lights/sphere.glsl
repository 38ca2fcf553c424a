// An emitting sphere: seen from outside, sampled uniformly over the solid angle of its cone; from inside (a negative
// radius turns its normal inwards), uniformly over its area.

// What textures leave of the radiance at a point of the sphere.
vec3 sphere_light_factor(Light light, vec3 outward) {
    Interaction at;
    sphere_uv(Primitive(light.position, light.v1, light.v2, SPHERE_BIT), outward, at);
    return emission_factor(load_surface(light.source), place_at(at.uv), 1.0);
}

LightSample sphere_light_sample(Light light, vec3 p, vec2 u) {
    float radius = light.v1.x;
    float radius2 = radius * radius;
    vec3 axis = light.position - p;
    float distance2 = dot(axis, axis);
    vec3 outward;
    float pdf_w;
    bool lit;
    vec3 position;
    float margin = margin_on_sphere(light.position, radius);
    float emitted = light.emission_probability / (4.0 * PI * radius2); // per area
    if (radius > 0.0) {
        float cone = sphere_cone(radius2, distance2);
        float one_minus_cos = u.x * cone;
        float sin2 = one_minus_cos * (2.0 - one_minus_cos);
        float cos_theta = 1.0 - one_minus_cos;
        float distance = sqrt(distance2);
        float phi = 2.0 * PI * u.y;
        float sin_theta = sqrt(sin2);
        vec3 wi = to_world(basis_from_normal(axis / distance), vec3(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta));
        float along = distance * cos_theta - sqrt(max(0.0, radius2 - distance2 * sin2));
        outward = normalize(along * wi - axis);
        pdf_w = light.probability / (2.0 * PI * cone);
        position = light.position + abs(radius) * outward;
        lit = distance2 > radius2;
        float cos_light = max(-dot(wi, outward), 1e-6);
        emitted *= surface_emission_pdf(position, -wi, cos_light) / cos_light;
        if (HAS_TEXTURED_LIGHTS) light.radiance *= sphere_light_factor(light, outward);
        return LightSample(wi, offset_origin(position, margin, outward, -wi), lit ? light.radiance / pdf_w : vec3(0.0),
                           lit ? pdf_w : 0.0, false, false, lit ? emitted / pdf_w : 0.0);
    }
    outward = sample_sphere(u);
    position = light.position + abs(radius) * outward;
    vec3 d = position - p;
    float d2 = dot(d, d);
    vec3 wi = d * inversesqrt(d2);
    float cos_light = dot(wi, outward);
    pdf_w = light.probability * d2 / (4.0 * PI * radius2 * cos_light);
    lit = cos_light > 0.0 && d2 > 0.0;
    emitted *= surface_emission_pdf(position, -wi, cos_light) / cos_light;
    if (HAS_TEXTURED_LIGHTS) light.radiance *= sphere_light_factor(light, outward);
    return LightSample(wi, offset_origin(position, margin, outward, -wi), lit ? light.radiance / pdf_w : vec3(0.0),
                       lit ? pdf_w : 0.0, false, false, lit ? emitted / pdf_w : 0.0);
}

// Density of the above where a ray from p met the sphere; `probability` is that of selecting it.
float sphere_light_pdf(vec3 centre, float radius, vec3 p, Interaction at, float probability, vec3 wi) {
    float radius2 = radius * radius;
    if (radius > 0.0) {
        vec3 axis = centre - p;
        return probability / (2.0 * PI * sphere_cone(radius2, dot(axis, axis)));
    }
    vec3 d = at.position - p;
    return probability * dot(d, d) / (4.0 * PI * radius2 * abs(dot(wi, at.normal)));
}

EmittedRay sphere_light_emit(Light light, vec2 u, vec2 v) {
    float radius = light.v1.x;
    vec3 outward = sample_sphere(u);
    if (HAS_TEXTURED_LIGHTS) light.radiance *= sphere_light_factor(light, outward);
    vec3 position = light.position + abs(radius) * outward;
    return surface_emit(light, position, margin_on_sphere(light.position, radius), radius < 0.0 ? -outward : outward, 4.0 * PI * radius * radius, v);
}
