// Density estimation: contributions of points that are met in any order, as integers in units of scene.splat_unit, so that the order of the
// sum does not matter.
#include "core/film.glsl"
#include "core/whole.glsl"

struct DensitySums {
    i64vec3 sums[LENGTH_LAYERS + 1u]; // by path length, or all in the first
    bool finite;
};

void density_clear(out DensitySums g) {
    for (uint i = 0u; i <= LENGTH_LAYERS; i++) g.sums[i] = i64vec3(0l);
    g.finite = true;
}

// Adds the contribution of a path of `length` segments, in units.
void density_add(inout DensitySums g, uint length, vec3 units) {
    if (all(lessThan(abs(units), vec3(LARGEST_FIXED)))) g.sums[LENGTH_LAYERS > 0u ? min(length, LENGTH_LAYERS) - 1u : 0u] += i64vec3(rounded64(units.x), rounded64(units.y), rounded64(units.z));
    else g.finite = false;
}

void density_contribute(inout Estimate e, DensitySums g) {
    if (LENGTH_LAYERS == 0u) contribute(e, 1u, vec3(g.sums[0]) * scene.splat_unit);
    for (uint i = 0u; i < LENGTH_LAYERS; i++) contribute(e, i + 1u, vec3(g.sums[i]) * scene.splat_unit);
    if (!g.finite) contribute(e, 1u, vec3(uintBitsToFloat(0x7f800000u))); // infinity: the sample is dropped and counted
}
