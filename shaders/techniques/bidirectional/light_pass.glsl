// The pass `light` of bidirectional techniques: follows the light subpaths, connects their vertices to the camera (t = 1) and keeps them.
#include "techniques/bidirectional/connect.glsl"
#include "transport/light_lanes.glsl"

struct Lane {
    LightLane light;
    SubpathMis mis;
    CameraConnection beginning; // of the subpath, to be splatted
    LightPath kept;             // its vertices
    uint met;                   // vertices of the subpath that were kept, or would have been if there were room
};

bool open(out Lane lane) { return light_open(lane.light); }
bool has_next(Lane lane) { return light_has_next(lane.light); }

bool begin(inout Lane lane) {
    light_begin(lane.light);
    lane.kept = light_path_of(lane.light.pixel.index, lane.light.pixel.sample_index);
    lane.met = 0u;
    lane.beginning = no_camera_connection();
    if (CONNECTS && MAX_DEPTH > 0u) lane.beginning = connect_light_to_camera(lane.light.path, lane.light.emitted);
    return true;
}

// (s, 0): the path runs into the lens on its way along the ray, which ends at a distance. Not on its first segment: (1, 1) and (0, 2)
// are better at that.
void splat_lens(Pixel pixel, Path path, vec3 power, Ray ray, float end, SubpathMis m) {
    vec2 position;
    float t;
    if (path.depth == 0u || !lens_hit(ray, end, position, t)) return;
    float cosine = lens_cosine(ray.direction), importance = camera_importance(-ray.direction);
    mis_arrive(m, t * t, cosine);
    vec3 contribution = power * path.throughput * (importance / (lens_area() * cosine * light_path_count()));
    if (HAS_ABSORPTION) contribution *= exp(-path.absorption * t);
    vec4 u = next4(path.random);
    uint seen_by = splat_pixel(position, u.xy, contribution);
    if (seen_by == NONE) return;
    splat_weighted(seen_by, pixel.sample_index, path.depth + 2u, 0u, contribution, mis_lens_weight(m, importance, lens_choice()));
}

// Follows the subpath to its next vertex, connects that to the camera, keeps it, and chooses the ray after it; false where it ends.
bool follow(inout Lane lane, inout CameraConnection connection) {
    Path path = lane.light.path;
    EmittedRay e = lane.light.emitted;
    Ray ray = path.ray;
    vec3 throughput = path.throughput;
    Vertex v;
    bool found = path_arrive(path, v, lane.light.rays);
    bool to_lens = lens_choice() > 0.0;
    if (to_lens) {
        Path segment = path;
        segment.throughput = throughput; // before what the medium absorbs up to the vertex
        splat_lens(lane.light.pixel, segment, e.power, ray, found ? distance(ray.origin, path.ray.origin) + v.hit.t : INFINITY, lane.mis);
    }
    if (!found || path.depth + 2u > longest()) return false;
    float arriving = abs(dot(path.ray.direction, v.at.normal));
    if (v.material == NONE || arriving == 0.0) return false;
    LightVertex kept = LightVertex(v.at.position, path.ray.direction, v.at.normal, v.hit.primitive, v.hit.instance, v.hit.uv,
                                   e.power * path.throughput, 0.0, 0.0, path.random.dimension, path.depth + 1u, path.absorption);
    Bsdf b = vertex_material(v, path.ray, path.random);
    uint length = path.depth + 2u; // segments with one to the camera: this is vertex s = length
    mis_arrive_from_light(lane.mis, path, e, v, b, arriving);

    vec4 u = next4(path.random);
    vec4 bsdf_u = next4(path.random);
    if (bsdf_has_broad(b)) {
        // A connection adds a segment and one of the camera, a merge the camera's alone.
        if (MERGES || length < longest()) {
            kept.d_vcm = lane.mis.d_vcm;
            kept.d_vc = lane.mis.d_vc;
            uint place = keep_place(lane.met, path.random);
            if (place != NONE) lane.kept.at[place] = kept;
            lane.met += 1u;
        }
        if (CONNECTS) connection = connect_vertex_to_camera(path, e.power, v, b, lane.mis, u);
    }
    if (length >= longest() && !to_lens) return false; // one more segment for the lens
    BsdfSample s = mis_sample(lane.mis, v, b, path.ray, bsdf_u.xyz);
    s.weight *= adjoint_factor(v, path.ray, s);
    path_scatter(path, v, b, s);
    bool alive = path_survives(path, 1.0, bsdf_u.w);
    lane.light.path = path;
    return alive;
}

bool extend(inout Lane lane) {
    uint s = lane.light.path.depth + 2u;
    CameraConnection vertex = no_camera_connection();
    bool alive = MAX_DEPTH > 1u && lane.light.emitted.power != vec3(0.0) && follow(lane, vertex);
    if (CONNECTS) camera_splat_both(lane.beginning, vertex, lane.light.pixel.sample_index, s, lane.light.rays);
    return alive;
}

void end(inout Lane lane) {
    LIGHT_PATH_CLOSE(lane.kept, lane.met)
    light_end(lane.light);
}

void close(Lane lane) { light_close(lane.light); }

LANES(Lane, open, has_next, begin, extend, end, close)
