// Where the vertices of light paths are kept, path by path.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer LightPath { uint count; LightVertex at[]; };

LightPath light_path_at(uint64_t place) {
    uint64_t bytes = 4ul + uint64_t(LIGHT_VERTEX_BYTES) * uint64_t(frame.light_vertices);
    return LightPath(unpack32(pack64(frame.light_paths) + place * bytes));
}

bool grid_point(uint index, out vec3 position) {
    LightPath path = light_path_at(uint64_t(index / frame.light_vertices));
    uint place = index % frame.light_vertices;
    position = vec3(0.0);
    if (place >= path.count) return false;
    position = path.at[place].position;
    return true;
}
