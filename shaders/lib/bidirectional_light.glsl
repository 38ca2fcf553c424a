// The pass `light` of bidirectional techniques: follows the light paths, shows their vertices to the camera (t = 1) and keeps them.
#include "lib/light_vertices.glsl"
#include "lib/splat.glsl"

layout(local_size_x = WORKGROUP) in;

// Adds (s, 1): what a vertex shows to the camera along the ray.
void show(Pixel pixel, CameraView view, uint s, vec3 value, float weight, vec2 u, Ray ray, vec3 absorption, inout uint rays) {
    uint seen_by = splat_pixel(view.position, u, value);
    if (seen_by == NONE) return;
    value *= segment_transmittance(ray, absorption, rays);
    if (HAS_STRATEGIES) splat_strategy(seen_by, pixel.sample_index, s, 1u, value, weight);
    else splat(seen_by, pixel.sample_index, s, value * weight);
}

// (1, 1): the light itself, shown to the camera, against (0, 2), the camera running into it.
void show_light(Pixel pixel, Path path, EmittedRay e, inout uint rays) {
    LightView seen = light_view(e, path.random);
    if (!seen.visible) return;
    float camera_a = seen.camera.importance * seen.cosine / (seen.camera.distance2 * light_path_count()); // pixels per area
    float weight = 1.0 / (1.0 + mis(camera_a / e.pdf_a));
    vec3 value = e.shown * camera_a;
    show(pixel, seen.camera, 1u, value, weight, seen.u, seen.ray, vec3(0.0), rays);
}

// (s, 1), s > 1: the vertex that the path has come to as the camera sees it.
void show_vertex(Pixel pixel, Path path, vec3 power, Vertex v, Bsdf b, Partial p, uint s, vec4 u, inout uint rays) {
    CameraView view = camera_view(v.at.position, u.xy);
    vec3 local = vertex_to_local(v, view.direction);
    vec3 value = power * path.throughput * light_vertex_eval(v, b, path.ray, local, view.direction);
    if (!view.visible || value == vec3(0.0)) return;
    float camera_a = view.importance * abs(dot(view.direction, v.at.normal)) / (scaled_area(view.distance2) * light_path_count());
    float others = partial_sum(p, camera_a, bsdf_pdf(b, local, v.wo), vertex_opacity(v));
    float lens_a = lens_choice();
    if (lens_a > 0.0) others += mis(bsdf_pdf(b, v.wo, local) * lens_cosine(view.direction) / (scaled_area(view.distance2) * lens_a)); // t = 0
    float weight = 1.0 / (1.0 + others);
    value *= view.importance / (view.distance2 * light_path_count());
    show(pixel, view, s, value, weight, u.zw, vertex_ray_to(v, view.direction, view.target), vertex_absorption(v, b, path.absorption, local), rays);
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
    if (seen_by != NONE) splat(seen_by, pixel.sample_index, path.depth + 1u, value * lens_weight(p, importance, lens_choice()));
}

// Follows the path to its next vertex, keeps that, shows it to the camera, and chooses the ray after it. `met` counts the vertices of
// the path that were kept, or would have been if there were room.
bool light_path_extend(Pixel pixel, LightPath keeping, EmittedRay e, inout Path path, inout Partial p, inout uint met, inout uint rays) {
    Hit hit;
    Ray ray = path.ray;
    bool found = trace_visible(path.ray, hit, path.random, rays);
    bool to_lens = lens_choice() > 0.0;
    if (to_lens) show_lens(pixel, path, e.power, ray, found ? distance(ray.origin, path.ray.origin) + hit.t : INFINITY, p);
    if (!found || path.depth + 2u > longest()) return false;
    Vertex v = vertex_at(path.ray, hit);
    path_absorb(path, v);
    float arriving = abs(dot(path.ray.direction, v.at.normal));
    if (v.material == NONE || arriving == 0.0) return false;
    LightVertex kept = LightVertex(v.at.position, path.ray.direction, v.at.normal, hit.primitive, hit.instance, hit.uv,
                                   e.power * path.throughput, 0.0, 0.0, path.random.dimension, path.depth + 1u, path.absorption);
    Bsdf b = vertex_material(v, path.ray, path.random);
    uint length = path.depth + 2u; // segments with one to the camera: this is vertex s = length
    vec3 segment = v.at.position - path.from.position;
    float distance2 = dot(segment, segment);

    if (path.depth == 0u) {
        // What (1, t) would have picked the beginning with is known only here.
        p = Partial(mis(light_choice_ratio(e, vertex_receiver(v, b), distance2) / arriving), e.delta ? 0.0 : mis(e.d_vc / arriving));
    } else {
        partial_arrive(p, distance2, arriving);
    }

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
        if (CONNECTS) show_vertex(pixel, path, e.power, v, b, p, length, u, rays);
    }
    if (length >= longest() && !to_lens) return false; // one more segment for the lens
    BsdfSample s = light_vertex_sample(v, b, path.ray, bsdf_u.xyz);
    partial_scatter(p, abs(dot(vertex_to_world(v, s.wi), v.at.normal)), s.pdf_w, s.delta ? 0.0 : bsdf_pdf(b, s.wi, v.wo), s.delta, vertex_opacity(v));
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
        if (!alive) {
            path = light_path_begin(pixel.index, pixel.sample_index, emitted);
            keeping = light_path_of(pixel.index, pixel.sample_index);
            met = 0u;
            if (CONNECTS && MAX_DEPTH > 0u) show_light(pixel, path, emitted, rays);
        }
        alive = MAX_DEPTH > 1u && emitted.power != vec3(0.0) && light_path_extend(pixel, keeping, emitted, path, p, met, rays);
        if (!alive) {
            keep_count(keeping, met);
            pixel.sample_index += 1u;
        }
    }
    count_rays(rays);
}
