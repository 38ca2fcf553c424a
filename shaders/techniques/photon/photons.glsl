// The photons of a sample: of each light subpath a few, numbered subpath by subpath.
#include "generated/parameters.glsl"
#include "core/light_subpath_table.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PhotonPath { uint count; Photon at[]; };

PhotonPath photon_path(uint path) { return PhotonPath(light_path_address(uint64_t(path), PHOTON_BYTES)); }
