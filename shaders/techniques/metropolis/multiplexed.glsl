// What chains of form `multiplexed` mutate (Hachisuka, Kaplanyan and Dachsbacher 2014, "Multiplexed Metropolis light transport"): the numbers of one
// strategy (s, t) of bidirectional path tracing, weighted among all that make such a path, for a path of a given length; the part from the
// light first, then that from the camera, then their connection.
//
// What paths from the camera find by themselves, (0, t) and (1, t), is one kind for all lengths: one path finds all of it, as in `path`. Light
// that only chance finds, by running into it, is found a hundred times as often as by a path for each length and strategy.
#include "techniques/bidirectional/connect.glsl"
#include "techniques/bidirectional/connect_camera.glsl"

// Where such a path is.
struct Multiplexed {
    Path path;           // the part that is being made
    Partial partial;     // its sums
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

// What one of these brings stands for all that make a path of this length: one over the probability of its choice.
float multiplexed_share(Multiplexed m) { return m.by_camera ? 1.0 : float(strategies(m.s + m.t - 1u)); }

// Blocks of numbers that the path has used: of the camera's in the lower half, of the light's in the upper one.
uint multiplexed_used(Multiplexed m) { return m.camera_random.dimension | (m.light_random.dimension - LIGHT_DIMENSION) << 16u; }

void multiplexed_begin_camera(inout Multiplexed m) {
    m.from_light = false;
    m.path = path_from_camera(camera_ray(m.position, m.lens), m.camera_random);
    m.partial = partial_camera(camera_importance(m.path.ray.direction), lens_choice(), lens_cosine(m.path.ray.direction));
}

// What the light's part shows to the camera, as a connection.
Connection multiplexed_show(inout Multiplexed m, Shown shown) {
    if (shown.value != vec3(0.0)) m.position = shown.position;
    return Connection(shown.value, shown.weight, shown.ray, shown.absorption);
}

// Begins a path; `random` is at its beginning. Of kind 0 is what the camera finds, others are as many segments long. Returns whether anything
// is left to follow.
bool multiplexed_begin(Sampler random, uint kind, inout Estimate e, out Multiplexed m) {
    m.light_random = random;
    m.light_random.dimension = LIGHT_DIMENSION;
    vec4 u = next4(random);
    vec4 choice = next4(random);
    m.camera_random = random;
    m.position = image_place(u.xy);
    m.lens = u.zw;
    m.by_camera = kind == 0u;
    uint count = strategies(kind);
    m.s = kind + 1u - count + min(uint(choice.x * float(count)), count - 1u);
    m.t = kind + 1u - m.s;
    if (m.by_camera) {
        multiplexed_begin_camera(m);
        return true;
    }
    vec4 a = next4(m.light_random);
    vec4 b = next4(m.light_random);
    m.emitted = light_emit(a, b);
    m.from_light = true;
    m.path = path_along(Ray(m.emitted.origin, m.emitted.direction, INFINITY), m.light_random, false);
    return m.s == 1u || m.emitted.power != vec3(0.0);
}

// Follows the part that is being made to its next vertex; returns whether anything is left to follow. What it finds there along a connection is
// still to be added, were nothing in between.
bool multiplexed_step(inout Multiplexed m, inout Estimate e, inout Connection found_by) {
    if (!m.by_camera && m.s == 1u) {
        found_by = multiplexed_show(m, shown_light(m.path, m.emitted));
        m.light_random.dimension += 1u; // what showed it
        return false;
    }
    Hit hit;
    Interaction at;
    Pixel anywhere;
    bool found = trace_visible(m.path.ray, hit, at, m.path.random, e.rays);
    if (!m.from_light) m.camera_random.dimension = m.path.random.dimension;
    uint segments = m.path.depth + 1u;
    bool last = !m.by_camera && segments + 1u == (m.from_light ? m.s : m.t);
    bool both_sides = segments <= longest(); // other kinds make paths of this length too
    if (!found) {
        if (HAS_BACKGROUND && m.by_camera) gather_background(anywhere, m.path, m.partial, both_sides, e);
        return false;
    }
    Vertex v = vertex_of(m.path.ray, at);
    path_absorb(m.path, v);
    path_measure(m.path, v);
    float arriving = abs(dot(m.path.ray.direction, v.at.normal));
    if (arriving == 0.0) return false;
    if (!m.from_light) {
        vec3 segment = v.at.position - m.path.from.position;
        float distance2 = dot(segment, segment);
        partial_arrive(m.partial, CAMERA == CAMERA_ORTHOGRAPHIC && m.path.depth == 0u ? 1.0 : distance2, arriving);
        if (m.by_camera) gather_emission(anywhere, m.path, hit, v, m.partial, both_sides, arriving, distance2, e);
    }
    if (v.material == NONE || segments >= MAX_DEPTH) return false;

    vec3 arrived = m.path.throughput;
    uint dimension = m.path.random.dimension;
    Bsdf b = vertex_material(v, m.path.ray, m.path.random);
    if (m.from_light) light_partial_arrive(m.partial, m.path, m.emitted, v, b, arriving);
    vec4 light_u = next4(m.path.random);
    vec4 bsdf_u = next4(m.path.random);
    if (m.from_light) m.light_random.dimension = m.path.random.dimension;
    else m.camera_random.dimension = m.path.random.dimension;
    if (last && bsdf_is_delta(b)) return false;

    if (last && m.from_light && m.t == 1u) {
        found_by = multiplexed_show(m, shown_vertex(m.path, m.emitted.power, v, b, m.partial, light_u));
        return false;
    }
    if (last && m.from_light) {
        m.end = LightVertex(v.at.position, m.path.ray.direction, v.at.normal, hit.primitive, hit.instance, hit.uv, m.emitted.power * arrived,
                            m.partial.d_vcm, m.partial.d_vc, dimension, segments, m.path.absorption);
        multiplexed_begin_camera(m);
        return true;
    }
    // What the camera finds of the lights at each vertex, or of the light's part at the last one.
    if (last || m.by_camera && !bsdf_is_delta(b)) found_by = join(m.path, v, b, m.partial, segments < longest(), End(!last, light_u, m.end, m.light_random));
    if (last) return false;

    BsdfSample s = partial_leave(m.partial, v, b, m.path.ray, bsdf_u.xyz);
    if (m.from_light) s.weight *= adjoint_factor(v, m.path.ray, s);
    path_scatter(m.path, v, b, s);
    if (m.by_camera) return path_survives(m.path, m.path.eta * m.path.eta, bsdf_u.w);
    return m.path.throughput != vec3(0.0);
}

bool multiplexed_extend(inout Multiplexed m, inout Estimate e) {
    Connection found_by;
    found_by.value = vec3(0.0);
    // Segments of the whole path: by the camera alone one more than it has.
    uint segments = m.by_camera ? m.path.depth + 2u : m.s + m.t - 1u;
    bool left = multiplexed_step(m, e, found_by);
    if (found_by.value != vec3(0.0)) contribute(e, segments, found_by.value * ray_transmittance(found_by.ray, found_by.absorption, e.rays) * found_by.weight);
    return left;
}
