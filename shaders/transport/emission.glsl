// Light that a path from the camera runs into: emission of the surface where it arrives, or of the background.
#include "transport/path.glsl"

// Emitted radiance of the vertex towards where the path came from: from the geometric front only, unless the surface says otherwise, as light
// sampling has it. A mask does not count here: a path that meets it has been let through by its share already.
vec3 vertex_emission(Vertex v, Ray ray) {
    bool behind = dot(ray.direction, v.at.normal) >= 0.0;
    if (behind && !(HAS_LIGHTS_BEHIND && (v.surface.flags & SURFACE_EMITS_BEHIND) != 0u)) return vec3(0.0);
    vec3 emission = v.surface.emission;
    if (HAS_TEXTURED_LIGHTS && v.surface.emission_texture != NONE && emission != vec3(0.0))
        emission *= texture_at(v.surface.emission_texture, place_of(v.at)).rgb;
    return emission;
}

// Records the emission that the path has run into: with its density as the BSDF's choice, and that as a light sample.
void record_emission(Path path, vec3 emission, float light_pdf_w, float weight) {
    PathRecord r = record_of(RECORD_EMISSION, path.depth + 1u);
    r.direction = -path.ray.direction;
    r.value = emission;
    r.throughput = path.throughput;
    r.pdf = path.delta ? 0.0 : path.pdf_w;
    r.other_pdf = light_pdf_w;
    r.weight = weight;
    record_append(r);
}

// MIS weight of that emission as found by the BSDF's choice of direction, against next-event estimation at the last vertex (power
// heuristic). A delta lobe's choice has no competitor.
float emission_weight(Path path, Vertex v) {
    float light_pdf_w = path.delta ? 0.0 : light_pdf(path.from, path.ray, v.hit, v.at, v.surface);
    float weight = path.delta ? 1.0 : power_heuristic(path.pdf_w, light_pdf_w);
    if (records(RECORD_EMISSION)) record_emission(path, vertex_emission(v, path.ray), light_pdf_w, weight);
    return weight;
}

// The weight of the background, likewise.
float background_weight(Path path) {
    float light_pdf_w = path.delta ? 0.0 : background_pdf(path.ray.direction);
    float weight = path.delta ? 1.0 : power_heuristic(path.pdf_w, light_pdf_w);
    if (records(RECORD_EMISSION)) record_emission(path, background_radiance(path.ray.direction), light_pdf_w, weight);
    return weight;
}

// Contribution of the background where a path has left the scene.
vec3 background_contribution(Path path) {
    if (HIDES_EMITTERS && path.depth == 0u) return vec3(0.0);
    return path.throughput * background_radiance(path.ray.direction);
}

// Follows the path to its next vertex, and counts the emission there, or the background where the path leaves the scene, in which case it returns
// false: in full, or weighted against next-event estimation.
bool arrive_at_emission(inout Path path, bool surfaces_weighted, bool background_weighted, out Vertex v, out vec3 emission, inout Estimate e) {
    emission = vec3(0.0);
    if (!path_arrive(path, v, e.rays)) {
        if (HAS_BACKGROUND) contribute(e, path.depth + 1u, background_contribution(path) * (background_weighted ? background_weight(path) : 1.0));
        return false;
    }
    emission = vertex_emission(v, path.ray);
    if (emission != vec3(0.0)) contribute(e, path.depth + 1u, path.throughput * emission * (surfaces_weighted ? emission_weight(path, v) : 1.0));
    return true;
}
