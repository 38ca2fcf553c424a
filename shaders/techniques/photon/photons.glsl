// The photons of a sample: of each light path a few, numbered path by path.

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PhotonPath { uint count; Photon at[]; };

PhotonPath photon_path(uint path) {
    uint64_t bytes = 4ul + uint64_t(PHOTON_BYTES) * uint64_t(frame.light_vertices);
    return PhotonPath(unpack32(pack64(frame.light_paths) + uint64_t(path) * bytes));
}

bool grid_point(uint index, out vec3 position) {
    PhotonPath path = photon_path(index / frame.light_vertices);
    uint place = index % frame.light_vertices;
    position = vec3(0.0);
    if (place >= path.count) return false;
    position = path.at[place].position;
    return true;
}
