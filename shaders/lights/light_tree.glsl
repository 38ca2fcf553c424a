// Choosing one of many lights by a bound on its irradiance at a point: a descent through a tree of bounds on their places, directions
// and intensities (Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree splitting"). Which
// nodes there are, and why their bounds are safe, says src/scene/compile/light_tree.rs.

// What receives light: a point, and the normal of the side that can.
struct ReferencePoint {
    vec3 position;
    vec3 normal; // unit, of the shading frame; zero where light may come from anywhere
    bool both;   // light from the other side counts as well
};

// Bounds are packed and roundings differ: lights count as dark only beyond this much of a cosine.
const float DARK = 2e-3;
// The least factor for the cosine at the reference point: narrow lobes return more of grazing light than the cosine says.
const float LEAST_COSINE = 0.05;

LightNode load_light_node(uint index) {
    if (!WIDE_LOADS) return LightNodes(scene.light_tree).at[index];
    Words64 words = words_from(scene.light_tree, 4u * index);
    uvec2 w0 = unpack32(words.at[0]);
    uvec2 w1 = unpack32(words.at[1]);
    uvec2 w2 = unpack32(words.at[2]);
    uvec2 w3 = unpack32(words.at[3]);
    return LightNode(uintBitsToFloat(uvec3(w0, w1.x)), uintBitsToFloat(w1.y), w2.x, w2.y, uintBitsToFloat(w3.x), w3.y);
}

// A bound on cos(max(0, a - b)) from the cosine of a and the sine of b <= pi/2, without another root: where cos a >= 0, cos(b) <= 1
// and sin(a) <= 1; elsewhere also cos(b) >= 1 - sin^2(b).
float cosine_less(float cos_a, float sin_b) {
    return at_most((cos_a < 0.0 ? cos_a * (1.0 - sin_b * sin_b) : cos_a) + sin_b, 1.0);
}

// 1 / sqrt(x) for the squared length x of a point of the octahedron |x| + |y| + |z| = 1, from 1/3 to 1, to 4e-5: two steps of Newton's method take a
// fraction of a root and a division.
float octahedron_inverse_length(float x) {
    float y = 1.98 - 1.03 * x;
    y *= 1.5 - 0.5 * x * y * y;
    return y * (1.5 - 0.5 * x * y * y);
}

// Bound on the irradiance of the lights of a node at the reference point, but for a factor that all nodes share
// (Conty Estevez and Kulla 2018, equation 3, with cosine_less in place of exact angles); `p` is the reference point in the tree's coordinates.
float light_importance(LightNode node, ReferencePoint r, vec3 p) {
    vec3 d = node.centre - p;
    float distance2 = at_least(at_least(dot(d, d), node.radius * node.radius), 1e-30);
    float inverse = inversesqrt(distance2);
    float seen = at_most(node.radius * inverse, 1.0); // sine of half the angle under which the lights are seen

    // The axis lies on an octahedron.
    int bits = int(node.axis);
    vec2 folded = vec2(bits << 20 >> 20, bits << 8 >> 20) * (1.0 / 2047.0);
    float spread = float(bits >> 24) * (1.0 / 127.0);
    float z = 1.0 - abs(folded.x) - abs(folded.y);
    float fold = at_least(-z, 0.0);
    vec3 axis = vec3(folded.x + (folded.x < 0.0 ? fold : -fold), folded.y + (folded.y < 0.0 ? fold : -fold), z);
    float off_axis = -dot(axis, d) * inverse * octahedron_inverse_length(dot(axis, axis));
    int cone = int(node.facing); // cosine and sine of the cone's half angle
    vec2 facing = vec2(cone << 16 >> 16, cone >> 16) * (1.0 / 32767.0);
    float off_cone = off_axis >= facing.x ? 1.0 : off_axis * facing.x + sqrt(at_least(1.0 - off_axis * off_axis, 0.0)) * facing.y;
    float shed = cosine_less(off_cone, seen);

    float cosine = dot(r.normal, d) * inverse;
    float received = r.normal == vec3(0.0) ? 1.0 : cosine_less(r.both ? abs(cosine) : cosine, seen);
    bool dark = shed < spread - DARK || received < -DARK;
    return dark ? 0.0 : node.intensity * inverse * inverse * at_least(shed, DARK) * at_least(received, LEAST_COSINE);
}

vec3 light_tree_position(ReferencePoint r) { return (r.position - scene.light_tree_origin) * scene.light_tree_scale; }

// Share of the importance that the second of two nodes has; negative where neither has any.
float second_share(LightNode a, LightNode b, ReferencePoint r, vec3 p) {
    float first = light_importance(a, r, p);
    float second = light_importance(b, r, p);
    return first + second > 0.0 ? second / (first + second) : -1.0;
}

// A light of the tree by u, and its probability; 0 where no light can shed anything on the reference point.
uint light_tree_sample(ReferencePoint r, vec2 u, out float probability) {
    vec3 p = light_tree_position(r);
    probability = 1.0;
    uint link = load_light_node(0u).link;
    while ((link & LIGHT_LEAF_BIT) == 0u && probability > 0.0) {
        LightNode a = load_light_node(link), b = load_light_node(link + 1u);
        float share = second_share(a, b, r, p);
        bool second = u.x < share;
        // What is left of the number is uniform again. Both numbers take turns, for each has only 24 bits to give.
        float chance = share < 0.0 ? 0.0 : (second ? share : 1.0 - share);
        float rest = (second ? u.x : u.x - at_least(share, 0.0)) / at_least(chance, 1e-30);
        u = vec2(u.y, at_most(rest, 0.99999994));
        probability *= chance;
        link = second ? b.link : a.link;
    }
    return link & ~LIGHT_LEAF_BIT;
}

// The probability of choosing the light at the end of a trail.
float light_tree_probability(ReferencePoint r, uint trail) {
    vec3 p = light_tree_position(r);
    float probability = 1.0;
    uint link = load_light_node(0u).link;
    while ((link & LIGHT_LEAF_BIT) == 0u && probability > 0.0) {
        LightNode a = load_light_node(link), b = load_light_node(link + 1u);
        float share = second_share(a, b, r, p);
        bool second = (trail & 1u) != 0u;
        trail >>= 1u;
        probability *= share < 0.0 ? 0.0 : (second ? share : 1.0 - share);
        link = second ? b.link : a.link;
    }
    return probability;
}
