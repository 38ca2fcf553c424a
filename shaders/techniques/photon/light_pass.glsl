// The main function of photon mapping's pass `light`: follows the light paths of a sample and keeps photons of them.
#include "techniques/photon/photons.glsl"
#include "transport/light_subpath.glsl"

layout(local_size_x = WORKGROUP) in;

// Follows the path to its next vertex, keeps a photon there, and chooses the ray after it.
bool light_path_extend(PhotonPath kept, vec3 power, inout Path path, inout uint met, inout uint rays) {
    Hit hit;
    Interaction at;
    if (!trace_visible(path.ray, hit, at, path.random, rays)) return false;
    Vertex v = vertex_of(path.ray, at);
    path_absorb(path, v);
    if (v.material == NONE) return false;
    Bsdf b = vertex_material(v, path.ray, path.random);
    uint segments = path.depth + 1u;
    vec4 bsdf_u = next4(path.random);
    if (!bsdf_is_delta(b) && (PARAM0 == DIRECT_PHOTONS || segments > 1u)) {
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

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    uint index = frame.first_slot + gl_GlobalInvocationID.x;
    if (index >= frame.light_path_count) return;
    PhotonPath kept = photon_path(index);
    uint rays = 0u, met = 0u;
    EmittedRay emitted;
    Path path = light_path_begin(index, frame.first_sample, emitted);
    bool alive = MAX_DEPTH > 1u && emitted.power != vec3(0.0);
    while (alive) alive = light_path_extend(kept, emitted.power, path, met, rays);
    kept.count = min(met, frame.light_vertices);
    if (met > kept.count) {
        for (uint i = 0u; i < kept.count; i++) kept.at[i].power *= kept_share(met);
    }
    count_rays(rays);
}
