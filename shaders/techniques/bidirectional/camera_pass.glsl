// The pass `camera` of bidirectional techniques: follows camera subpaths, and connects and merges each with the light subpaths that were kept.
#include "techniques/bidirectional/connect.glsl"
#include "transport/camera_lanes.glsl"
#include "transport/density_sums.glsl"
#include "core/grid.glsl"

struct Lane {
    CameraLane camera;
    SubpathMis mis;
};

bool open(out Lane lane) { return camera_open(lane.camera); }
bool has_next(Lane lane) { return camera_has_next(lane.camera); }

bool begin(inout Lane lane) {
    camera_begin(lane.camera);
    vec3 direction = lane.camera.path.ray.direction;
    lane.mis = mis_begin_camera(camera_importance(direction), lens_choice(), lens_cosine(direction));
    return true;
}

// s = 1 and s > 1: connects the vertex to a sample of the lights, then to the vertices of one light subpath. The latter are all weighted, and one
// ray is traced for them: along one of those, chosen in proportion to its weighted contribution, which stands for all (Talbot, Cline and Egbert
// 2005, "Importance resampling for global illumination"). Layers of strategies have a ray for each. Rays come last, in turns of their own.
void add_connections(Pixel pixel, Path path, Vertex v, Bsdf b, SubpathMis m, bool both_sides, vec4 light_u, float u, inout Estimate e) {
    uint index = pixel.index % light_subpaths.light_path_count;
    uint t = path.depth + 2u, count = 0u;
    End end;
    end.u = light_u;
    end.random = light_path_random(index, pixel.sample_index);
    LightPath others = light_path_of(index, pixel.sample_index);
    if (both_sides) count = others.count;
    float total = 0.0, chosen_weighted = 0.0; // weighted contributions
    uint s = 0u;
    Connection to_light, chosen;
    for (uint turn = 0u; turn <= count; turn++) {
        end.light = turn == 0u;
        if (!end.light) {
            end.y = others.at[turn - 1u];
            if (t + end.y.segments > longest()) break;
        }
        Connection c = connect(path, v, b, m, both_sides, end);
        uint from_light = end.light ? 1u : end.y.segments + 1u;
        if (HAS_STRATEGIES) {
            if (c.contribution != vec3(0.0)) add_connection(pixel, e, from_light, t, c);
            continue;
        }
        if (!end.light && c.contribution != vec3(0.0)) record_strategy(from_light, t, c.contribution, c.weight, RECORDED_CANDIDATE);
        if (end.light) to_light = c;
        if (end.light || c.contribution == vec3(0.0)) continue;
        float weighted = max(c.contribution.x, max(c.contribution.y, c.contribution.z)) * c.weight;
        if (weighted <= 0.0) continue;
        if (!(weighted < INFINITY)) add_strategy(pixel, e, from_light, t, c.contribution, c.weight); // counted, and dropped, with all that the pixel's sample has
        total += weighted;
        // Chooses by what is left of the same number (Chao 1982).
        float probability = weighted / total;
        if (u < probability) {
            chosen = c;
            chosen_weighted = weighted;
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
        if (light ? c.contribution == vec3(0.0) : chosen_weighted == 0.0) continue;
        if (!light) c.weight *= total / chosen_weighted;
        add_connection(pixel, e, light ? 1u : s, t, c);
    }
}

// Vertex merging: the end of a camera subpath and that of a light subpath, close enough to be taken for one vertex (Georgiev et al. 2012;
// the density estimate is that of photon mapping with a constant kernel).

// Weight of a merge of the camera's vertex v with y among all strategies; `local` is the direction in which y's light came.
float merge_weight(Vertex v, Bsdf b, SubpathMis m, LightVertex y, vec3 local) {
    if (MERGES_FIRST) return 1.0; // nothing else finds the path
    float opacity = vertex_opacity(v);
    vec2 pdf_w = bsdf_pdf_both(b, v.wo, local);
    return 1.0 / (1.0 + mis_merge(m, pdf_w.y, opacity) + mis_merge(SubpathMis(y.d_vcm, y.d_vc), pdf_w.x, opacity));
}

void add_merges(Path path, Vertex v, Bsdf b, SubpathMis m, inout Estimate e) {
    uint length = path.depth + 1u;
    float area = PI * merge_radius() * merge_radius();
    vec3 factor = path.throughput / (area * vertex_opacity(v) * light_path_count() * scene.splat_unit);
    DensitySums sums;
    density_clear(sums);
    GridSearch search = grid_search(v.at.position);
    while (grid_next(search)) {
        LightPath kept = light_path_at(uint64_t(search.index / light_subpaths.light_vertices));
        uint place = search.index % light_subpaths.light_vertices;
        LightVertex y = kept.at[place];
        // Light arrives as densely as the geometric cosine says, the BSDF goes by the shading one.
        float arriving = abs(dot(y.direction, y.normal));
        if (!same_facing(y.normal, v.at.normal) || arriving == 0.0 || y.segments > longest() - length) continue;
        vec3 local = vertex_to_local(v, -y.direction);
        vec3 f = vertex_eval(v, b, path.ray, local, -y.direction);
        if (f == vec3(0.0)) continue;
        float weight = merge_weight(v, b, m, y, local);
        record_strategy(y.segments + 1u, path.depth + 2u, factor * y.power * f * (scene.splat_unit / arriving), weight, RECORDED_MERGED);
        density_add(sums, length + y.segments, factor * y.power * f * (weight / arriving));
    }
    density_contribute(e, sums);
}

// (1, t) of form=ppm, where nothing else finds it: lights without extent on narrow lobes, at which nothing is merged.
void add_highlight(Pixel pixel, Path path, Vertex v, Bsdf b, vec4 light_u, inout Estimate e) {
    LightSample light = light_sample(vertex_reference(v, b), light_u);
    if (!light.delta) return;
    NextEvent n = NextEvent(light, vertex_to_local(v, light.wi), vec3(0.0), 0.0);
    n.f = vertex_eval(v, narrow_lobes(b), path.ray, n.wi, light.wi);
    add_strategy(pixel, e, 1u, path.depth + 2u, nee_contribution(path, v, b, n, path.throughput, 1.0, e.rays), 1.0);
}

// Follows the subpath to its next vertex, with all its strategies; false where it ends.
bool follow(Pixel pixel, inout Path path, inout SubpathMis m, inout Estimate e) {
    Vertex v;
    bool found = path_arrive(path, v, e.rays);
    uint length = path.depth + 1u;
    bool both_sides = length <= longest(); // strategies with more than one vertex from the light take part
    if (!found) {
        if (HAS_BACKGROUND) add_background(pixel, path, m, both_sides, e);
        return false;
    }
    float arriving = abs(dot(path.ray.direction, v.at.normal));
    if (arriving == 0.0) return false;
    float distance2 = mis_arrive_from_camera(m, path, v, arriving);

    add_emission(pixel, path, v, m, both_sides, arriving, distance2, e);
    if (length >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    both_sides = length < longest();

    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b)) {
        if (CONNECTS) add_connections(pixel, path, v, b, m, both_sides, light_u, both_sides ? next4(path.random).x : 0.0, e);
        if (SPLITS && HAS_DELTA_LIGHTS && bsdf_has_narrow(b)) add_highlight(pixel, path, v, b, light_u, e);
        if (MERGES && both_sides && bsdf_has_broad(b)) add_merges(path, v, broad_lobes(b), m, e);
    }

    BsdfSample s = mis_sample(m, v, b, path.ray, bsdf_u.xyz);
    if (MERGES_FIRST && !s.narrow) return false; // broad lobes have been merged
    path_scatter(path, v, b, s);
    return path_survives(path, path.eta * path.eta, bsdf_u.w);
}

bool extend(inout Lane lane) { return follow(lane.camera.pixel, lane.camera.path, lane.mis, lane.camera.e); }

// What the subpath has gathered is splatted as well, so that the pass `resolve` finds all of a sample.
void end(inout Lane lane) {
    splat_sample(lane.camera.pixel, lane.camera.e);
    lane.camera.pixel.sample_index += 1u;
}

void close(Lane lane) { count_rays(lane.camera.e.rays); }

LANES(Lane, open, has_next, begin, extend, end, close)
