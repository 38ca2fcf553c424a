// A hashed grid of points: which of them lie within a radius of a place. Its cells are twice the radius wide, so that a ball meets
// eight at most. The order of points within a cell, and of cells among the places, is left to chance.
#include "lib/rng.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GridCells { uint taken; GridCell at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GridPlaces { uint at[]; };

// The position in units of cells. The same bits in every kernel, or a point would be sought where it is not.
vec3 grid_scaled(vec3 position) {
    precise vec3 scaled = (position - scene.centre) / (2.0 * frame.merge_radius);
    return scaled;
}

ivec3 grid_coordinates(vec3 position) { return ivec3(floor(grid_scaled(position))); }

// The first of the eight cells, in each direction, that a ball around the position meets.
ivec3 grid_corner(vec3 position) { return ivec3(floor(grid_scaled(position) - 0.5)); }

// Cells far apart may share an entry of the table: whoever reads one must look at the points' own coordinates.
uint grid_index(ivec3 coordinates) { return pcg4d(uvec4(coordinates, 0)).x & (frame.grid_cell_count - 1u); }
