// Paths as their vertices, from the camera (0) to the light (k, where k is the number of segments): the state of a chain that mutates
// paths themselves (Veach and Guibas 1997). A chain keeps two, its current path and the one that is proposed.
//
// A vertex also has the key of random numbers that are its own: which of two blended materials is met there, which delta lobe it
// scatters by. They are part of the path, uniform, and stay with it while it is perturbed, so that nothing depends on how they were drawn.
#include "techniques/metropolis/chains.glsl"

// Kinds of vertices. Only the last one is not on a surface that was hit.
const uint VERTEX_SURFACE = 0u;
const uint VERTEX_AREA = 1u;       // a point of an area light, chosen by that
const uint VERTEX_BACKGROUND = 2u; // infinitely far: `position` is the direction there
const uint VERTEX_POINT = 3u;      // a light without extent
const uint VERTEX_PARALLEL = 4u;   // parallel light: `position` is the direction there
const uint VERTEX_DELTA = 8u;      // a bit: the path is scattered there by a delta lobe

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PathVertices { PathVertex vertex; };

// Where a chain keeps a vertex of one of its two paths.
PathVertices path_vertex(uint chain, uint slot, uint i) {
    ChainTable table = chain_table();
    uint64_t room = uint64_t(table.kind_count); // one more than segments
    uint64_t index = (uint64_t(chain) * 2ul + uint64_t(slot)) * room + uint64_t(i);
    return PathVertices(unpack32(pack64(table.numbers) + uint64_t(PATH_VERTEX_BYTES) * index));
}

uint vertex_kind(PathVertex x) { return x.kind & ~VERTEX_DELTA; }
bool scatters_by_delta(PathVertex x) { return (x.kind & VERTEX_DELTA) != 0u; }
bool is_distant(PathVertex x) { return vertex_kind(x) == VERTEX_BACKGROUND || vertex_kind(x) == VERTEX_PARALLEL; }
// No path from the camera runs into it.
bool is_alone(PathVertex x) { return vertex_kind(x) == VERTEX_POINT || vertex_kind(x) == VERTEX_PARALLEL; }

// Random numbers of a vertex: of its material from 0 on, of passing masks on the way to it from MASK_NUMBERS on, of scattering at
// SCATTER_NUMBERS.
const uint VERTEX_NUMBERS = 1024u;
const uint MASK_NUMBERS = 256u;
const uint SCATTER_NUMBERS = 1023u;

Sampler vertex_random(PathVertex x, uint first) { return Sampler(x.own.x, x.own.y, x.own.z + first, 0u); }

// The key of the i-th vertex of what a mutation makes.
uvec3 vertex_key(Sampler random, uint i) { return uvec3(random.chain, random.mutation, (i + 1u) * VERTEX_NUMBERS); }

Hit vertex_hit(PathVertex x) { return Hit(0.0, x.index, x.detail.x, uintBitsToFloat(x.detail.yz)); }

vec3 light_normal(PathVertex x) { return uintBitsToFloat(x.detail); }
vec3 light_radiance(PathVertex x) { return uintBitsToFloat(x.own); }

// A vertex before anything is known of it.
PathVertex new_vertex(vec3 position, uint kind) { return PathVertex(position, kind, uvec3(0u), NONE, uvec3(0u), 0.0, 0.0, 1.0, 0.0, 0.0); }

// Unit direction from one vertex to the next one.
vec3 segment_direction(PathVertex x, PathVertex next) { return is_distant(next) ? next.position : normalize(next.position - x.position); }
