// The passes of radiosity over patches and their vertices.
#include "techniques/radiosity/gather.glsl"

layout(local_size_x = WORKGROUP) in;

// Numbers of a patch's ray. Rounds that follow each other draw from sequences of their own: what comes back to a patch after two or three
// rounds must not have met the same points of a sequence.
const uint SEQUENCES = 4u;
const uint DIMENSIONS = 16u; // more than a ray draws, masks on its way left out
Sampler patch_numbers(uint index, uint ray) {
    uint round = round_index();
    uint seed = frame.seed ^ (round_prepares() ? 0x3c6ef372u : 0x9e3779b9u);
    return Sampler(index, round / SEQUENCES * frame.sample_count + ray, round % SEQUENCES * DIMENSIONS, seed);
}

#ifdef PASS_ALBEDO
// The mean of what the material returns, over the patch and over directions with the density cos / pi.
void patch_albedo(PatchTable t, uint index) {
    Patch p = Patches(t.patches).at[index];
    PatchFace f = PatchFaces(t.faces).at[p.face];
    Primitive primitive = load_primitive(f.primitive);
    bool triangle = face_is_triangle(f, primitive);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < frame.sample_count; i++) {
        Sampler random = Sampler(index, i, 0u, 0xa54ff53au);
        vec4 u = next4_spread(random);
        vec4 bsdf_u = next4_spread(random);
        vec2 c = patch_coordinates(p, triangle, u.xy);
        Hit hit = face_hit(f, primitive, c);
        vec3 normal = vertex_at(face_ray(f, primitive, c, vec3(0.0, 0.0, 1.0)), hit).at.shading_normal;
        vec3 wo = to_world(basis_from_normal(p.back != 0u ? -normal : normal), sample_cosine_hemisphere(u.zw));
        Ray ray = face_ray(f, primitive, c, -wo);
        Vertex v = vertex_at(ray, hit);
        if (v.material == NONE) continue;
        Bsdf b = vertex_material(v, ray, random);
        BsdfSample s = power_sample(v, b, ray, bsdf_u.xyz);
        sum += s.weight * (s.eta * s.eta);
    }
    Values(t.albedo).at[index] = clamp(sum / float(frame.sample_count), 0.0, 1.0);
}
#endif

#ifdef PASS_GATHER
// Adds the irradiance that one ray gathers to the layers that this round writes.
void patch_receive(PatchTable t, uint index, Gathered g, float share) {
    uint from = round_index() & 1u, to = from ^ 1u;
    vec3 albedo = g.from == NONE ? vec3(0.0) : Values(t.albedo).at[g.from];
    if (round_prepares()) {
        vec3 light = round_index() == 0u ? g.direct : g.from == NONE ? vec3(0.0) : albedo * newest(t, from).at[g.from];
        newest(t, to).at[index] += share * light;
        return;
    }
    received(t, to, 0u).at[index] += share * g.direct;
    if (g.from == NONE) return;
    for (uint layer = 0u; layer < t.layers; layer++) {
        vec3 light = share * albedo * received(t, from, layer).at[g.from];
        if (layer + 1u < t.layers) received(t, to, layer + 1u).at[index] += light;
        else if (t.open_ended != 0u) received(t, to, layer).at[index] += light;
    }
}

void patch_gather(PatchTable t, uint index) {
    Patch p = Patches(t.patches).at[index];
    PatchFace f = PatchFaces(t.faces).at[p.face];
    Primitive primitive = load_primitive(f.primitive);
    bool triangle = face_is_triangle(f, primitive);
    uint to = (round_index() & 1u) ^ 1u;
    if (round_prepares()) newest(t, to).at[index] = vec3(0.0);
    else for (uint layer = 0u; layer < t.layers; layer++) received(t, to, layer).at[index] = vec3(0.0);

    uint rays = 0u;
    for (uint i = 0u; i < frame.sample_count; i++) {
        Sampler random = patch_numbers(index, i);
        vec4 u = next4_spread(random);
        vec4 light_u = next4_spread(random);
        vec2 c = patch_coordinates(p, triangle, u.xy);
        Interaction at = interaction_at(face_ray(f, primitive, c, vec3(0.0, 0.0, 1.0)), face_hit(f, primitive, c));
        Ray ray;
        Gathered g = gather(t, at, p.back != 0u ? -at.normal : at.normal, u.zw, light_u, random, ray, rays);
        patch_receive(t, index, g, 1.0 / float(frame.sample_count));
        if (!round_prepares()) Counts(t.met).at[index * t.columns + g.met] += 1u;
    }
    if (round_prepares()) {
        uint layer = min(round_index(), t.layers - 1u);
        received(t, 0u, layer).at[index] += newest(t, to).at[index];
    }
    count_rays(rays);
}
#endif

#ifdef PASS_VERTICES
// The vertex as the weighted sum of patches around it, in every layer.
void patch_vertex(PatchTable t, uint index) {
    uint begin = Indices(t.term_first).at[index], end = Indices(t.term_first).at[index + 1u];
    for (uint layer = 0u; layer < t.layers; layer++) {
        Values values = received(t, (round_index() & 1u) ^ 1u, layer);
        vec3 sum = vec3(0.0);
        for (uint i = begin; i < end; i++) {
            uvec2 term = Pairs(t.terms).at[i];
            sum += uintBitsToFloat(term.y) * values.at[term.x];
        }
        vertex_values(t, layer).at[index] = sum;
    }
}
#endif

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    uint index = frame.first_slot + gl_GlobalInvocationID.x;
    PatchTable t = patch_table();
#if defined(PASS_ALBEDO)
    patch_albedo(t, index);
#elif defined(PASS_GATHER)
    patch_gather(t, index);
#else
    patch_vertex(t, index);
#endif
}
