// What every shader begins with: the extensions, the shared layout, the scene and its arrays, and a few constants.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

#include "generated/layout.glsl"

const float PI = 3.14159265358979;
const float INV_PI = 0.318309886183791;
const float INFINITY = 3.0e38; // finite on purpose: it takes part in arithmetic

// Half the distance from 1 to the next float; gamma(n) bounds the relative error of n roundings (Higham 2002, lemma 3.1).
const float MACHINE_EPSILON = 5.9604645e-8;
float gamma(float n) { return n * MACHINE_EPSILON / (1.0 - n * MACHINE_EPSILON); }

layout(set = 0, binding = BINDING_SCENE, scalar) uniform SceneBlock {
    SceneUniforms scene;
    Surface uniform_surfaces[UNIFORM_SURFACES];
    Material uniform_materials[UNIFORM_MATERIALS];
    Light uniform_lights[UNIFORM_LIGHTS];
};
layout(push_constant, scalar) uniform FrameBlock { FrameConstants frame; };

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Words64 { uint64_t at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Pairs { uvec2 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Quads { uvec4 at[]; };

// An array of words from one of them on: what is read of it then lies at constant distances from one address.
Words64 words_from(uvec2 base, uint first) { return Words64(packUint2x32(base) + (uint64_t(first) << 3)); }

// Distances begin at 0: whoever starts a ray on a surface moves its origin off that surface.
struct Ray {
    vec3 origin;
    vec3 direction; // unit length in world space
    float t_max;
};

struct Hit {
    float t;        // distance in units of the ray's direction
    uint primitive; // index into scene.primitives
    uint instance;  // index into scene.instances; 0 where there are none
    vec2 uv;        // barycentric weights of the second and third vertex
};

// The second word of a 64-bit load costs nothing where a gather of 32 bits costs as much as one of 64 (CPU devices).
Primitive load_primitive(uint index) {
    uvec2 w0, w1, w2, w3, w4;
    if (WIDE_LOADS) {
        Words64 words = words_from(scene.primitives, 5u * index);
        w0 = unpack32(words.at[0]);
        w1 = unpack32(words.at[1]);
        w2 = unpack32(words.at[2]);
        w3 = unpack32(words.at[3]);
        w4 = unpack32(words.at[4]);
    } else {
        Pairs pairs = Pairs(scene.primitives);
        w0 = pairs.at[5u * index];
        w1 = pairs.at[5u * index + 1u];
        w2 = pairs.at[5u * index + 2u];
        w3 = pairs.at[5u * index + 3u];
        w4 = pairs.at[5u * index + 4u];
    }
    return Primitive(uintBitsToFloat(uvec3(w0, w1.x)), uintBitsToFloat(uvec3(w1.y, w2)), uintBitsToFloat(uvec3(w3, w4.x)), w4.y);
}

// Its first vertex alone.
vec3 load_first_vertex(uint index) {
    if (WIDE_LOADS) {
        Words64 words = words_from(scene.primitives, 5u * index);
        return uintBitsToFloat(uvec3(unpack32(words.at[0]), unpack32(words.at[1]).x));
    }
    Pairs pairs = Pairs(scene.primitives);
    return uintBitsToFloat(uvec3(pairs.at[5u * index], pairs.at[5u * index + 1u].x));
}

// Entry `index` of a table. A short table lies in the uniform block and is picked from by comparison: a row of selects
// costs a SIMD device a fraction of what gathering each word from memory does.
#define TABLE_ENTRY(kind, count, room, here, there) \
    if (count > room) return there;                 \
    kind entry = here[0];                           \
    [[unroll]] for (uint i = 1u; i < min(count, room); i++) { if (index == i) entry = here[i]; } \
    return entry;

Surface load_surface(uint index) { TABLE_ENTRY(Surface, SURFACE_COUNT, UNIFORM_SURFACES, uniform_surfaces, Surfaces(scene.surfaces).at[index]) }
Material load_material(uint index) { TABLE_ENTRY(Material, MATERIAL_COUNT, UNIFORM_MATERIALS, uniform_materials, Materials(scene.materials).at[index]) }
Light load_light(uint index) { TABLE_ENTRY(Light, LIGHT_COUNT, UNIFORM_LIGHTS, uniform_lights, Lights(scene.lights).at[index]) }
Instance load_instance(uint index) { return Instances(scene.instances).at[index]; }

// Entries of the light table: compiled in, or, in a kernel that models everything, read.
uint light_count() { return LIGHT_COUNT == NONE ? scene.light_count : LIGHT_COUNT; }

// The larger, and the smaller, of a number and one that is not negative. As integers, floats without a sign bit keep their order and those with it are
// below all of them: a float's own min and max must mind NaN.
float at_least(float x, float least) { return intBitsToFloat(max(floatBitsToInt(x), floatBitsToInt(least))); }
float at_most(float x, float most) { return intBitsToFloat(min(floatBitsToInt(x), floatBitsToInt(most))); }

bool is_sphere(Primitive primitive) { return HAS_SPHERES && (primitive.surface & SPHERE_BIT) != 0u; }

// So many turns of a loop whose body is to stand in the kernel once: a number that the compiler of a CPU device cannot see, so that it does
// not write the body down as often.
uint turns(uint count) { return UNROLL ? count : count + (scene.width == 0u ? 1u : 0u); }

#include "trace/instance.glsl"
