// What chains of form `multiplexed` mutate (Hachisuka, Kaplanyan and Dachsbacher 2014, "Multiplexed Metropolis light transport"): the numbers of one
// strategy (s, t) of bidirectional path tracing, weighted among all that make such a path, for a path of a given length; the part from the
// light first, then that from the camera, then their connection.
//
// What paths from the camera find by themselves, (0, t) and (1, t), is one kind for all lengths: one path finds all of it, as in `path`. Emission
// that only a path which runs into it finds is found a hundred times as often as by a path for each length and strategy.
#define STRATEGIES_OF_MULTIPLEXED
#include "techniques/metropolis/chains.glsl"
#include "techniques/bidirectional/connect.glsl"

// Where such a path is.
struct Walk {
    Path path;           // the part that is being made
    SubpathMis mis;      // its recursive quantities
    bool from_light;     // that part is the light's
    bool by_camera;      // there is no other part, and all that it finds counts
    uint s, t;           // vertices of each part otherwise
    EmittedRay emitted;  // the beginning of the light's part
    LightVertex end;     // its end, once it is there
    Sampler light_random, camera_random; // at what each part draws next
    vec2 position;       // in the image
    vec2 lens;           // numbers for a point of the lens
};

// Strategies with more from the light than a vertex to aim at: (2, k - 1) to (k, 1), and (1, 1).
uint strategies(uint segments) { return max(segments - 1u, 1u); }

// One over the density with which large steps make the path, over that of the path's own strategy: of choosing the strategy, and the kind.
float walk_share(Walk w, Proposal p) { return (w.by_camera ? 1.0 : float(strategies(w.s + w.t - 1u))) / kind_probability(p.kind); }

// Blocks of numbers that the path has used: of the camera's in the lower half, of the light's in the upper one.
uint walk_known(Walk w) { return w.camera_random.dimension | (w.light_random.dimension - LIGHT_DIMENSION) << 16u; }

void multiplexed_begin_camera(inout Walk w) {
    w.from_light = false;
    if (RECORDS) recorded_from_light = false;
    w.path = path_from_camera(camera_ray(w.position, w.lens), w.camera_random);
    w.mis = mis_begin_camera(camera_importance(w.path.ray.direction), lens_choice(), lens_cosine(w.path.ray.direction));
}

// Records the camera's vertex where it is all that there is from the camera: the ray ends there.
void record_seen(Ray ray) {
    recorded_from_light = false;
    if (!records(RECORD_BEGIN)) return;
    PathRecord r = record_of(RECORD_BEGIN, 0u);
    r.position = ray.origin + ray.t_max * ray.direction;
    r.direction = -ray.direction;
    record_append(r);
}

// The light subpath connected to the camera, as a connection.
Connection multiplexed_to_camera(inout Walk w, CameraConnection c) {
    if (c.contribution != vec3(0.0)) {
        w.position = c.position;
        if (RECORDS) record_seen(c.ray);
    }
    return Connection(c.contribution, c.weight, c.ray, c.absorption);
}

// Begins a path. Of kind 0 is what the camera finds, others are as many segments long. Returns whether anything
// is left to follow.
bool walk_begin(Proposal p, uint room, inout Estimate e, out Walk w) {
    Sampler random = p.random;
    uint kind = p.kind;
    w.light_random = random;
    w.light_random.dimension = LIGHT_DIMENSION;
    vec4 u = next4(random);
    vec4 choice = next4(random);
    w.camera_random = random;
    w.position = image_place(u.xy);
    w.lens = u.zw;
    w.by_camera = kind == 0u;
    uint count = strategies(kind);
    w.s = kind + 1u - count + min(uint(choice.x * float(count)), count - 1u);
    w.t = kind + 1u - w.s;
    if (w.by_camera) {
        multiplexed_begin_camera(w);
        return true;
    }
    vec4 a = next4(w.light_random);
    vec4 b = next4(w.light_random);
    w.emitted = light_emit(a, b);
    w.from_light = true;
    if (RECORDS) {
        recorded_from_light = true;
        record_emitted(w.emitted);
    }
    w.path = path_from_light(w.emitted, w.light_random);
    return w.s == 1u || w.emitted.power != vec3(0.0);
}

// Follows the part that is being made to its next vertex; returns whether anything is left to follow. What it finds there along a connection is
// still to be added, were nothing in between.
bool multiplexed_step(inout Walk w, inout Estimate e, inout Connection found_by) {
    if (!w.by_camera && w.s == 1u) {
        found_by = multiplexed_to_camera(w, connect_light_to_camera(w.path, w.emitted));
        w.light_random.dimension += 1u; // what connected it
        return false;
    }
    Vertex v;
    Pixel anywhere;
    bool found = path_arrive(w.path, v, e.rays);
    if (!w.from_light) w.camera_random.dimension = w.path.random.dimension;
    uint segments = w.path.depth + 1u;
    bool last = !w.by_camera && segments + 1u == (w.from_light ? w.s : w.t);
    bool both_sides = segments <= longest(); // other kinds make paths of this length too
    if (!found) {
        if (HAS_BACKGROUND && w.by_camera) add_background(anywhere, w.path, w.mis, both_sides, e);
        return false;
    }
    float arriving = abs(dot(w.path.ray.direction, v.at.normal));
    if (arriving == 0.0) return false;
    if (!w.from_light) {
        float distance2 = mis_arrive_from_camera(w.mis, w.path, v, arriving);
        if (w.by_camera) add_emission(anywhere, w.path, v, w.mis, both_sides, arriving, distance2, e);
    }
    if (v.material == NONE || segments >= MAX_DEPTH) return false;

    vec3 arrived = w.path.throughput;
    uint dimension = w.path.random.dimension;
    Bsdf b = vertex_material(v, w.path.ray, w.path.random);
    if (w.from_light) mis_arrive_from_light(w.mis, w.path, w.emitted, v, b, arriving);
    vec4 light_u = next4(w.path.random);
    vec4 bsdf_u = next4(w.path.random);
    if (w.from_light) w.light_random.dimension = w.path.random.dimension;
    else w.camera_random.dimension = w.path.random.dimension;
    if (last && bsdf_is_delta(b)) return false;

    if (last && w.from_light && w.t == 1u) {
        found_by = multiplexed_to_camera(w, connect_vertex_to_camera(w.path, w.emitted.power, v, b, w.mis, light_u));
        return false;
    }
    if (last && w.from_light) {
        w.end = LightVertex(v.at.position, w.path.ray.direction, v.at.normal, v.hit.primitive, v.hit.instance, v.hit.uv, w.emitted.power * arrived,
                            w.mis.d_vcm, w.mis.d_vc, dimension, segments, w.path.absorption);
        multiplexed_begin_camera(w);
        return true;
    }
    // What the camera finds of the lights at each vertex, or of the light's part at the last one.
    if (last || w.by_camera && !bsdf_is_delta(b)) found_by = connect(w.path, v, b, w.mis, segments < longest(), End(!last, light_u, w.end, w.light_random));
    if (last) return false;

    BsdfSample s = mis_sample(w.mis, v, b, w.path.ray, bsdf_u.xyz);
    if (w.from_light) s.weight *= adjoint_factor(v, w.path.ray, s);
    path_scatter(w.path, v, b, s);
    if (w.by_camera) return path_survives(w.path, w.path.eta * w.path.eta, bsdf_u.w);
    return w.path.throughput != vec3(0.0);
}

bool walk_extend(inout Walk w, Proposal p, inout Estimate e) {
    Connection found_by;
    found_by.contribution = vec3(0.0);
    // Segments of the whole path: by the camera alone one more than it has.
    uint segments = w.by_camera ? w.path.depth + 2u : w.s + w.t - 1u;
    bool left = multiplexed_step(w, e, found_by);
    if (found_by.contribution != vec3(0.0)) {
        vec3 through = found_by.contribution * ray_transmittance(found_by.ray, !w.by_camera && w.t == 1u, found_by.absorption, e.rays);
        contribute(e, segments, through * found_by.weight);
        if (RECORDS && through != vec3(0.0)) record_strategy(w.by_camera ? 1u : w.s, w.by_camera ? segments : w.t, through, found_by.weight, 0u);
    }
    return left;
}

#include "techniques/metropolis/numbers_walk.glsl"
