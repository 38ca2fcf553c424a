// Textures: texels through device addresses, so that none is bound where a scene has none, and filtered here, so that every
// device gives the same values (samplers may round their weights to 4 bits).

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Bytes4 { uint at[]; };

// The texel's index in one direction, brought into 0 .. size - 1.
int wrap_texel(int i, int size, uint wrap) {
    if (wrap == WRAP_CLAMP) return clamp(i, 0, size - 1);
    int period = wrap == WRAP_MIRROR ? 2 * size : size;
    i -= period * int(floor(float(i) / float(period)));
    i = i < 0 ? i + period : (i >= period ? i - period : i); // the division may round across a multiple
    return clamp(i < size ? i : period - 1 - i, 0, size - 1); // where floats are too coarse to divide, any texel will do
}

vec4 load_texel(Texture t, ivec2 i) {
    i = ivec2(wrap_texel(i.x, int(t.width), t.sampling & 0xffu), wrap_texel(i.y, int(t.height), t.sampling >> 8u & 0xffu));
    uint index = uint(i.y) * t.width + uint(i.x);
    if (t.format == TEXELS_FLOAT) return Vectors4(t.texels).at[index];
    uint bytes = Bytes4(t.texels).at[index];
    uvec4 b = uvec4(bytes, bytes >> 8u, bytes >> 16u, bytes >> 24u) & 0xffu;
    vec4 linear = vec4(b) * (1.0 / 255.0);
    if (t.format == TEXELS_LINEAR8) return linear;
    Floats decode = Floats(scene.tables);
    return vec4(decode.at[b.x], decode.at[b.y], decode.at[b.z], linear.w);
}

// Where `uv` of a surface lies in the texture.
vec2 texture_position(Texture t, vec2 uv) { return vec2(dot(t.row_u, vec3(uv, 1.0)), dot(t.row_v, vec3(uv, 1.0))); }

// The four texels around a position and its fractions between them; texel centres are at half-integers.
struct Footprint {
    vec4 t00, t10, t01, t11;
    vec2 f;
};

Footprint texture_footprint(Texture t, vec2 position) {
    vec2 p = position * vec2(t.width, t.height) - 0.5;
    vec2 corner = floor(p);
    ivec2 i = ivec2(corner);
    return Footprint(load_texel(t, i), load_texel(t, i + ivec2(1, 0)), load_texel(t, i + ivec2(0, 1)), load_texel(t, i + 1), p - corner);
}

vec4 bilinear_value(Texture t, vec2 position) {
    Footprint f = texture_footprint(t, position);
    return mix(mix(f.t00, f.t10, f.f.x), mix(f.t01, f.t11, f.f.x), f.f.y);
}

vec4 texture_value(Texture t, vec2 uv) {
    vec2 position = texture_position(t, uv);
    if (t.kind == TEXTURE_CHECKERBOARD) {
        bvec2 half_way = greaterThan(fract(position), vec2(0.5));
        return half_way.x == half_way.y ? t.scale : t.offset;
    }
    vec4 value;
    if ((t.sampling & FILTER_NEAREST_BIT) != 0u) {
        value = load_texel(t, ivec2(floor(position * vec2(t.width, t.height))));
    } else {
        value = bilinear_value(t, position);
    }
    return value * t.scale + t.offset;
}

Texture load_texture(uint index) { return Textures(scene.textures).at[index]; }

// The channel that a scalar texture means.
float texture_channel(Texture t, vec4 value) {
    return t.channel < 4u ? value[t.channel] : dot(value.rgb, vec3(0.2126, 0.7152, 0.0722));
}

// Four values, or one, at texture coordinates of the surface; what is not textured is 1.
vec4 texture_at(uint index, vec2 uv) { return index == NONE ? vec4(1.0) : texture_value(load_texture(index), uv); }

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
// and next smaller than it; 0 is the point itself.
vec4 texture_mean(Texture t, vec2 uv, float side) {
    if (t.levels < 2u || side == 0.0) return texture_value(t, uv);
    float texels = side * sqrt(abs(t.row_u.x * t.row_v.y - t.row_u.y * t.row_v.x) * float(t.width) * float(t.height));
    float level = clamp(log2(texels), 0.0, float(t.levels - 1u));
    vec2 position = texture_position(t, uv);
    uint finer = uint(level);
    vec4 value = bilinear_value(texture_level(t, finer), position);
    if (level > float(finer)) value = mix(value, bilinear_value(texture_level(t, finer + 1u), position), level - float(finer));
    return value * t.scale + t.offset;
}

vec4 texture_at(uint index, vec2 uv, float side) {
    if (!HAS_MIP_MAPS || index == NONE) return texture_at(index, uv);
    return texture_mean(load_texture(index), uv, side);
}

float texture_scalar(uint index, vec2 uv) {
    if (index == NONE) return 1.0;
    Texture t = load_texture(index);
    return texture_channel(t, texture_value(t, uv));
}

float texture_scalar(uint index, vec2 uv, float side) {
    if (!HAS_MIP_MAPS || index == NONE) return texture_scalar(index, uv);
    Texture t = load_texture(index);
    return texture_channel(t, texture_mean(t, uv, side));
}

// Change of a scalar texture per unit of the surface's texture coordinates; that of bilinear interpolation, which is
// piecewise smooth. A checkerboard has none.
vec2 texture_gradient(uint index, vec2 uv) {
    Texture t = load_texture(index);
    if (t.kind == TEXTURE_CHECKERBOARD) return vec2(0.0);
    Footprint f = texture_footprint(t, texture_position(t, uv));
    float a = texture_channel(t, f.t00 * t.scale), b = texture_channel(t, f.t10 * t.scale);
    float c = texture_channel(t, f.t01 * t.scale), d = texture_channel(t, f.t11 * t.scale);
    vec2 g = vec2(mix(b - a, d - c, f.f.y), mix(c - a, d - b, f.f.x)) * vec2(t.width, t.height);
    return g.x * t.row_u.xy + g.y * t.row_v.xy;
}
