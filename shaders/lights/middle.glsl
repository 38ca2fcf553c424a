// Area lights as the first ray tracers had them: a point in the middle stands for all of the light.

// A triangle's point is its centroid, which sheds light by the cosine as the triangle does.
LightSample triangle_light_middle(Light light, vec3 p) {
    vec3 v0 = light.position, v1 = light.v1, v2 = light.v2;
    vec3 scaled_normal = triangle_normal(v0, v1, v2);
    float area2 = length(scaled_normal);
    vec3 normal = scaled_normal / area2;
    vec2 b = vec2(1.0 / 3.0);
    vec3 position = triangle_point(v0, v1, v2, b);
    vec3 d = position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    if (HAS_TEXTURED_LIGHTS) light.radiance *= triangle_light_factor(light, b);
    LightSample s = no_light();
    s.wi = wi;
    s.target = offset_origin(position, margin_on_triangle(normal, v0, v1, v2, position), normal, -wi);
    if (distance2 > 0.0) s.weight = light.radiance * (0.5 * area2 * max(-dot(wi, normal), 0.0) / (distance2 * light.probability));
    s.delta = true;
    return s;
}

// A sphere's is its centre, which sheds the same intensity in all directions. It is seen where the near side of the sphere is; from
// inside, where that shines inwards, there is no such side, and it is sampled as a whole.
LightSample sphere_light_middle(Light light, vec3 p, vec2 u) {
    float radius = light.v1.x;
    if (radius < 0.0) return sphere_light_sample(light, p, u);
    vec3 d = light.position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    if (HAS_TEXTURED_LIGHTS) light.radiance *= sphere_light_factor(light, -wi);
    LightSample s = no_light();
    s.wi = wi;
    s.target = offset_origin(light.position - radius * wi, margin_on_sphere(light.position, radius), -wi, -wi);
    if (distance2 > radius * radius) s.weight = light.radiance * (PI * radius * radius / (distance2 * light.probability));
    s.delta = true;
    return s;
}

// A sample of one light as light_sample has it, but of the `middle` of area lights; the background has none.
LightSample light_middle_sample(ReferencePoint r, vec4 u, out bool middle) {
    vec3 p = r.position;
    middle = false;
    if (background_chosen(u.x)) return background_sample(p, u);
    Light light;
    LightSample s = no_light();
    if (!light_choose(r, u, light)) return s;
    middle = !(HAS_DELTA_LIGHTS && is_delta_light(light));
    if (HAS_TRIANGLE_LIGHTS && light.kind == LIGHT_TRIANGLE) s = triangle_light_middle(light, p);
    if (HAS_SPHERE_LIGHTS && light.kind == LIGHT_SPHERE) s = sphere_light_middle(light, p, u.zw);
    if (HAS_DELTA_LIGHTS && is_delta_light(light)) s = delta_light_sample(light, p);
    return s;
}
