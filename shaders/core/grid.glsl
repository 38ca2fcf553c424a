// A hashed grid of points: which of them lie within a radius of a place. Its cells are twice the radius wide, so that a ball meets
// eight at most. The order of points within a cell, and of cells among the places, is left to chance.
#include "core/light_subpath_table.glsl"
#include "core/rng.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GridCells { uint taken; GridCell at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GridPlaces { uint at[]; };

// The position in units of cells. The same bits in every kernel, or a point would be sought where it is not.
vec3 grid_scaled(vec3 position) {
    precise vec3 scaled = (position - scene.centre) / (2.0 * merge_radius());
    return scaled;
}

ivec3 grid_coordinates(vec3 position) { return ivec3(floor(grid_scaled(position))); }

// The first of the eight cells, in each direction, that a ball around the position meets.
ivec3 grid_corner(vec3 position) { return ivec3(floor(grid_scaled(position) - 0.5)); }

// Cells far apart may share an entry of the table: whoever reads one must look at the points' own coordinates.
uint grid_index(ivec3 coordinates) { return pcg4d(uvec4(coordinates, 0)).x & (light_subpaths.grid_cell_count - 1u); }

// A search for the points of a sample around a place:
//     GridSearch search = grid_search(position);
//     while (grid_next(search)) ... search.index ...
// finds all of them, and others besides: grid_found tells by a point's position.
struct GridSearch {
    vec3 position;
    ivec3 coordinates; // of the cell
    uint cell;         // cells of the eight that have been begun
    uint at, end;      // places of the cell that are left
    uint index;        // the point
};

GridSearch grid_search(vec3 position) { return GridSearch(position, ivec3(0), 0u, 0u, 0u, 0u); }

bool grid_next(inout GridSearch s) {
    while (s.at == s.end) {
        if (s.cell == 8u) return false;
        s.coordinates = grid_corner(s.position) + ivec3(s.cell & 1u, s.cell >> 1u & 1u, s.cell >> 2u);
        GridCell cell = GridCells(light_subpaths.grid_cells).at[grid_index(s.coordinates)];
        s.at = cell.first;
        s.end = cell.first + cell.count;
        s.cell += 1u;
    }
    s.index = GridPlaces(light_subpaths.grid_places).at[s.at];
    s.at += 1u;
    return true;
}

// Whether the point at this position lies within the radius, and in the cell that is being searched.
bool grid_found(GridSearch s, vec3 position) {
    vec3 d = position - s.position;
    return dot(d, d) < merge_radius() * merge_radius() && grid_coordinates(position) == s.coordinates;
}

// Points count only where the surface faces nearly as it does at the place (26 degrees): not those of the wall round the corner, nor
// those on the other side of a sheet.
bool same_facing(vec3 a, vec3 b) { return dot(a, b) >= 0.9; }
