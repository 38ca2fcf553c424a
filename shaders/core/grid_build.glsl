// The main functions of the passes that fill the grid: cells are emptied, points counted, places allotted and filled. Before this is
// included, the technique defines
//     bool grid_point(uint index, out vec3 position)
// which is false where nothing was kept.
#include "core/grid.glsl"

layout(local_size_x = WORKGROUP) in;

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    uint index = frame.first_slot + gl_GlobalInvocationID.x;
    GridCells cells = GridCells(frame.grid_cells);
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
    if (!grid_point(index, position)) return;
    uint cell = grid_index(grid_coordinates(position));
    uint before = atomicAdd(cells.at[cell].count, 1u);
#ifdef PASS_GRID_FILL
    GridPlaces(frame.grid_places).at[cells.at[cell].first + before] = index;
#endif
#endif
}
