// The pass `lights` of instant radiosity: follows the light subpaths of a sample, each of which leaves virtual point lights.
#include "transport/light_lanes.glsl"
#include "transport/light_vertices.glsl"

struct Lane {
    LightLane light;
    LightPath kept;
    uint met; // vertices of the subpath that were kept, or would have been if there were room
};

// Slots number subpaths here, and not pixels; the sample is the job's.
bool open(out Lane lane) {
    lane.light.pixel.index = frame.first_slot + gl_GlobalInvocationID.x;
    lane.light.pixel.sample_index = frame.word;
    lane.light.rays = 0u;
    return lane.light.pixel.index < light_subpaths.light_path_count;
}

bool has_next(Lane lane) { return lane.light.pixel.sample_index == frame.word; }

bool begin(inout Lane lane) {
    light_begin(lane.light);
    lane.kept = light_path_at(uint64_t(lane.light.pixel.index));
    lane.met = 0u;
    return MAX_DEPTH > 2u && lane.light.emitted.power != vec3(0.0);
}

// Follows the subpath to its next vertex, leaves a virtual point light there, and chooses the ray after it.
bool extend(inout Lane lane) {
    Path path = lane.light.path;
    Vertex v;
    if (!path_arrive(path, v, lane.light.rays) || v.material == NONE) return false;
    LightVertex y = LightVertex(v.at.position, path.ray.direction, v.at.normal, v.hit.primitive, v.hit.instance, v.hit.uv,
                                lane.light.emitted.power * path.throughput, 0.0, 0.0, path.random.dimension, path.depth + 1u, path.absorption);
    Bsdf b = vertex_material(v, path.ray, path.random);
    vec4 bsdf_u = next4(path.random);
    if (bsdf_has_broad(b)) {
        uint place = keep_place(lane.met, path.random);
        if (place != NONE) lane.kept.at[place] = y;
        lane.met += 1u;
    }
    // One more segment of the subpath, the connection, and one of the camera's.
    if (MAX_DEPTH - y.segments < 3u) return false;
    path_scatter(path, v, b, light_vertex_sample(v, b, path.ray, bsdf_u.xyz));
    bool alive = path_survives(path, 1.0, bsdf_u.w);
    lane.light.path = path;
    return alive;
}

void end(inout Lane lane) {
    LIGHT_PATH_CLOSE(lane.kept, lane.met)
    light_end(lane.light);
}

void close(Lane lane) { light_close(lane.light); }

LANES(Lane, open, has_next, begin, extend, end, close)
