// The colour of a surface apart from light, as denoisers take it: without noise, and the same from all sides but for the Fresnel
// reflectance of metals. Of glass it is the colour of its reflection: white, unless somebody chose another.
#include "materials/bsdf.glsl"

vec3 bsdf_albedo(Bsdf b, vec3 wo) {
    vec3 albedo = b.m.reflectance;
    if (is_kind(b, HAS_CONDUCTOR, MATERIAL_CONDUCTOR) || is_kind(b, HAS_ROUGH_CONDUCTOR, MATERIAL_ROUGH_CONDUCTOR))
        albedo *= fresnel_conductor(abs(wo.z), b.m.conductor_eta, b.m.conductor_k);
    return clamp(albedo, 0.0, 1.0);
}
