// A triangle that emits from its front, sampled uniformly over its area, or over its solid angle where that is large.
#include "lights/spherical_triangle.glsl"

// What textures leave of the radiance at a point of the triangle.
vec3 triangle_light_factor(Light light, vec2 b) {
    Vectors2 uvs = Vectors2(scene.uvs);
    vec2 uv = light.corners.x == NONE ? b : (1.0 - b.x - b.y) * uvs.at[light.corners.x] + b.x * uvs.at[light.corners.y] + b.y * uvs.at[light.corners.z];
    float alpha = 1.0;
    if (HAS_ALPHA_COLOURS && scene.colours != uvec2(0u) && light.corners.x != NONE) {
        Vectors4 colours = Vectors4(scene.colours);
        alpha = (1.0 - b.x - b.y) * colours.at[light.corners.x].a + b.x * colours.at[light.corners.y].a + b.y * colours.at[light.corners.z].a;
    }
    TexturePlace place = place_at(uv);
    if (HAS_SECOND_UVS) place = TexturePlace(uv, light.corners, vec3(1.0 - b.x - b.y, b));
    return emission_factor(load_surface(light.source), place, alpha); // attributes do not emit: scene/compile/attributes.rs
}

LightSample triangle_light_sample(Light light, vec3 p, vec2 u) {
    vec3 v0 = light.position, v1 = light.v1, v2 = light.v2;
    vec3 scaled_normal = triangle_normal(v0, v1, v2);
    float area2 = length(scaled_normal);
    vec3 normal = scaled_normal / area2;
    float solid_angle = HAS_LARGE_LIGHTS ? triangle_solid_angle(scaled_normal, v0, v1, v2, p) : 0.0;
    bool by_area = solid_angle < LEAST_SOLID_ANGLE;
    vec2 b = by_area ? sample_triangle(u) : sample_spherical_triangle(solid_angle, scaled_normal, v0, v1, v2, p, u);
    vec3 position = triangle_point(v0, v1, v2, b);
    vec3 d = position - p;
    float distance2 = dot(d, d);
    vec3 wi = d * inversesqrt(distance2);
    float cos_light = -dot(wi, normal);
    // area to solid angle: pdf_w = pdf_a d^2 / cos (Veach 1997, section 8.2.2.2)
    float pdf_w = light.probability * (by_area ? distance2 / (0.5 * area2 * cos_light) : 1.0 / solid_angle);
    bool lit = cos_light > 0.0 && distance2 > 0.0;
    if (HAS_TEXTURED_LIGHTS) light.radiance *= triangle_light_factor(light, b);
    float emitted = surface_emission_pdf(position, -wi, cos_light) / cos_light * light.emission_probability / (0.5 * area2);
    return LightSample(wi, offset_origin(position, margin_on_triangle(normal, v0, v1, v2, position), normal, -wi), lit ? light.radiance / pdf_w : vec3(0.0),
                       lit ? pdf_w : 0.0, false, false, lit ? emitted / pdf_w : 0.0);
}

// Density of the above where a ray from p met the emitting triangle `t`; density_a is per area, selection included.
float triangle_light_pdf(Primitive t, vec3 p, Interaction at, float density_a, vec3 wi) {
    if (HAS_LARGE_LIGHTS) {
        vec3 scaled_normal = triangle_normal(t.v0, t.v1, t.v2);
        float solid_angle = triangle_solid_angle(scaled_normal, t.v0, t.v1, t.v2, p);
        if (solid_angle >= LEAST_SOLID_ANGLE) return density_a * 0.5 * length(scaled_normal) / solid_angle;
    }
    vec3 d = at.position - p;
    return density_a * dot(d, d) / abs(dot(wi, at.normal));
}

EmittedRay triangle_light_emit(Light light, vec2 u, vec2 v) {
    vec3 v0 = light.position, v1 = light.v1, v2 = light.v2;
    vec3 scaled_normal = triangle_normal(v0, v1, v2);
    float area2 = length(scaled_normal);
    vec2 b = sample_triangle(u);
    if (HAS_TEXTURED_LIGHTS) light.radiance *= triangle_light_factor(light, b);
    vec3 position = triangle_point(v0, v1, v2, b);
    vec3 normal = scaled_normal / area2;
    return surface_emit(light, position, margin_on_triangle(normal, v0, v1, v2, position), normal, 0.5 * area2, v);
}
