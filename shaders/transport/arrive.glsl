// Follows the path to its next vertex, and counts in full what it runs into by chance: emission there, or the background where it leaves
// the scene; false where it does.
bool path_arrive(inout Path path, out Vertex v, out vec3 emission, inout Estimate e) {
    Hit hit;
    Interaction at;
    bool found = path_trace(path, hit, at, e);
    if (!found) {
        if (HAS_BACKGROUND) contribute(e, path.depth + 1u, path.throughput * background_radiance(path.ray.direction));
        return false;
    }
    v = vertex_of(path.ray, at);
    path_absorb(path, v);
    path_measure(path, v);
    emission = vertex_emission(v, path.ray);
    contribute(e, path.depth + 1u, path.throughput * emission);
    return true;
}
