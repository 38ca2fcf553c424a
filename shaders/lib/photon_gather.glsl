// What photons around a vertex bring: the density estimate with a constant kernel (Jensen 1996).
#include "lib/photons.glsl"
#include "lib/grid.glsl"
#include "lib/light_path.glsl"

// Photons count only where the surface faces nearly as it does here (26 degrees): not those of the wall round the corner, nor those
// on the other side of a sheet.
const float SAME_FACING = 0.9;
// Beyond this many units a contribution counts as not finite: a sum of 64 of them fits into 64 bits.
const float LARGEST_GATHERED = 1.44e17; // 2^57

// Photons come in any order: their contributions are summed in units of scene.splat_unit, as integers, so that it does not matter.
void gather_photons(Path path, Vertex v, Bsdf b, inout Estimate e) {
    i64vec3 sums[LENGTH_LAYERS + 1u];
    for (uint i = 0u; i <= LENGTH_LAYERS; i++) sums[i] = i64vec3(0l);
    uint length = path.depth + 1u;
    float radius2 = frame.merge_radius * frame.merge_radius;
    vec3 factor = path.throughput / (PI * radius2 * light_path_count() * scene.splat_unit);
    bool finite = true;
    ivec3 corner = grid_corner(v.at.position);
    for (uint i = 0u; i < 8u; i++) {
        ivec3 coordinates = corner + ivec3(i & 1u, i >> 1u & 1u, i >> 2u);
        GridCell cell = GridCells(frame.grid_cells).at[grid_index(coordinates)];
        for (uint k = 0u; k < cell.count; k++) {
            uint index = GridPlaces(frame.grid_places).at[cell.first + k];
            PhotonPath kept = photon_path(index / frame.light_vertices);
            uint place = index % frame.light_vertices;
            vec3 position = kept.at[place].position;
            vec3 d = position - v.at.position;
            if (dot(d, d) >= radius2 || grid_coordinates(position) != coordinates) continue;
            Photon y = kept.at[place];
            // Photons are as dense as the geometric cosine says, the BSDF goes by the shading one.
            float arriving = abs(dot(y.direction, y.normal));
            if (dot(y.normal, v.at.normal) < SAME_FACING || arriving == 0.0 || y.segments > MAX_DEPTH - length) continue;
            vec3 units = factor * y.power * vertex_eval(v, b, path.ray, vertex_to_local(v, -y.direction), -y.direction) / arriving;
            if (!all(lessThan(abs(units), vec3(LARGEST_GATHERED)))) {
                finite = false;
                continue;
            }
            sums[LENGTH_LAYERS > 0u ? min(length + y.segments, LENGTH_LAYERS) - 1u : 0u] += i64vec3(round(units));
        }
    }
    if (LENGTH_LAYERS == 0u) contribute(e, length + 1u, vec3(sums[0]) * scene.splat_unit);
    for (uint i = 0u; i < LENGTH_LAYERS; i++) contribute(e, i + 1u, vec3(sums[i]) * scene.splat_unit);
    if (!finite) contribute(e, length, vec3(uintBitsToFloat(0x7f800000u))); // infinity: the sample is dropped and counted
}
