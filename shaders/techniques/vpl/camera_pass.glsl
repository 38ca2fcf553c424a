// The pass `camera` of instant radiosity: follows paths from the camera and gathers at their vertices.
//
// At a vertex x the virtual point lights account for the share min(1, c / G) of the light that the broad lobes of x take from those of the next
// vertex y, where G is the geometry term between x and y and c its bound. A path that goes on from x to y by a broad lobe accounts for the rest of it,
// 1 - min(1, c / G), and for all that y scatters by narrow lobes, deltas among them, which are no virtual point lights; one that goes on by a
// narrow lobe of x accounts for all that y scatters.
#include "transport/camera_lanes.glsl"
#include "transport/emission.glsl"
#include "transport/light_vertices.glsl"
#include "transport/split.glsl"
#include "generated/parameters.glsl"

const bool COMPENSATES = COMPENSATE == COMPENSATE_YES;

struct Lane {
    CameraLane camera;
    vec3 from;     // position of the last vertex that scattered
    bool followed; // it did so by a narrow lobe, or is the camera
};

bool open(out Lane lane) { return camera_open(lane.camera); }
bool has_next(Lane lane) { return camera_has_next(lane.camera); }

bool begin(inout Lane lane) {
    lane.from = vec3(0.0);
    lane.followed = true;
    return camera_begin(lane.camera);
}

// min(1, c / G): the share of the geometry term that clamping leaves; `d` goes from x to y. CLAMP is c in units of one over the square of the
// radius of all that does not emit; 0 is no bound.
float clamped_share(vec3 x_normal, vec3 y_normal, vec3 d) {
    if (CLAMP == 0.0) return 1.0;
    float distance2 = dot(d, d);
    float g = abs(dot(x_normal, d) * dot(y_normal, d)) / (distance2 * distance2);
    return min(1.0, CLAMP / (scene.core_radius * scene.core_radius * g));
}

// Contribution of a virtual point light at a vertex of the path, for paths of so many segments; nothing where they are too long.
vec3 virtual_light(Path path, Vertex v, Bsdf b, LightVertex y, Sampler random, inout uint rays) {
    Bsdf far;
    Vertex w = light_vertex(y, random, far);
    vec3 d = w.at.position - v.at.position;
    float distance2 = dot(d, d);
    if (distance2 == 0.0) return vec3(0.0);
    vec3 towards = d * inversesqrt(distance2);
    vec3 local = vertex_to_local(v, towards);
    vec3 contribution = path.throughput * y.power * vertex_eval(v, broad_lobes(b), path.ray, local, towards) *
                        light_vertex_eval(w, broad_lobes(far), light_vertex_ray(y), vertex_to_local(w, -towards), -towards) / distance2;
    contribution *= clamped_share(vertex_reference(v, b).normal, w.at.normal, d);
    if (contribution == vec3(0.0)) return contribution;
    Ray ray = vertex_ray_between(v, towards, w);
    return contribution * ray_transmittance(ray, false, vertex_absorption(v, b, path.absorption, local), rays);
}

// Adds the light of the virtual point lights of some subpaths, which stand for all: `share` is what the vertex accounts for.
void add_virtual_lights(inout Path path, Vertex v, Bsdf b, uint sample_index, float share, inout Estimate e) {
    uint count = light_subpaths.light_path_count;
    uint chosen = min(uint(GATHERED), count);
    float u = next4(path.random).x;
    for (uint k = 0u; k < chosen; k++) {
        // Systematic sampling: each subpath is chosen with the probability chosen / count.
        uint index = min(whole((float(k) + u) * (float(count) / float(chosen))), count - 1u);
        LightPath kept = light_path_at(uint64_t(index));
        Sampler random = light_path_random(index, sample_index);
        for (uint i = 0u; i < kept.count; i++) {
            LightVertex y = kept.at[i];
            uint length = path.depth + 2u + y.segments;
            if (length > MAX_DEPTH) continue;
            contribute(e, length, virtual_light(path, v, b, y, random, e.rays) * (share / float(chosen)));
        }
    }
}

bool extend(inout Lane lane) {
    Path path = lane.camera.path;
    // 1. Arrive at the next vertex, or leave the scene.
    Vertex v;
    if (!path_arrive(path, v, lane.camera.e.rays)) {
        if (HAS_BACKGROUND) contribute(lane.camera.e, path.depth + 1u, background_contribution(path) * background_weight(path));
        return false;
    }
    vec3 emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) contribute(lane.camera.e, path.depth + 1u, path.throughput * emission * emission_weight(path, v));
    if (path.depth + 1u >= MAX_DEPTH || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);

    // 2. What the virtual point lights have left to this vertex: direct light, and virtual point lights in turn.
    float share = lane.followed ? 1.0 : 1.0 - clamped_share(path.from.normal, v.at.normal, v.at.position - lane.from);
    vec4 light_u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    BsdfSample s = bsdf_choose(b, v.wo, bsdf_u.xyz);
    bool connects = !bsdf_is_delta(b);
    LightSample light = no_light();
    if (connects) light = light_sample(vertex_reference(v, b), light_u);
    SplitEvent n = split_connect(path, v, b, light, connects, s);
    float weight = COMPENSATES ? nee_weight(n.broad) : 1.0; // without compensation no broad lobe is followed into lights
    contribute(lane.camera.e, path.depth + 2u, split_contribution(path, v, b, n, share * weight, nee_weight(n.narrow), lane.camera.e.rays));
    if (share > 0.0 && bsdf_has_broad(b)) add_virtual_lights(path, v, b, lane.camera.pixel.sample_index, share, lane.camera.e);

    // 3. Scatter.
    if (!s.narrow) {
        if (!COMPENSATES) return false;
        s.weight *= share;
    }
    path_scatter(path, v, b, s);
    bool alive = path_survives(path, path.eta * path.eta, bsdf_u.w);
    lane.from = v.at.position;
    lane.followed = s.narrow;
    lane.camera.path = path;
    return alive;
}

void end(inout Lane lane) { camera_end(lane.camera); }
void close(Lane lane) { camera_close(lane.camera); }

LANES(Lane, open, has_next, begin, extend, end, close)
