// Backend `bvh`: an eight-wide compressed BVH (Ylitie, Karras and Laine 2017) read through device addresses, two levels
// where the scene has instances. Runs on every Vulkan 1.3 device.
#include "trace/stack.glsl"
#include "trace/triangle.glsl"
#include "trace/sphere.glsl"
#include "trace/inline.glsl"

// How far this backend's own intersection may be off for a triangle of this extent, beyond what triangle_margin says.
float backend_margin(float extent) { return 0.0; }

// What was tested so far, for the one kernel that counts (shaders/kernels/rays/count.glsl); the others are compiled without.
#ifdef COUNT_TRAVERSAL
uint tested_nodes, tested_primitives;
#define COUNT(counter, count) counter += count
#else
#define COUNT(counter, count)
#endif

// One node, 80 bytes: the box's corner, its three exponents and the inner-node mask, the bases of children and
// primitives, then eight bytes each of: meta data, lower and upper x, y and z of the children.
struct Node {
    vec3 corner;
    uint exponents;
    uint child_base;
    uint primitive_base;
    uvec2 meta;
    uvec2 lower_x, upper_x, lower_y, upper_y, lower_z, upper_z;
};

Node load_node(uint index) {
    if (WIDE_LOADS) {
        Words64 words = words_from(scene.nodes, 10u * index);
        uvec2 w0 = unpack32(words.at[0]), w1 = unpack32(words.at[1]), w2 = unpack32(words.at[2]);
        return Node(uintBitsToFloat(uvec3(w0, w1.x)), w1.y, w2.x, w2.y, unpack32(words.at[3]), unpack32(words.at[4]), unpack32(words.at[5]),
                    unpack32(words.at[6]), unpack32(words.at[7]), unpack32(words.at[8]), unpack32(words.at[9]));
    }
    Quads quads = Quads(scene.nodes);
    uint at = 5u * index;
    uvec4 q0 = quads.at[at], q1 = quads.at[at + 1u], q2 = quads.at[at + 2u], q3 = quads.at[at + 3u], q4 = quads.at[at + 4u];
    return Node(uintBitsToFloat(q0.xyz), q0.w, q1.x, q1.y, q1.zw, q2.xy, q2.zw, q3.xy, q3.zw, q4.xy, q4.zw);
}

// What traversal needs of a ray, in the space of the tree that it is in.
struct RayState {
    vec3 origin;
    vec3 direction;
    vec3 inverse;   // of the direction, its components kept away from zero
    uint octant;    // which children come first, in each byte
    Shear shear;
};

RayState ray_state(vec3 origin, vec3 direction) {
    const float tiny = 1e-18;
    RayState r;
    r.origin = origin;
    r.direction = direction;
    bvec3 small = lessThan(abs(direction), vec3(tiny));
    vec3 safe = mix(direction, vec3(tiny), small);
    r.inverse = 1.0 / safe;
    r.octant = ((safe.x < 0.0 ? 0u : 4u) | (safe.y < 0.0 ? 0u : 2u) | (safe.z < 0.0 ? 0u : 1u)) * 0x01010101u;
    r.shear = shear_along(direction);
    return r;
}

// Half a grid cell of a child's box covers 255 cells at most; 1/256 of a cell on each side makes up for the rounding of
// the builder's quantisation (validated on the host) and of the slab's products, the rest is relative to the distance.
const float CELL_MARGIN = 1.0 / 256.0;

// Bit i of the top byte: the inner child in traversal order i is hit. The low 24 bits: the primitives of hit leaves.
uint intersect_children(Node node, RayState r, float t_max) {
    vec3 cell = uintBitsToFloat(uvec3(node.exponents << 23u, node.exponents << 15u, node.exponents << 7u) & 0x7f800000u);
    vec3 scale = cell * r.inverse;
    vec3 start = (node.corner - r.origin) * r.inverse;
    vec3 margin = CELL_MARGIN * abs(scale) + gamma(4.0) * abs(start);
    vec3 near = start - margin;
    vec3 far = start + margin;
    uint hits = 0u;
    for (uint side = 0u; side < 2u; side++) {
        uint meta = node.meta[side];
        uint inner = ((meta & (meta << 1u)) & 0x10101010u) >> 4u;
        uint shifts = (meta ^ (r.octant & (inner * 0xffu))) & 0x1f1f1f1fu;
        uint bits = (meta >> 5u) & 0x07070707u;
        uint near_x = r.inverse.x < 0.0 ? node.upper_x[side] : node.lower_x[side];
        uint far_x = r.inverse.x < 0.0 ? node.lower_x[side] : node.upper_x[side];
        uint near_y = r.inverse.y < 0.0 ? node.upper_y[side] : node.lower_y[side];
        uint far_y = r.inverse.y < 0.0 ? node.lower_y[side] : node.upper_y[side];
        uint near_z = r.inverse.z < 0.0 ? node.upper_z[side] : node.lower_z[side];
        uint far_z = r.inverse.z < 0.0 ? node.lower_z[side] : node.upper_z[side];
        for (uint child = 0u; child < 4u; child++) {
            uint shift = 8u * child;
            vec3 enter = fma(vec3(uvec3(near_x, near_y, near_z) >> shift & 0xffu), scale, near);
            vec3 leave = fma(vec3(uvec3(far_x, far_y, far_z) >> shift & 0xffu), scale, far);
            // As integers, floats without a sign bit keep their order and those with it are below all of them.
            ivec3 e = floatBitsToInt(enter);
            ivec3 l = floatBitsToInt(leave);
            int first = max(max(e.x, e.y), max(e.z, 0));
            int last = min(min(l.x, l.y), min(l.z, floatBitsToInt(t_max)));
            hits |= first <= last ? (bits >> shift & 0xffu) << (shifts >> shift & 0xffu) : 0u;
        }
    }
    return hits;
}

// Traversal keeps a group of nodes and a group of primitives: (base index, hit bits). Each turn of the loop takes one of
// either, so that lanes which are at different work go on together.
bool traverse(Ray ray, const bool any, inout Nearest nearest, out uint nearest_instance) {
    Stack stack;
    stack.depth = 0u;
    uint blas_floor = 0u; // the stack's depth at which the current instance was entered
    bool in_instance = !HAS_INSTANCES;
    uint instance = 0u;
    nearest_instance = 0u;
    bool crossed = HAS_INSTANCES; // into the space of an instance, or out of it
    RayState r;
    if (!HAS_INSTANCES) r = ray_state(ray.origin, ray.direction);
    uvec2 nodes = uvec2(0u, 0x80000000u);
    uvec2 primitives = uvec2(0u);
    bool found = false;
    bool busy = true;
    while (busy) {
        if (HAS_INSTANCES && crossed) {
            crossed = false;
            vec3 origin = ray.origin, direction = ray.direction;
            if (in_instance) {
                Instance placed = load_instance(instance);
                origin = object_point(placed, ray.origin);
                direction = object_vector(placed, ray.direction);
            }
            r = ray_state(origin, direction);
        }
        if (primitives.y == 0u && nodes.y > 0x00ffffffu) {
            uint bit = uint(findMSB(nodes.y));
            uint slot = (bit - 24u) ^ (r.octant & 0xffu);
            uint child = nodes.x + uint(bitCount(nodes.y & ~(0xffffffffu << slot)));
            nodes.y &= ~(1u << bit);
            if (nodes.y > 0x00ffffffu) push(stack, nodes);
            Node node = load_node(child);
            COUNT(tested_nodes, 1u);
            uint hits = intersect_children(node, r, nearest.t);
            nodes = uvec2(node.child_base, (hits & 0xff000000u) | (node.exponents >> 24u));
            primitives = uvec2(node.primitive_base, hits & 0x00ffffffu);
        }
        if (primitives.y != 0u) {
            uint bit = uint(findMSB(primitives.y));
            primitives.y &= ~(1u << bit);
            uint index = primitives.x + bit;
            if (HAS_INSTANCES && !in_instance) {
                if (primitives.y != 0u) push(stack, primitives);
                if (nodes.y > 0x00ffffffu) push(stack, nodes);
                blas_floor = stack.depth;
                in_instance = true;
                crossed = true;
                instance = index;
                nodes = uvec2(load_instance(index).root, 0x80000000u);
                primitives = uvec2(0u);
            } else {
                Primitive primitive = load_primitive(index);
                COUNT(tested_primitives, 1u);
                float t;
                vec3 edges = vec3(0.0);
                bool hit;
                if (is_sphere(primitive)) {
                    hit = sphere_hit(r.origin, r.direction, primitive.v0, primitive.v1.x, t);
                } else if (HAS_PAIRS) {
                    // A triangle without another is a pair with itself, whose second is never taken.
                    bool paired = (primitive.surface & PAIR_BIT) != 0u;
                    vec3 other = load_first_vertex(index - (paired ? 1u : 0u));
                    bool first, second;
                    hit = pair_hit(r.shear, r.origin, r.direction, primitive.v0, primitive.v1, primitive.v2, other, t, edges, first, second);
                    // Where the line passes through both, the other one is left for the next turn.
                    if (paired && !(first && second)) primitives.y &= ~(1u << (bit - 1u));
                    index -= paired && !first ? 1u : 0u;
                } else {
                    hit = triangle_hit(r.shear, r.origin, r.direction, primitive.v0, primitive.v1, primitive.v2, t, edges);
                }
                // Of two at the same distance the smaller index wins, so that the order of the tests changes nothing.
                bool closer = hit && t > 0.0 && (t < nearest.t || t == nearest.t && index < nearest.primitive);
                nearest.t = closer ? t : nearest.t;
                nearest.edges = closer ? edges : nearest.edges;
                nearest.primitive = closer ? index : nearest.primitive;
                nearest_instance = closer ? instance : nearest_instance;
                found = found || closer;
            }
        }
        if (any && found) busy = false;
        if (primitives.y == 0u && nodes.y <= 0x00ffffffu && busy) {
            if (HAS_INSTANCES && in_instance && stack.depth == blas_floor) {
                in_instance = false;
                crossed = true;
                blas_floor = 0u;
            }
            busy = stack.depth > 0u;
            if (busy) {
                uvec2 group = pop(stack);
                bool is_nodes = group.y > 0x00ffffffu;
                nodes = is_nodes ? group : uvec2(0u);
                primitives = is_nodes ? uvec2(0u) : group;
            }
        }
    }
    return found;
}

// The nearest hit in (0, t_max); with `any`, whether there is one, and what it is says nothing.
bool trace(Ray ray, const bool any, out Hit hit) {
    Nearest nearest = Nearest(ray.t_max, NONE, vec3(0.0));
    uint instance = 0u;
    COUNT(tested_primitives, INLINE_COUNT);
    bool found;
    if (INLINE_COUNT > 0u) {
        if (any) found = inline_any(ray);
        else found = inline_closest(ray, nearest);
    } else {
        found = traverse(ray, any, nearest, instance);
    }
    hit = Hit(nearest.t, nearest.primitive, instance, barycentric(nearest.edges));
    return found;
}
