// The pass `light` of photon mapping: follows the light subpaths of a sample and keeps photons of them.
#include "techniques/photon/photons.glsl"
#include "transport/light_lanes.glsl"

struct Lane {
    LightLane light;
    PhotonPath kept;
    uint met; // photons of the subpath that were kept, or would have been if there were room
};

bool open(out Lane lane) { return light_open(lane.light); }
bool has_next(Lane lane) { return light_has_next(lane.light); }

bool begin(inout Lane lane) {
    light_begin(lane.light);
    lane.kept = photon_path(lane.light.pixel.index);
    lane.met = 0u;
    return MAX_DEPTH > 1u && lane.light.emitted.power != vec3(0.0);
}

// Follows the subpath to its next vertex, keeps a photon there, and chooses the ray after it.
bool follow(PhotonPath kept, vec3 power, inout Path path, inout uint met, inout uint rays) {
    Vertex v;
    if (!path_arrive(path, v, rays) || v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    uint segments = path.depth + 1u;
    vec4 bsdf_u = next4(path.random);
    if (bsdf_has_broad(b) && (DIRECT == DIRECT_PHOTONS || segments > 1u)) {
        // A mask thins out photons and the paths that gather them: once is what it should be.
        vec3 arrived = power * path.throughput / vertex_opacity(v);
        uint place = keep_place(met, path.random);
        if (place != NONE) kept.at[place] = Photon(v.at.position, path.ray.direction, v.at.normal, arrived, segments);
        met += 1u;
    }
    // The camera's own segment, and one to the next photon.
    if (MAX_DEPTH - segments < 2u) return false;
    path_scatter(path, v, b, light_vertex_sample(v, b, path.ray, bsdf_u.xyz));
    return path_survives(path, 1.0, bsdf_u.w);
}

bool extend(inout Lane lane) { return follow(lane.kept, lane.light.emitted.power, lane.light.path, lane.met, lane.light.rays); }

void end(inout Lane lane) {
    LIGHT_PATH_CLOSE(lane.kept, lane.met)
    light_end(lane.light);
}

void close(Lane lane) { light_close(lane.light); }

LANES(Lane, open, has_next, begin, extend, end, close)
