// The passes of radiosity by shooting. `shoot` runs over patches, and then over as many slots again for the lights: each sends its rays, and
// what they carry arrives in 64-bit integers, whose sums do not depend on the order. `collect` makes irradiance of it.
#extension GL_EXT_shader_atomic_int64 : require
#include "techniques/radiosity/patches.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Power { int64_t channel[3]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Totals { int64_t sent[3]; };

// The value of one unit of the integers, W: far below what a ray carries, and all there is has room many times over.
float power_unit() { return scene.splat_unit * (PI * scene.radius) * (PI * scene.radius) * (1.0 / 2048.0); }

Power arriving(PatchTable t, uint layer, uint index) {
    uint64_t place = uint64_t(t.patch_count) * layer + index;
    return Power(unpack32(pack64(t.arriving) + uint64_t(FIXED_RGB_BYTES) * (place + 1ul)));
}
Totals totals(PatchTable t) { return Totals(t.arriving); }

// What this round's patches have sent out together is in one of the sums; the other takes what they will send next.
uint total_to_read() { return !round_prepares() && round_index() == 0u ? 2u : round_index() & 1u; }

// The weight of power when rays are shared out.
float strength(vec3 power) { return power.x + power.y + power.z; }

// What the layers hold before this round: while preparing, only what came last.
uint layers_to_send(PatchTable t) { return round_prepares() ? 1u : t.layers; }
vec3 power_to_send(PatchTable t, uint index, float area, uint layer) {
    uint from = round_index() & 1u;
    vec3 light = round_prepares() ? newest(t, from).at[index] : received(t, from, layer).at[index];
    return area * Values(t.albedo).at[index] * light;
}

#ifdef PASS_SHOOT
// Numbers of a round of their own: what follows each other must not have met the same points of a sequence.
Sampler shot_numbers(uint index, uint i, uint dimension) {
    return Sampler(index, i, dimension, pcg4d(uvec4(frame.seed, frame.word, 0x510e527fu, 0u)).x);
}

void arrive(PatchTable t, uint patch_, uint layer, vec3 power) {
    vec3 units = power / power_unit();
    Power sums = arriving(t, layer, patch_);
    [[unroll]] for (uint i = 0u; i < 3u; i++) {
        int64_t amount = rounded64(units[i]);
        if (amount != 0l) atomicAdd(sums.channel[i], amount);
    }
}

// The patch that a ray meets, or NONE; `share` is what a mask leaves out of its rays.
uint patch_met(PatchTable t, Ray ray, inout Sampler random, out uint met, out float share, inout uint rays) {
    Vertex v;
    met = 0u;
    share = 1.0;
    if (!vertex_arrive(ray, false, v, random, rays)) return NONE;
    share = 1.0 / vertex_opacity(v);
    vec2 c;
    uint index = patch_at(t, v.hit, v.at.position, v.front, c);
    met = index == NONE ? 1u : Patches(t.patches).at[index].column;
    return index;
}

void shoot_light(PatchTable t, uint index, inout uint rays) {
    for (uint i = 0u; i < frame.sample_count; i++) {
        Sampler random = Sampler(index, round_index() * frame.sample_count + i, 0u, frame.seed ^ 0x1f83d9abu);
        vec4 u = next4_spread(random);
        vec4 v = next4_spread(random);
        EmittedRay e = light_emit(u, v);
        if (e.power == vec3(0.0)) continue;
        uint met;
        float share;
        uint there = patch_met(t, Ray(e.origin, e.direction, INFINITY), random, met, share, rays);
        if (there != NONE) arrive(t, there, 0u, e.power * (share / (float(t.patch_count) * float(frame.sample_count))));
    }
}

void shoot_patch(PatchTable t, uint index, inout uint rays) {
    Patch p = Patches(t.patches).at[index];
    float own = 0.0;
    for (uint layer = 0u; layer < layers_to_send(t); layer++) own += strength(power_to_send(t, index, p.area, layer));
    float all = float(totals(t).sent[total_to_read()]) * power_unit();
    if (own <= 0.0 || all <= 0.0) return;
    // So many rays in the mean; what each carries is divided by that mean, whatever their number is.
    float expected = float(t.patch_count) * float(frame.sample_count) * (own / all);
    Sampler rounding = Sampler(index, round_index(), 0u, frame.seed ^ 0x9b05688cu);
    uint count = uint(expected + next4_spread(rounding).x);
    PatchFace f = PatchFaces(t.faces).at[p.face];
    Primitive primitive = load_primitive(f.primitive);
    bool triangle = face_is_triangle(f, primitive);
    for (uint i = 0u; i < count; i++) {
        Sampler random = shot_numbers(index, i, 0u);
        vec4 u = next4_spread(random);
        vec2 c = patch_coordinates(p, triangle, u.xy);
        Interaction at = interaction_at(face_ray(f, primitive, c, vec3(0.0, 0.0, 1.0)), face_hit(f, primitive, c));
        vec3 w = to_world(basis_from_normal(p.back != 0u ? -at.normal : at.normal), sample_cosine_hemisphere(u.zw));
        uint met;
        float share;
        uint there = patch_met(t, Ray(offset_origin(at.position, at.margin, at.normal, w), w, INFINITY), random, met, share, rays);
        if (!round_prepares()) Counts(t.met).at[index * t.columns + met] += 1u;
        if (there == NONE) continue;
        for (uint layer = 0u; layer < layers_to_send(t); layer++) {
            uint next = round_prepares() ? 0u : layer + 1u;
            if (next == t.layers && t.open_ended != 0u) next = layer;
            if (next < t.layers) arrive(t, there, next, power_to_send(t, index, p.area, layer) * (share / expected));
        }
    }
}
#endif

#ifdef PASS_COLLECT
vec3 collected(PatchTable t, uint index, uint layer, float area) {
    Power sums = arriving(t, layer, index);
    vec3 power = vec3(float(sums.channel[0]), float(sums.channel[1]), float(sums.channel[2])) * power_unit();
    [[unroll]] for (uint i = 0u; i < 3u; i++) sums.channel[i] = 0l;
    return power / area;
}

void collect(PatchTable t, uint index) {
    float area = Patches(t.patches).at[index].area;
    uint to = (round_index() & 1u) ^ 1u;
    float own = 0.0;
    for (uint layer = 0u; layer < layers_to_send(t); layer++) {
        vec3 light = collected(t, index, layer, area);
        if (round_prepares()) {
            newest(t, to).at[index] = light;
            received(t, 0u, min(round_index(), t.layers - 1u)).at[index] += light;
        } else {
            received(t, to, layer).at[index] = light;
        }
        own += strength(area * Values(t.albedo).at[index] * light);
    }
    int64_t amount = rounded64(own / power_unit());
    atomicAdd(totals(t).sent[to], amount);
    if (round_prepares()) atomicAdd(totals(t).sent[2], amount);
    if (index == 0u) totals(t).sent[to ^ 1u] = 0l; // it was read by the pass before, and is the next round's to fill
}
#endif

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    uint index = frame.first_slot + gl_GlobalInvocationID.x;
    PatchTable t = patch_table();
#ifdef PASS_SHOOT
    uint rays = 0u;
    bool light = index >= t.patch_count;
    if (index == 0u && !round_prepares() && round_index() == 0u) totals(t).sent[0] = totals(t).sent[1] = 0l; // of preparing: none reads them
    // The first round that prepares has light from the lights, each later one from patches.
    if (round_prepares() && light == (round_index() > 0u)) return;
    if (light) shoot_light(t, index, rays);
    else shoot_patch(t, index, rays);
    count_rays(rays);
#else
    collect(t, index);
#endif
}
