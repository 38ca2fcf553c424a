// Shading frames that follow the texture coordinates: for anisotropic materials, and tilted by normal and bump maps.

// A frame around the normal whose tangent follows `along` as far as it can.
Frame frame_along(vec3 normal, vec3 along) {
    vec3 t = along - normal * dot(normal, along);
    float length2 = dot(t, t);
    if (!(length2 > 0.0)) return frame_from_normal(normal);
    t *= inversesqrt(length2);
    return Frame(t, cross(normal, t), normal);
}

Frame shading_frame(Interaction at, Material m, inout bool mapped) {
    Frame frame = frame_along(at.shading_normal, at.dp_du);
    if (!HAS_MATERIAL_TEXTURES || m.textures == NONE) return frame;
    MaterialTextures t = TextureSets(scene.material_textures).at[m.textures];
    vec3 normal = frame.normal;
    if (HAS_NORMAL_MAPS && t.normal != NONE) {
        vec3 n = 2.0 * texture_at(t.normal, at.uv).xyz - 1.0;
        n.xy *= t.normal_scale;
        Frame base = frame;
        if (at.tangent.w != 0.0) {
            base = frame_along(at.shading_normal, at.tangent.xyz);
            base.bitangent *= at.tangent.w < 0.0 ? -1.0 : 1.0;
        }
        normal = normalize(to_world(base, n));
    }
    if (HAS_BUMP_MAPS && t.bump != NONE) {
        // The surface displaced along its normal (Blinn 1978), without the term of the normal's own change.
        vec2 slope = texture_gradient(t.bump, at.uv) * t.bump_scale;
        vec3 du = at.dp_du + frame.normal * (slope.x - dot(frame.normal, at.dp_du));
        vec3 dv = at.dp_dv + frame.normal * (slope.y - dot(frame.normal, at.dp_dv));
        vec3 n = cross(du, dv);
        float length2 = dot(n, n);
        if (length2 > 0.0) normal = n * (inversesqrt(length2) * (dot(n, frame.normal) < 0.0 ? -1.0 : 1.0));
    }
    mapped = t.normal != NONE || t.bump != NONE;
    return mapped ? frame_along(normal, at.dp_du) : frame;
}
