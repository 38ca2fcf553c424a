// The passes that fill the grid: cells are emptied, points counted, places allotted and filled. The points are the vertices that light
// subpaths left: for each subpath their number, then room for `light_subpaths.light_vertices` records that begin with a position.
#include "core/grid.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PointCount { uint at; };

// A point's position; false where nothing was kept.
bool grid_point(uint index, uint record_bytes, out vec3 position) {
    uint path = index / light_subpaths.light_vertices, place = index % light_subpaths.light_vertices;
    uint64_t first = pack64(light_path_address(uint64_t(path), record_bytes));
    position = vec3(0.0);
    if (place >= PointCount(unpack32(first)).at) return false;
    position = Vectors(unpack32(first + 4ul + uint64_t(record_bytes) * uint64_t(place))).at[0];
    return true;
}

void grid_build(uint record_bytes) {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    uint index = frame.first_slot + gl_GlobalInvocationID.x;
    GridCells cells = GridCells(light_subpaths.grid_cells);
#if defined(PASS_GRID_CLEAR)
    cells.at[index].count = 0u;
    if (index == 0u) cells.taken = 0u;
#elif defined(PASS_GRID_ALLOT)
    // Any order of cells is as good as another, so that no prefix sum is needed.
    uint count = cells.at[index].count;
    if (count == 0u) return;
    cells.at[index] = GridCell(atomicAdd(cells.taken, count), 0u);
#else
    vec3 position;
    if (!grid_point(index, record_bytes, position)) return;
    uint cell = grid_index(grid_coordinates(position));
    uint before = atomicAdd(cells.at[cell].count, 1u);
#ifdef PASS_GRID_FILL
    GridPlaces(light_subpaths.grid_places).at[cells.at[cell].first + before] = GridPlace(position, index);
#endif
#endif
}

// The main function, for records of so many bytes.
#define GRID_BUILD(record_bytes) \
    layout(local_size_x = WORKGROUP) in; \
    void main() { grid_build(record_bytes); }
