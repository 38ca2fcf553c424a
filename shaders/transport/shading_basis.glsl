// Shading frames that follow the texture coordinates: for anisotropic materials, and tilted by normal and bump maps.

// A basis around the normal whose tangent follows `along` as far as it can.
Basis basis_along(vec3 normal, vec3 along) {
    vec3 t = along - normal * dot(normal, along);
    float length2 = dot(t, t);
    if (!(length2 > 0.0)) return basis_from_normal(normal);
    t *= inversesqrt(length2);
    return Basis(t, cross(normal, t), normal);
}

Basis shading_basis(Interaction at, Material m, inout bool mapped) {
    Basis basis = basis_along(at.shading_normal, at.dp_du);
    if (!HAS_MATERIAL_TEXTURES || m.textures == NONE) return basis;
    MaterialTextures t = TextureSets(scene.material_textures).at[m.textures];
    vec3 normal = basis.normal;
    if (HAS_NORMAL_MAPS && t.normal != NONE) {
        vec3 n = 2.0 * texture_at(t.normal, place_of(at)).xyz - 1.0;
        n.xy *= t.normal_scale;
        Basis base = basis;
        if (at.tangent.w != 0.0) {
            base = basis_along(at.shading_normal, at.tangent.xyz);
            base.bitangent *= at.tangent.w < 0.0 ? -1.0 : 1.0;
        }
        normal = normalize(to_world(base, n));
    }
    if (HAS_BUMP_MAPS && t.bump != NONE) {
        // The surface displaced along its normal (Blinn 1978), without the term of the normal's own change.
        vec2 slope = texture_gradient(t.bump, at.uv) * t.bump_scale;
        vec3 du = at.dp_du + basis.normal * (slope.x - dot(basis.normal, at.dp_du));
        vec3 dv = at.dp_dv + basis.normal * (slope.y - dot(basis.normal, at.dp_dv));
        vec3 n = cross(du, dv);
        float length2 = dot(n, n);
        if (length2 > 0.0) normal = n * (inversesqrt(length2) * (dot(n, basis.normal) < 0.0 ? -1.0 : 1.0));
    }
    mapped = t.normal != NONE || t.bump != NONE;
    return mapped ? basis_along(normal, at.dp_du) : basis;
}
