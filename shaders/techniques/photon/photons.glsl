// The photons of a sample: of each light subpath a few, numbered subpath by subpath.
#include "generated/parameters.glsl"
#include "core/light_table.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PhotonPath { uint count; Photon at[]; };

PhotonPath photon_path(uint path) {
    uint64_t bytes = 4ul + uint64_t(PHOTON_BYTES) * uint64_t(light_table.light_vertices);
    return PhotonPath(unpack32(pack64(light_table.light_paths) + uint64_t(path) * bytes));
}
