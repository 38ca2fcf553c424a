// Narrow lobes: what is as smooth as a mirror, by one rule for all techniques. A lobe is narrow where the geometric mean of its two alphas lies
// below NARROW_ALPHA: fewer than 1 in 500 directions see it. Who is given both directions, as a photon, a virtual point light or a connection to the
// camera gives them, finds next to nothing there, and once in a while a value that is thousands of times too large.
//
// Techniques that have no other way to find a path split BSDFs: they define SPLITS_LOBES, evaluate broad lobes for directions that they are given,
// and follow narrow ones as they follow delta lobes. A sample then stands for its own class of lobes, by whose value and density it is weighted;
// those of both classes together have the mean of the whole BSDF.

#ifdef SPLITS_LOBES
const bool SPLITS = HAS_NARROW_LOBES && SPLITS_LOBES;
#else
const bool SPLITS = false;
#endif

bool is_narrow(vec2 alpha) { return HAS_NARROW_LOBES && alpha.x * alpha.y < NARROW_ALPHA * NARROW_ALPHA; }

// Whether lobes of that class take part where this material is evaluated: all of them, but in techniques that split.
bool takes_lobes(Material m, bool narrow) { return !SPLITS || (m.flags & (narrow ? WITHOUT_NARROW_LOBES : WITHOUT_BROAD_LOBES)) == 0u; }
