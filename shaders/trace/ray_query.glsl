// Backend `ray-query`: the driver's own acceleration structures through VK_KHR_ray_query.
#extension GL_EXT_ray_query : require
#include "trace/sphere.glsl"

// How far this backend's own intersection may be off for a triangle of this extent. Drivers interpolate the distance
// from the vertices, whose offsets from the ray's origin are rounded.
float backend_margin(float extent) { return gamma(6.0) * extent; }

layout(set = 0, binding = BINDING_TLAS) uniform accelerationStructureEXT tlas;

// Runs the query to its end. Triangles are opaque and committed by the driver; spheres are boxes to it, and their
// surface is found here.
void proceed(rayQueryEXT query, Ray ray) {
    while (rayQueryProceedEXT(query)) {
        if (HAS_SPHERES && rayQueryGetIntersectionTypeEXT(query, false) == gl_RayQueryCandidateIntersectionAABBEXT) {
            uint instance = rayQueryGetIntersectionInstanceCustomIndexEXT(query, false);
            uint index = load_instance(instance).first_primitive + rayQueryGetIntersectionPrimitiveIndexEXT(query, false);
            Primitive sphere = load_primitive(index);
            float t = rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT
                ? ray.t_max
                : rayQueryGetIntersectionTEXT(query, true);
            vec3 origin = rayQueryGetIntersectionObjectRayOriginEXT(query, false);
            vec3 direction = rayQueryGetIntersectionObjectRayDirectionEXT(query, false);
            float found;
            if (sphere_hit(origin, direction, sphere.v0, sphere.v1.x, found) && found > 0.0 && found < t)
                rayQueryGenerateIntersectionEXT(query, found);
        }
    }
}

// The nearest hit in (0, t_max); with `any`, whether there is one, and what it is says nothing. The hit's members are read only once
// one is committed: before, they are undefined.
bool trace(Ray ray, const bool any, out Hit hit) {
    rayQueryEXT query;
    uint flags = HAS_SPHERES ? gl_RayFlagsNoneEXT : gl_RayFlagsOpaqueEXT;
    if (any) flags |= gl_RayFlagsTerminateOnFirstHitEXT;
    rayQueryInitializeEXT(query, tlas, flags, 0xff, ray.origin, 0.0, ray.direction, ray.t_max);
    proceed(query, ray);
    hit = Hit(ray.t_max, NONE, 0u, vec2(0.0));
    uint kind = rayQueryGetIntersectionTypeEXT(query, true);
    if (kind == gl_RayQueryCommittedIntersectionNoneEXT) return false;
    if (any) return true;
    hit.t = rayQueryGetIntersectionTEXT(query, true);
    hit.instance = rayQueryGetIntersectionInstanceCustomIndexEXT(query, true);
    hit.primitive = load_instance(hit.instance).first_primitive + rayQueryGetIntersectionPrimitiveIndexEXT(query, true);
    if (kind == gl_RayQueryCommittedIntersectionTriangleEXT) hit.uv = rayQueryGetIntersectionBarycentricsEXT(query, true);
    return true;
}
