// The pass `camera` of bidirectional techniques: follows paths from the camera, and joins each to the light paths that were kept.
#include "techniques/bidirectional/connect.glsl"
#include "techniques/bidirectional/merge.glsl"

layout(local_size_x = WORKGROUP) in;

// s = 1 and s > 1: joins the vertex to a sample of the lights, then to the vertices of one light path. The latter are all weighed, and one ray
// is traced for them: along one of those that were chosen in proportion to what they would bring, which stands for all (Talbot, Cline and Egbert
// 2005, "Importance resampling for global illumination"). Layers of strategies have a ray for each. Rays come last, in turns of their own.
void gather_connections(Pixel pixel, Path path, Vertex v, Bsdf b, Partial p, bool both_sides, vec4 light_u, float u, inout Estimate e) {
    uint index = pixel.index % frame.light_path_count;
    uint t = path.depth + 2u, count = 0u;
    End end;
    end.u = light_u;
    end.random = light_path_random(index, pixel.sample_index);
    LightPath others = light_path_of(index, pixel.sample_index);
    if (both_sides) count = others.count;
    float total = 0.0, share = 0.0;
    uint s = 0u;
    Connection to_light, chosen;
    for (uint turn = 0u; turn <= count; turn++) {
        end.light = turn == 0u;
        if (!end.light) {
            end.y = others.at[turn - 1u];
            if (t + end.y.segments > longest()) break;
        }
        Connection c = join(path, v, b, p, both_sides, end);
        uint from_light = end.light ? 1u : end.y.segments + 1u;
        if (HAS_STRATEGIES) {
            if (c.value != vec3(0.0)) gather_connection(pixel, e, from_light, t, c);
            continue;
        }
        if (end.light) to_light = c;
        if (end.light || c.value == vec3(0.0)) continue;
        float brings = max(c.value.x, max(c.value.y, c.value.z)) * c.weight;
        if (brings <= 0.0) continue;
        if (!(brings < INFINITY)) gather(pixel, e, from_light, t, c.value, c.weight); // counted, and dropped, with all that the pixel's sample has
        total += brings;
        // Chooses by what is left of the same number (Chao 1982).
        float probability = brings / total;
        if (u < probability) {
            chosen = c;
            share = brings;
            s = from_light;
            u /= probability;
        } else {
            u = (u - probability) / (1.0 - probability);
        }
    }
    if (HAS_STRATEGIES) return;
    for (uint turn = 0u; turn < turns(2u); turn++) {
        bool light = turn == 0u;
        Connection c = to_light;
        if (!light) c = chosen;
        if (light ? c.value == vec3(0.0) : share == 0.0) continue;
        if (!light) c.weight *= total / share;
        gather_connection(pixel, e, light ? 1u : s, t, c);
    }
}

bool path_extend(Pixel pixel, inout Path path, inout Partial p, inout Estimate e) {
    Hit hit;
    Interaction at;
    bool found = path_trace(path, hit, at, e);
    uint length = path.depth + 1u;
    bool both_sides = length <= longest(); // strategies with more than one vertex from the light take part
    if (!found) {
        if (HAS_BACKGROUND) gather_background(pixel, path, p, both_sides, e);
        return false;
    }
    Vertex v = vertex_of(path.ray, at);
    path_absorb(path, v);
    path_measure(path, v);
    float arriving = abs(dot(path.ray.direction, v.at.normal));
    if (arriving == 0.0) return false;
    vec3 segment = v.at.position - path.from.position;
    float distance2 = dot(segment, segment);
    partial_arrive(p, CAMERA == CAMERA_ORTHOGRAPHIC && path.depth == 0u ? 1.0 : distance2, arriving);

    gather_emission(pixel, path, hit, v, p, both_sides, arriving, distance2, e);
    if (length >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    both_sides = length < longest();

    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b)) {
        if (CONNECTS) gather_connections(pixel, path, v, b, p, both_sides, light_u, both_sides ? next4(path.random).x : 0.0, e);
        if (MERGES && both_sides) gather_merges(path, v, b, p, e);
        if (MERGES_FIRST) return false;
    }

    BsdfSample s = partial_leave(p, v, b, path.ray, bsdf_u.xyz);
    path_scatter(path, v, b, s);
    return path_survives(path, path.eta * path.eta, bsdf_u.w);
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
            p = partial_camera(camera_importance(path.ray.direction), lens_choice(), lens_cosine(path.ray.direction));
        }
        alive = path_extend(pixel, path, p, e);
        if (!alive) {
            splat_sample(pixel, e);
            pixel.sample_index += 1u;
        }
    }
    count_rays(e.rays);
}
