// Shading frames that follow the texture coordinates: for anisotropic materials, and tilted by normal and bump maps.

// A basis around the normal whose tangent follows `along` as far as it can.
Basis basis_along(vec3 normal, vec3 along) {
    vec3 t = along - normal * dot(normal, along);
    float length2 = dot(t, t);
    if (!(length2 > 0.0)) return basis_from_normal(normal);
    t *= inversesqrt(length2);
    return Basis(t, cross(normal, t), normal);
}

// A normal that a map gives in a basis, whose bitangent is that of the mesh.
vec3 mapped_normal(uint map, float scale, Basis base, Interaction at) {
    vec3 n = 2.0 * texture_at(map, place_of(at)).xyz - 1.0;
    n.xy *= scale;
    base.bitangent *= at.tangent.w < 0.0 ? -1.0 : 1.0;
    return normalize(to_world(base, n));
}

// The normal of a layered material's clear coat, which does not follow that of what it covers.
vec3 coat_normal(Interaction at, Layered l) {
    if (l.clearcoat_normal_texture == NONE) return at.shading_normal;
    Basis base = basis_along(at.shading_normal, at.tangent.w != 0.0 ? at.tangent.xyz : at.dp_du);
    return mapped_normal(l.clearcoat_normal_texture, l.clearcoat_normal_scale, base, at);
}

Basis shading_basis(Interaction at, Material m, inout bool mapped) {
    vec3 along = at.tangent.w != 0.0 ? at.tangent.xyz : at.dp_du;
    Basis basis = basis_along(at.shading_normal, along);
    if (!HAS_MATERIAL_TEXTURES || m.textures == NONE) return basis;
    MaterialTextures t = TextureSets(scene.material_textures).at[m.textures];
    vec3 normal = basis.normal;
    if (HAS_NORMAL_MAPS && t.normal != NONE) normal = mapped_normal(t.normal, t.normal_scale, basis, at);
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
    return mapped ? basis_along(normal, along) : basis;
}
