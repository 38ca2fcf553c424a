// `bdpt`: bidirectional path tracing (Lafortune and Willems 1993; Veach and Guibas 1994; Veach 1997, chapter 10). A path from the
// light and one from the camera, and every way to make a whole path of their beginnings: (s, t) takes s vertices of the first
// and t of the second. s = 0 is implicit and s = 1 explicit path tracing, t = 1 is light tracing; all are combined by
// multiple importance sampling. t = 0 is left out: nothing runs into a pinhole.
//
// The pass `light` follows the paths from the lights, shows their vertices to the camera (t = 1) and keeps them; the pass `camera`
// follows the others and connects. Unbiased.
#version 460
#include "lib/prelude.glsl"
#include "trace/backend.glsl"
#include "lib/splat.glsl"

#ifdef PASS_RESOLVE
#include "lib/resolve_main.glsl"
#else
#include "lib/light_path.glsl"
#include "lib/bidirectional.glsl"
#include "lib/light_vertices.glsl"

layout(local_size_x = WORKGROUP) in;

// The longest path that has vertices from both sides.
uint longest() { return min(MAX_DEPTH, BIDIRECTIONAL_LENGTH); }

#ifdef PASS_LIGHT

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
    if (e.delta || e.distant) return;
    vec4 u = next4(path.random);
    CameraView view = camera_view(e.position, u.xy);
    float cosine = dot(view.direction, e.normal);
    if (!view.visible || cosine <= 0.0) return;
    vec3 origin = offset_origin(e.position, distance(e.origin, e.position), e.normal, view.direction);
    float reach = distance(view.target, origin);
    Ray ray = Ray(origin, (view.target - origin) / reach, reach * (1.0 - gamma(8.0)));
    float camera_a = view.importance * cosine / (view.distance2 * light_path_count()); // pixels per area
    float weight = 1.0 / (1.0 + mis(camera_a / e.pdf_a));
    vec3 value = e.power * INV_PI * camera_a;
    show(pixel, view, 1u, value, weight, u.zw, ray, vec3(0.0), rays);
}

// Follows the path to its next vertex, keeps that, shows it to the camera, and chooses the ray after it.
bool light_path_extend(Pixel pixel, EmittedRay e, inout Path path, inout Partial p, inout uint count, inout uint rays) {
    Hit hit;
    if (!trace_visible(path.ray, hit, path.random, rays)) return false;
    Vertex v = vertex_at(path.ray, hit);
    path_absorb(path, v);
    float arriving = abs(dot(path.ray.direction, v.at.normal));
    if (v.material == NONE || arriving == 0.0) return false;
    LightVertex kept = LightVertex(v.at.position, path.ray.direction, hit.primitive, hit.instance, hit.uv, e.power * path.throughput, 0.0, 0.0,
                                   path.random.dimension, path.depth + 1u, path.absorption);
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
        if (length < longest()) {
            kept.d_vcm = p.d_vcm;
            kept.d_vc = p.d_vc;
            keep_light_vertex(pixel, count, kept);
            count += 1u;
        }
        CameraView view = camera_view(v.at.position, u.xy);
        vec3 local = vertex_to_local(v, view.direction);
        vec3 value = e.power * path.throughput * light_vertex_eval(v, b, path.ray, local, view.direction);
        if (view.visible && value != vec3(0.0)) {
            float camera_a = view.importance * abs(dot(view.direction, v.at.normal)) / (scaled_area(view.distance2) * light_path_count());
            float weight = 1.0 / (1.0 + partial_sum(p, camera_a, bsdf_pdf(b, local, v.wo)));
            value *= view.importance / (view.distance2 * light_path_count());
            show(pixel, view, length, value, weight, u.zw, vertex_camera_ray(v, view), vertex_absorption(v, b, path.absorption, local), rays);
        }
    }
    if (length >= longest()) return false;
    BsdfSample s = light_vertex_sample(v, b, path.ray, bsdf_u.xyz);
    partial_scatter(p, abs(dot(vertex_to_world(v, s.wi), v.at.normal)), s.pdf_w, s.delta ? 0.0 : bsdf_pdf(b, s.wi, v.wo), s.delta);
    path_scatter(path, v, b, s);
    return light_path_survives(path, bsdf_u.w);
}

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    uint rays = 0u, count = 0u;
    Path path;
    Partial p;
    EmittedRay emitted;
    bool alive = false;
    while (alive || pixel_has_sample(pixel)) {
        if (!alive) {
            path = light_path_begin(pixel.index, pixel.sample_index, emitted);
            count = 0u;
            if (MAX_DEPTH > 0u) show_light(pixel, path, emitted, rays);
        }
        alive = MAX_DEPTH > 1u && emitted.power != vec3(0.0) && light_path_extend(pixel, emitted, path, p, count, rays);
        if (!alive) {
            keep_light_vertex_count(pixel, count);
            pixel.sample_index += 1u;
        }
    }
    atomicAdd(Tallies(frame.tally).rays[gl_WorkGroupID.x % RAY_COUNTERS], rays);
}

#else

// Adds what (s, t) brings to the path's own pixel.
void gather(Pixel pixel, inout Estimate e, uint s, uint t, vec3 value, float weight) {
    if (HAS_STRATEGIES) splat_strategy(pixel.index, pixel.sample_index, s, t, value * pixel.filter_weight, weight);
    else contribute(e, s + t - 1u, value * weight);
}

// Weight of (0, t): the path has run into a light. `choice_pdf_w` is the density with which (1, t - 1) picks that direction,
// `cosine` lies at the light, `emission_a` is the density of light paths beginning there, per scaled area.
float implicit_weight(Path path, Partial p, float choice_pdf_w, float cosine, float distance2, float emission_a) {
    if (path.depth == 0u) {
        // Against (1, 1): p holds pixels per area there.
        return 1.0 / (1.0 + p.d_vcm * mis(emission_a));
    }
    float choice_a = choice_pdf_w * cosine / scaled_area(distance2);
    return 1.0 / (1.0 + p.d_vcm * mis(choice_a) + p.d_vc * mis(emission_a * cosine * INV_PI));
}

bool path_extend(Pixel pixel, inout Path path, inout Partial p, inout Estimate e) {
    Hit hit;
    bool found = path_trace(path, hit, e);
    uint length = path.depth + 1u;
    bool both_sides = length <= longest(); // strategies with more than one vertex from the light take part
    if (!found) {
        if (HAS_BACKGROUND) {
            float pdf_w = background_pdf(path.ray.direction);
            float weight = 1.0;
            // d_vcm and d_vc are still over solid angle: a light path begins on a disk of pi squares of the radius.
            if (path.depth > 0u)
                weight = both_sides ? 1.0 / (1.0 + p.d_vcm * mis(pdf_w) + p.d_vc * mis(pdf_w * INV_PI)) : 1.0 / (1.0 + (path.delta ? 0.0 : mis(pdf_w / path.pdf_w)));
            gather(pixel, e, 0u, length + 1u, path.throughput * background_radiance(path.ray.direction), weight);
        }
        return false;
    }
    Vertex v = vertex_at(path.ray, hit);
    path_absorb(path, v);
    path_measure(path, v);
    float arriving = abs(dot(path.ray.direction, v.at.normal));
    if (arriving == 0.0) return false;
    vec3 segment = v.at.position - path.from.position;
    float distance2 = dot(segment, segment);
    partial_arrive(p, CAMERA == CAMERA_ORTHOGRAPHIC && path.depth == 0u ? 1.0 : distance2, arriving);

    // s = 0: emission that the path has run into.
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) {
        float weight = 1.0;
        float choice = path.depth > 0u && !path.delta ? light_pdf(path.from, path.ray, hit, v.at, v.surface) : 0.0;
        if (both_sides) weight = implicit_weight(path, p, choice, arriving, distance2, v.surface.emission_density / scaled_area(1.0));
        else if (!path.delta) weight = 1.0 / (1.0 + mis(choice / path.pdf_w));
        gather(pixel, e, 0u, length + 1u, path.throughput * emission, weight);
    }
    if (length >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    both_sides = length < longest();

    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b)) {
        // s = 1: next-event estimation.
        LightSample light = light_sample(vertex_receiver(v, b), light_u);
        vec3 wi = vertex_to_local(v, light.wi);
        vec3 value = path.throughput * vertex_eval(v, b, path.ray, wi, light.wi) * light.weight;
        if (value != vec3(0.0)) {
            float found_w = light.delta ? 0.0 : bsdf_pdf(b, v.wo, wi);
            float others = mis(found_w / light.pdf_w);
            if (both_sides) others += partial_sum(p, light.emitted * abs(dot(light.wi, v.at.normal)) / scaled_area(1.0), bsdf_pdf(b, wi, v.wo));
            value *= vertex_transmittance(v, light, vertex_absorption(v, b, path.absorption, wi), e.rays);
            gather(pixel, e, 1u, length + 1u, value, 1.0 / (1.0 + others));
        }
        // s >= 2: connections to the light path.
        LightPath others = light_path_of(pixel);
        uint count = both_sides ? others.count : 0u;
        for (uint i = 0u; i < count; i++) {
            LightVertex y = others.at[i];
            uint total = length + 1u + y.segments;
            if (total > longest()) break;
            float weight;
            vec3 value = path.throughput * connect(pixel, path, v, b, p, y, weight, e.rays);
            gather(pixel, e, y.segments + 1u, length + 1u, value, weight);
        }
    }

    BsdfSample s = vertex_sample(v, b, path.ray, bsdf_u.xyz);
    partial_scatter(p, abs(dot(vertex_to_world(v, s.wi), v.at.normal)), s.pdf_w, s.delta ? 0.0 : bsdf_pdf(b, s.wi, v.wo), s.delta);
    path_scatter(path, v, b, s);
    float greatest = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
    if (greatest == 0.0) return false;
    if (path.depth >= RR_DEPTH) {
        float survive = min(greatest * path.eta * path.eta, path.depth < ENDLESS ? 1.0 : 0.999);
        if (bsdf_u.w >= survive) return false;
        path.throughput /= survive;
    }
    return true;
}

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    Estimate e;
    e.rays = 0u;
    Path path;
    Partial p;
    bool alive = false;
    while (alive || pixel_has_sample(pixel)) {
        if (!alive) {
            path = path_begin(pixel, e);
            p = Partial(mis(light_path_count() / camera_importance(path.ray.direction)), 0.0);
        }
        alive = path_extend(pixel, path, p, e);
        if (!alive) {
            splat_sample(pixel, e);
            pixel.sample_index += 1u;
        }
    }
    atomicAdd(Tallies(frame.tally).rays[gl_WorkGroupID.x % RAY_COUNTERS], e.rays);
}
#endif
#endif
