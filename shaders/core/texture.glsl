// Textures: texels through device addresses, so that none is bound where a scene has none, and filtered here, so that every
// device gives the same values (samplers may round their weights to 4 bits).
#include "core/whole.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Bytes4 { uint at[]; };

// What the scene's textures do not all do without.
const bool HAS_REPEATING = (WRAPS & ~(1u << WRAP_CLAMP)) != 0u;
const bool HAS_CLAMPED = (WRAPS & 1u << WRAP_CLAMP) != 0u;
const bool HAS_MIRRORED = (WRAPS & 1u << WRAP_MIRROR) != 0u;
const bool HAS_FLOAT_TEXELS = (TEXEL_FORMATS & 1u << TEXELS_FLOAT) != 0u;
const bool HAS_LINEAR_TEXELS = (TEXEL_FORMATS & 1u << TEXELS_LINEAR8) != 0u;
const bool HAS_SRGB_TEXELS = (TEXEL_FORMATS & 1u << TEXELS_SRGB8) != 0u;

// Texels in one direction before they repeat.
int wrap_period(int size, uint wrap) { return HAS_MIRRORED && wrap == WRAP_MIRROR ? 2 * size : size; }

bool wrap_clamps(uint wrap) { return !HAS_REPEATING || HAS_CLAMPED && wrap == WRAP_CLAMP; }

// A texel's index in one direction, brought near the image: what wrap_texel takes. Where floats are too coarse to divide, any texel will do.
int wrap_corner(float i, int size, uint wrap) {
    if (wrap_clamps(wrap)) return whole_signed(clamp(i, -1.0, float(size)));
    float period = float(wrap_period(size, wrap));
    i -= period * floor(i / period);
    return int(whole(i < 0.0 ? i + period : (i >= period ? i - period : i))); // the division may round across a multiple
}

// Such an index, or the one after it, brought into 0 .. size - 1.
int wrap_texel(int i, int size, uint wrap) {
    if (wrap_clamps(wrap)) return clamp(i, 0, size - 1);
    int period = wrap_period(size, wrap);
    if (i >= period) i -= period;
    return clamp(i < size ? i : period - 1 - i, 0, size - 1);
}

uint wrap_u(Texture t) { return t.sampling & 0xffu; }
uint wrap_v(Texture t) { return t.sampling >> 8u & 0xffu; }

// The texel at an index as wrap_texel takes it.
vec4 load_texel(Texture t, ivec2 i) {
    i = ivec2(wrap_texel(i.x, int(t.width), wrap_u(t)), wrap_texel(i.y, int(t.height), wrap_v(t)));
    uint index = uint(i.y) * t.width + uint(i.x);
    if (!(HAS_LINEAR_TEXELS || HAS_SRGB_TEXELS) || HAS_FLOAT_TEXELS && t.format == TEXELS_FLOAT) return Vectors4(t.texels).at[index];
    uint bytes = Bytes4(t.texels).at[index];
    uvec4 b = uvec4(bytes, bytes >> 8u, bytes >> 16u, bytes >> 24u) & 0xffu;
    vec4 linear = vec4(b) * (1.0 / 255.0);
    if (!HAS_SRGB_TEXELS || HAS_LINEAR_TEXELS && t.format == TEXELS_LINEAR8) return linear;
    Floats decode = Floats(scene.tables);
    return vec4(decode.at[b.x], decode.at[b.y], decode.at[b.z], linear.w);
}

// Where on a surface a texture is looked up: its texture coordinates, and the vertices with their weights between which attributes of a mesh are
// interpolated.
struct TexturePlace {
    vec2 uv;
    uvec3 corners; // NONE where the mesh has no attributes
    vec3 weights;
};

TexturePlace place_at(vec2 uv) { return TexturePlace(uv, uvec3(NONE), vec3(0.0)); }

// The texture coordinates that it is looked up by: the first set, or the second.
vec2 place_uv(Texture t, TexturePlace place) {
    if (!HAS_SECOND_UVS || (t.sampling & SECOND_UVS_BIT) == 0u) return place.uv;
    if (place.corners.x == NONE) return vec2(0.0);
    Vectors2 uvs = Vectors2(scene.second_uvs);
    return place.weights.x * uvs.at[place.corners.x] + place.weights.y * uvs.at[place.corners.y] + place.weights.z * uvs.at[place.corners.z];
}

// Where `uv` of a surface lies in the texture.
vec2 texture_position(Texture t, vec2 uv) { return vec2(dot(t.row_u, vec3(uv, 1.0)), dot(t.row_v, vec3(uv, 1.0))); }

// Where a filter looks: its first texel, how far the position lies from that texel's centre towards the next ones (0 .. 1), and how
// many texels it weighs: one, or the four around the position. Texel centres are at half-integers.
struct Footprint {
    ivec2 corner;
    vec2 f;
    uint texels;
};

Footprint texture_footprint(Texture t, vec2 position, bool nearest) {
    vec2 p = position * vec2(t.width, t.height) - (nearest ? 0.0 : 0.5);
    vec2 corner = floor(p);
    ivec2 first = ivec2(wrap_corner(corner.x, int(t.width), wrap_u(t)), wrap_corner(corner.y, int(t.height), wrap_v(t)));
    return Footprint(first, nearest ? vec2(0.0) : p - corner, nearest ? 1u : 4u);
}

// How many turns a loop over a footprint takes. GPUs take a number that their compiler knows and may unroll, so that the reads wait
// together (a texel too many has weight 0); for a CPU driver it depends on data, as each copy of the loop's body is long to compile.
uint texel_turns(Footprint f) { return UNROLL ? 4u : f.texels; }

ivec2 texel_of_turn(uint turn) { return ivec2(turn & 1u, turn >> 1u); }

// The weights of a texel in both directions; their product is that of the bilinear filter.
vec2 texel_weights(Footprint f, ivec2 texel) { return mix(1.0 - f.f, f.f, equal(texel, ivec2(1))); }

vec4 filtered_value(Texture t, vec2 position) {
    Footprint f = texture_footprint(t, position, (t.sampling & FILTER_NEAREST_BIT) != 0u);
    vec4 value = vec4(0.0);
    for (uint turn = 0u; turn < texel_turns(f); turn++) {
        ivec2 texel = texel_of_turn(turn);
        vec2 weights = texel_weights(f, texel);
        value += weights.x * weights.y * load_texel(t, f.corner + texel);
    }
    return value;
}

// A level of detail as a texture of its own.
Texture texture_level(Texture t, uint level) {
    uint first = 0u;
    for (uint i = 0u; i < level; i++) {
        first += t.width * t.height;
        t.width = max(t.width / 2u, 1u);
        t.height = max(t.height / 2u, 1u);
    }
    t.texels = unpack32(pack64(t.texels) + uint64_t(first) * (t.format == TEXELS_FLOAT ? 16u : 4u));
    return t;
}

// The mean over about a square of this side in the surface's texture coordinates, from the levels whose texels are next larger
// and next smaller than it.
vec4 levels_value(Texture t, vec2 position, float side) {
    float texels = side * sqrt(abs(t.row_u.x * t.row_v.y - t.row_u.y * t.row_v.x) * float(t.width) * float(t.height));
    float level = side == 0.0 ? 0.0 : clamp(log2(texels), 0.0, float(t.levels - 1u));
    uint finer = min(whole(level), t.levels - 1u);
    float coarser_share = level - float(finer);
    vec4 value = vec4(0.0);
    for (uint i = finer; i <= finer + (coarser_share > 0.0 ? 1u : 0u); i++) {
        value += (i == finer ? 1.0 - coarser_share : coarser_share) * filtered_value(texture_level(t, i), position);
    }
    return value;
}

Texture load_texture(uint index) { return Textures(scene.textures).at[index]; }

bool is_checkerboard(Texture t) { return HAS_CHECKERBOARDS && t.kind == TEXTURE_CHECKERBOARD; }

// Whether a checkerboard shows its first square there.
bool shows_first(Texture t, vec2 uv) {
    bvec2 half_way = greaterThan(fract(texture_position(t, uv)), vec2(0.5));
    return half_way.x == half_way.y;
}

// The texture that is seen there: of a checkerboard whose square shows another texture, that one.
Texture texture_seen(Texture t, vec2 uv) {
    while (HAS_NESTED_TEXTURES && is_checkerboard(t)) {
        uint inner = shows_first(t, uv) ? t.texels.x : t.texels.y;
        if (inner == NONE) break;
        t = load_texture(inner);
    }
    return t;
}

vec4 attribute_value(Texture t, TexturePlace place) {
    if (place.corners.x == NONE) return vec4(0.0);
    Vectors4 values = Vectors4(scene.attributes);
    uvec3 i = t.texels.x + place.corners;
    return place.weights.x * values.at[i.x] + place.weights.y * values.at[i.y] + place.weights.z * values.at[i.z];
}

// The value of a texture that is seen where a path is `side` wide in the surface's texture coordinates; 0 is the point itself.
vec4 texture_value(Texture t, TexturePlace place, float side) {
    if (is_checkerboard(t)) return shows_first(t, place.uv) ? t.scale : t.offset;
    vec4 value = vec4(0.0);
    vec2 position = texture_position(t, place_uv(t, place));
    if (HAS_ATTRIBUTES && t.kind == TEXTURE_ATTRIBUTE) value = attribute_value(t, place);
    else value = HAS_MIP_MAPS ? levels_value(t, position, side) : filtered_value(t, position);
    return value * t.scale + t.offset;
}

// The channel that a scalar texture means.
float texture_channel(Texture t, vec4 value) {
    return t.channel < 4u ? value[t.channel] : dot(value.rgb, LUMINANCE);
}

// Four values, or one, at texture coordinates of the surface; what is not textured is 1.
vec4 texture_at(uint index, TexturePlace place) {
    return index == NONE ? vec4(1.0) : texture_value(texture_seen(load_texture(index), place.uv), place, 0.0);
}

float texture_scalar(uint index, TexturePlace place) {
    if (index == NONE) return 1.0;
    Texture t = texture_seen(load_texture(index), place.uv);
    return texture_channel(t, texture_value(t, place, 0.0));
}

// Change of a scalar texture per unit of the surface's texture coordinates; that of bilinear interpolation, which is
// piecewise smooth. A checkerboard has none, and neither has a single texel, or an attribute, which knows no texture coordinates.
vec2 texture_gradient(uint index, vec2 uv) {
    Texture t = texture_seen(load_texture(index), uv);
    if (is_checkerboard(t) || HAS_ATTRIBUTES && t.kind == TEXTURE_ATTRIBUTE) return vec2(0.0);
    Footprint f = texture_footprint(t, texture_position(t, uv), false);
    if (t.width * t.height == 1u) f.texels = 0u;
    vec2 g = vec2(0.0);
    for (uint turn = 0u; turn < texel_turns(f); turn++) {
        ivec2 texel = texel_of_turn(turn);
        float value = texture_channel(t, load_texel(t, f.corner + texel) * t.scale);
        g += value * vec2(2 * texel - 1) * texel_weights(f, texel).yx;
    }
    g *= vec2(t.width, t.height);
    return g.x * t.row_u.xy + g.y * t.row_v.xy;
}
