// The one place that knows all lights: choosing one, sampling it as seen from a point, and the density of that when a
// path hits a light by itself.
#include "core/basis.glsl"
#include "core/sampling.glsl"
#include "core/texture.glsl"
#include "materials/opacity.glsl"

struct LightSample {
    vec3 wi;      // unit direction from the reference point to the light
    vec3 target;  // the point to see, moved off the light's own surface
    vec3 weight;  // radiance / pdf_w; of a delta light, the irradiance on a facing surface / probability
    float pdf_w;  // over solid angle at the reference point, selection included
    bool delta;   // no direction hits this light by chance
    bool distant; // the light is infinitely far in the direction wi
    float emitted; // density of a light subpath that begins with this segment (per area and solid angle), over pdf_w and the cosine at
                   // the light: what paths from the light are weighed against
};

LightSample no_light() { return LightSample(vec3(0.0, 0.0, 1.0), vec3(0.0), vec3(0.0), 0.0, false, false, 0.0); }

// What the textures of a surface leave of its emission: what it lets through, it does not emit.
vec3 emission_factor(Surface surface, TexturePlace place, float alpha) {
    float opacity = surface_opacity(surface, place, alpha);
    return surface.emission_texture == NONE ? vec3(opacity) : opacity * texture_at(surface.emission_texture, place).rgb;
}

// A world direction in the light's own frame, whose +z is its axis.
vec3 light_space(Light light, vec3 w) {
    Floats f = Floats(scene.tables);
    uint i = light.corners.x;
    return vec3(dot(w, vec3(f.at[i], f.at[i + 1u], f.at[i + 2u])), dot(w, vec3(f.at[i + 3u], f.at[i + 4u], f.at[i + 5u])),
                dot(w, vec3(f.at[i + 6u], f.at[i + 7u], f.at[i + 8u])));
}

#include "lights/emit.glsl"
#include "lights/light_tree.glsl"
// The lights but for the background, and the branches by kind, from the list in src/layout/lights.rs.
#include "generated/lights.glsl"
#include "lights/background.glsl"

// It has no extent, or no spread of directions: no path from elsewhere runs into it.
bool is_delta_light(Light light) { return IS_DELTA_LIGHT(light); }

// Such a light as seen from a point: there is one way only.
LightSample delta_light_sample(Light light, vec3 p) {
    LightSample s = no_light();
    SAMPLE_DELTA_LIGHT(s, light, p)
    return s;
}

// Whether a uniform number chooses the background, after which it is uniform again.
bool background_chosen(inout float u) {
    if (!HAS_BACKGROUND) return false;
    float share = scene.background_probability;
    bool chosen = u < share;
    u = chosen ? u / share : (u - share) / (1.0 - share);
    return chosen;
}

// Lights of which the number that places a sample can choose one as well and keep enough bits.
const uint FEW_LIGHTS = 64u;

// An entry of an alias table of the lights, each as likely (Walker 1974). Of few lights u.z chooses it, and its rest is uniform again: where the
// pair u.zw is spread evenly over the unit square, it is so over the samples of each light; u.y gives it the bits that it lacks then. Of many, u.x.
uint light_entry(inout vec4 u, uint count) {
    bool few = count <= FEW_LIGHTS;
    float place = (few ? u.z : u.x) * float(count);
    uint index = min(count < 1u << 23u ? whole(place) : uint(place), count - 1u);
    if (few) u.z = min(place - float(index) + u.y * (float(count) / 16777216.0), 0.99999994);
    return index;
}

// Whether the entry's alias is taken rather than its own light, which is kept with this probability: by the rest of u.z, which is uniform after it,
// or of many lights by u.y.
bool light_alias(inout vec4 u, uint count, float keep) {
    if (count > FEW_LIGHTS) return u.y >= keep;
    bool alias = u.z >= keep;
    u.z = min(alias ? (u.z - keep) / (1.0 - keep) : u.z / keep, 0.99999994);
    return alias;
}

// One of all other lights, chosen from the alias table or the tree, with the probability of that; false where there is none. u.zw is
// uniform after it.
bool light_choose(ReferencePoint r, inout vec4 u, out Light light) {
    uint count = HAS_LIGHT_TREE ? scene.table_lights : light_count();
    bool from_tree = HAS_LIGHT_TREE && u.x >= scene.table_probability;
    if (count == 0u && !from_tree) return false;
    uint index = 0u;
    float selection = 1.0;
    if (HAS_LIGHT_TREE) {
        float share = scene.table_probability;
        if (from_tree) index = light_tree_sample(r, vec2((u.x - share) / (1.0 - share), u.y), selection);
        else u.x /= share;
        if (selection == 0.0) return false;
    }
    if (!from_tree && count > 1u) {
        index = light_entry(u, count);
        Light drawn = load_light(index);
        if (light_alias(u, count, drawn.keep)) index = drawn.alias;
    }
    light = load_light(index);
    if (HAS_LIGHT_TREE) light.probability *= selection;
    return true;
}

// A sample of one light: u chooses it, and u.zw places the sample on it.
LightSample light_sample(ReferencePoint r, vec4 u) {
    vec3 p = r.position;
    if (background_chosen(u.x)) return background_sample(p, u);
    Light light;
    LightSample s = no_light();
    if (!light_choose(r, u, light)) return s;
    SAMPLE_AREA_LIGHT(s, light, p, u.zw)
    if (HAS_DELTA_LIGHTS && is_delta_light(light)) s = delta_light_sample(light, p);
    return s;
}

// Density over solid angle with which light_sample picks the emitting point that a ray from the reference point in this direction hit.
float light_pdf(ReferencePoint r, Ray ray, Hit hit, Interaction at, Surface surface) {
    // The two sides of a triangle are two lights.
    bool behind = HAS_LIGHTS_BEHIND && dot(ray.direction, at.normal) > 0.0;
    if (HAS_LIGHT_TREE) surface.light_density *= light_tree_probability(r, behind ? surface.light_trail_behind : surface.light_trail);
    vec3 p = r.position;
    Primitive primitive;
    if (HAS_SPHERE_LIGHTS || HAS_LARGE_LIGHTS) primitive = load_primitive(hit.primitive);
    if (HAS_LARGE_LIGHTS && behind) {
        vec3 v1 = primitive.v1;
        primitive.v1 = primitive.v2;
        primitive.v2 = v1;
    }
    if (HAS_SPHERE_LIGHTS) {
        if (is_sphere(primitive)) return sphere_light_pdf(primitive.v0, primitive.v1.x, p, at, surface.light_density, ray.direction);
    }
    return triangle_light_pdf(primitive, p, at, surface.light_density, ray.direction);
}

// The beginning of a light subpath, of a light chosen by its power: u chooses it, u.zw places the beginning, v.xy the direction.
EmittedRay light_emit(vec4 u, vec4 v) {
    if (HAS_BACKGROUND) {
        if (u.x < scene.background_probability) return background_emit(u, v);
        u.x = (u.x - scene.background_probability) / (1.0 - scene.background_probability);
    }
    uint count = light_count();
    if (count == 0u) return no_emission();
    uint index = light_entry(u, count);
    if (count > 1u && light_alias(u, count, load_light(index).emission_keep)) index = load_light(index).emission_alias;
    Light light = load_light(index);
    EmittedRay e = no_emission();
    EMIT_LIGHT(e, light, u.zw, v.xy)
    e.light = index;
    if (HAS_ABSORPTION) e.absorption = light.absorption;
    return e;
}

// Density with which light_sample at the reference point would have picked the beginning of a light subpath that arrived there, over the
// density of that beginning, for the cosine at the reference point: in squares of the scene's radius. `distance2` lies between them.
float light_choice_ratio(EmittedRay e, ReferencePoint r, float distance2) {
    float unit = 1.0 / (scene.radius * scene.radius);
    if (HAS_BACKGROUND && e.light == NONE) return unit / e.pdf_a;
    Light light = load_light(e.light);
    float selection = HAS_LIGHT_TREE && e.light >= scene.table_lights ? light_tree_probability(r, light.trail) : 1.0;
    if (e.distant) return selection * light.probability * unit / (light.emission_probability * e.pdf_a);
    if (e.delta) return selection * light.probability * distance2 * unit / (light.emission_probability * e.pdf_w);
    Interaction at;
    at.position = e.position;
    at.normal = e.normal;
    vec3 wi = -e.direction;
    float pdf_w = 0.0;
    if (HAS_SPHERE_LIGHTS && light.kind == LIGHT_SPHERE) pdf_w = sphere_light_pdf(light.position, light.v1.x, r.position, at, light.probability * selection, wi);
    if (HAS_TRIANGLE_LIGHTS && light.kind == LIGHT_TRIANGLE) {
        float area = 0.5 * length(triangle_normal(light.position, light.v1, light.v2));
        pdf_w = triangle_light_pdf(Primitive(light.position, light.v1, light.v2, 0u), r.position, at, light.probability * selection / area, wi);
    }
    return pdf_w * e.d_vc;
}
