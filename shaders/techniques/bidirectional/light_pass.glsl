// The pass `light` of bidirectional techniques: follows the light paths, shows their vertices to the camera (t = 1) and keeps them.
#include "techniques/bidirectional/connect_camera.glsl"
#include "core/splat.glsl"

layout(local_size_x = WORKGROUP) in;

// Adds (s, 1).
void show(Pixel pixel, Shown shown, uint s, inout uint rays) {
    uint seen_by = shown.value != vec3(0.0) ? splat_pixel(shown.position, shown.u, shown.value) : NONE;
    if (seen_by == NONE) return;
    shown.value *= ray_transmittance(shown.ray, shown.absorption, rays);
    if (HAS_STRATEGIES) splat_strategy(seen_by, pixel.sample_index, s, 1u, shown.value, shown.weight);
    else splat(seen_by, pixel.sample_index, s, shown.value * shown.weight);
}

// (s, 0): the path runs into the lens on its way along the ray, which ends at a distance. Not on its first segment: (1, 1) and (0, 2)
// are better at that.
void show_lens(Pixel pixel, Path path, vec3 power, Ray ray, float end, Partial p) {
    vec2 position;
    float t;
    if (path.depth == 0u || !lens_hit(ray, end, position, t)) return;
    float cosine = lens_cosine(ray.direction), importance = camera_importance(-ray.direction);
    partial_arrive(p, t * t, cosine);
    vec3 value = power * path.throughput * (importance / (lens_area() * cosine * light_path_count()));
    if (HAS_ABSORPTION) value *= exp(-path.absorption * t);
    vec4 u = next4(path.random);
    uint seen_by = splat_pixel(position, u.xy, value);
    if (seen_by == NONE) return;
    float weight = lens_weight(p, importance, lens_choice());
    if (HAS_STRATEGIES) splat_strategy(seen_by, pixel.sample_index, path.depth + 2u, 0u, value, weight);
    else splat(seen_by, pixel.sample_index, path.depth + 1u, value * weight);
}

// Follows the path to its next vertex, keeps that, and chooses the ray after it; `shown` is what the vertex shows to the camera. `met` counts the vertices of
// the path that were kept, or would have been if there were room.
bool light_path_extend(Pixel pixel, LightPath keeping, EmittedRay e, inout Path path, inout Partial p, inout uint met, inout Shown shown, inout uint rays) {
    Hit hit;
    Interaction at;
    Ray ray = path.ray;
    bool found = trace_visible(path.ray, hit, at, path.random, rays);
    bool to_lens = lens_choice() > 0.0;
    if (to_lens) show_lens(pixel, path, e.power, ray, found ? distance(ray.origin, path.ray.origin) + hit.t : INFINITY, p);
    if (!found || path.depth + 2u > longest()) return false;
    Vertex v = vertex_of(path.ray, at);
    path_absorb(path, v);
    float arriving = abs(dot(path.ray.direction, v.at.normal));
    if (v.material == NONE || arriving == 0.0) return false;
    LightVertex kept = LightVertex(v.at.position, path.ray.direction, v.at.normal, hit.primitive, hit.instance, hit.uv,
                                   e.power * path.throughput, 0.0, 0.0, path.random.dimension, path.depth + 1u, path.absorption);
    Bsdf b = vertex_material(v, path.ray, path.random);
    uint length = path.depth + 2u; // segments with one to the camera: this is vertex s = length
    light_partial_arrive(p, path, e, v, b, arriving);

    vec4 u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b)) {
        // A connection adds a segment and one of the camera, a merge the camera's alone.
        if (MERGES || length < longest()) {
            kept.d_vcm = p.d_vcm;
            kept.d_vc = p.d_vc;
            uint place = keep_place(met, path.random);
            if (place != NONE) keeping.at[place] = kept;
            met += 1u;
        }
        if (CONNECTS) shown = shown_vertex(path, e.power, v, b, p, u);
    }
    if (length >= longest() && !to_lens) return false; // one more segment for the lens
    BsdfSample s = partial_leave(p, v, b, path.ray, bsdf_u.xyz);
    s.weight *= adjoint_factor(v, path.ray, s);
    path_scatter(path, v, b, s);
    return path_survives(path, 1.0, bsdf_u.w);
}

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside || pixel.index >= frame.light_path_count) return;
    uint rays = 0u, met = 0u;
    Path path;
    Partial p;
    EmittedRay emitted;
    LightPath keeping;
    bool alive = false;
    while (alive || pixel_has_sample(pixel)) {
        // The light itself at the beginning, and the vertex that the path comes to: shown in turns, so that the kernel traces such rays in one place.
        Shown light, vertex;
        light.value = vertex.value = vec3(0.0);
        if (!alive) {
            path = light_path_begin(pixel.index, pixel.sample_index, emitted);
            keeping = light_path_of(pixel.index, pixel.sample_index);
            met = 0u;
            if (CONNECTS && MAX_DEPTH > 0u) light = shown_light(path, emitted);
        }
        uint s = path.depth + 2u;
        alive = MAX_DEPTH > 1u && emitted.power != vec3(0.0) && light_path_extend(pixel, keeping, emitted, path, p, met, vertex, rays);
        if (CONNECTS) {
            for (uint turn = 0u; turn < turns(2u); turn++) {
                bool first = turn == 0u;
                Shown shown = vertex;
                if (first) shown = light;
                if (shown.value != vec3(0.0)) show(pixel, shown, first ? 1u : s, rays);
            }
        }
        if (!alive) {
            keep_count(keeping, met);
            pixel.sample_index += 1u;
        }
    }
    count_rays(rays);
}
