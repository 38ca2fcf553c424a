// A hashed grid of points: which of them lie within a radius of a place. Its cells are twice the radius wide, so that a ball meets
// eight at most. The order of points within a cell, and of cells among the places, is left to chance.
#include "core/light_subpath_table.glsl"
#include "core/rng.glsl"
#include "core/whole.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GridCells { uint taken; GridCell at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer GridPlaces { GridPlace at[]; };

// The position in units of cells. The same bits in every kernel, or a point would be sought where it is not.
vec3 grid_scaled(vec3 position) {
    precise vec3 scaled = (position - scene.centre) / (2.0 * merge_radius());
    return scaled;
}

// The cell that a position lies in: whole numbers.
vec3 grid_coordinates(vec3 position) { return floor(grid_scaled(position)); }

// The first of the eight cells, in each direction, that a ball around the position meets.
vec3 grid_corner(vec3 position) { return floor(grid_scaled(position) - 0.5); }

// Cells far apart may share an entry of the table: whoever reads one must look at the points' own coordinates.
uint grid_index(vec3 coordinates) {
    ivec3 cell = ivec3(whole_signed(coordinates.x), whole_signed(coordinates.y), whole_signed(coordinates.z));
    return pcg4d(uvec4(cell, 0)).x & (light_subpaths.grid_cell_count - 1u);
}

GridPlace load_place(uint index) {
    if (!WIDE_LOADS) return GridPlaces(light_subpaths.grid_places).at[index];
    Words64 words = words_from(light_subpaths.grid_places, 2u * index);
    uvec2 first = unpack32(words.at[0]), second = unpack32(words.at[1]);
    return GridPlace(uintBitsToFloat(uvec3(first, second.x)), second.y);
}

// A search for the points of a sample around a place:
//     GridSearch search = grid_search(position);
//     while (grid_next(search)) ... search.index ...
// finds each point within the radius once.
struct GridSearch {
    vec3 position;
    vec3 coordinates;  // of the cell
    uint cell;         // cells of the eight that have been begun
    uint at, end;      // places of the cell that are left
    uint index;        // the point
};

GridSearch grid_search(vec3 position) { return GridSearch(position, vec3(0.0), 0u, 0u, 0u, 0u); }

// Goes on to the next point; false where there is none. Points that are too far away are passed in here, so that lanes which look for their next
// point wait for those that have it: what is done with a point costs more than passing many.
bool grid_next(inout GridSearch s) {
    bool found = false;
    while (!found && (s.at != s.end || s.cell != 8u)) {
        if (s.at == s.end) {
            vec3 corner = grid_corner(s.position), offset = vec3(s.cell & 1u, s.cell >> 1u & 1u, s.cell >> 2u);
            precise vec3 coordinates = corner + offset, moved = coordinates - corner;
            s.coordinates = coordinates;
            s.cell += 1u;
            // Where floats are too coarse to tell a cell from the next one, that is the same one again.
            if (moved == offset) {
                GridCell cell = GridCells(light_subpaths.grid_cells).at[grid_index(coordinates)];
                s.at = cell.first;
                s.end = cell.first + cell.count;
            }
        }
        if (s.at != s.end) {
            GridPlace place = load_place(s.at);
            s.at += 1u;
            s.index = place.index;
            vec3 d = place.position - s.position;
            // Another cell may share the entry of the table.
            found = dot(d, d) < merge_radius() * merge_radius() && grid_coordinates(place.position) == s.coordinates;
        }
    }
    return found;
}

// Points count only where the surface faces nearly as it does at the place (26 degrees): not those of the wall round the corner, nor
// those on the other side of a sheet.
bool same_facing(vec3 a, vec3 b) { return dot(a, b) >= 0.9; }
