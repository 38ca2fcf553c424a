// What a camera path sees where it ends: light that shines from a surface, or from the background.

// Emission of the vertex towards where the path came from: from the geometric front only, which is the side that light
// sampling chooses points of. A mask does not count here: a path that meets it has been let through by its share already.
vec3 vertex_emission(Vertex v, Ray ray) {
    if (dot(ray.direction, v.at.normal) >= 0.0) return vec3(0.0);
    vec3 emission = v.surface.emission;
    if (HAS_TEXTURED_LIGHTS && v.surface.emission_texture != NONE && emission != vec3(0.0))
        emission *= texture_at(v.surface.emission_texture, v.at.uv).rgb;
    return emission;
}

// Weight of having found that emission by the BSDF's choice of direction, against a light sample at the last vertex. A
// delta lobe's choice has no competitor.
float emission_weight(Path path, Hit hit, Vertex v) {
    return path.delta ? 1.0 : power_heuristic(path.pdf_w, light_pdf(path.from, path.ray, hit, v.at, v.surface));
}

// The same for the background.
float background_weight(Path path) {
    return path.delta ? 1.0 : power_heuristic(path.pdf_w, background_pdf(path.ray.direction));
}
