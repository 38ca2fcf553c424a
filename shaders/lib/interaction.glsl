// What lies where a ray met a surface, and how far a ray that starts there must move off the surface.
#include "lib/triangle.glsl"

struct Interaction {
    vec3 position;
    float margin;        // along the geometric normal, so that a ray from there cannot meet the surface that it leaves
    vec3 normal;         // geometric normal, unit, pointing to the front side
    vec3 shading_normal; // unit; equals the geometric one where the mesh has no vertex normals
    uint surface;
};

float largest(vec3 v) { return max(v.x, max(v.y, v.z)); }

// The margin of a point on a triangle, the backend's own error included.
float margin_on_triangle(vec3 normal, vec3 v0, vec3 v1, vec3 v2, vec3 p) {
    return triangle_margin(normal, v0, p) + backend_margin(largest(max(abs(v1 - v0), abs(v2 - v0))));
}

// The margin of a point on a sphere: its distance from the centre, and the intersection's discriminant, are rounded.
float margin_on_sphere(vec3 centre, float radius) { return gamma(8.0) * (largest(abs(centre)) + abs(radius)); }

Interaction interaction_at(Ray ray, Hit hit) {
    Primitive primitive = load_primitive(hit.primitive);
    Interaction at;
    at.surface = primitive.surface & SURFACE_MASK;

    vec3 origin = ray.origin;
    vec3 direction = ray.direction;
    Instance instance;
    if (HAS_INSTANCES) {
        instance = load_instance(hit.instance);
        origin = object_point(instance, ray.origin);
        direction = object_vector(instance, ray.direction);
    }

    if (is_sphere(primitive)) {
        float radius = primitive.v1.x;
        vec3 outward = normalize(origin + hit.t * direction - primitive.v0);
        at.position = primitive.v0 + abs(radius) * outward;
        at.margin = margin_on_sphere(primitive.v0, radius);
        at.normal = radius < 0.0 ? -outward : outward;
        at.shading_normal = at.normal;
    } else {
        at.position = triangle_point(primitive.v0, primitive.v1, primitive.v2, hit.uv);
        at.normal = normalize(triangle_normal(primitive.v0, primitive.v1, primitive.v2));
        at.margin = margin_on_triangle(at.normal, primitive.v0, primitive.v1, primitive.v2, at.position);
        at.shading_normal = at.normal;
        if (HAS_NORMALS && (primitive.surface & SMOOTH_BIT) != 0u) {
            Corners corners = Triples(scene.corners).at[hit.primitive];
            Vectors normals = Vectors(scene.normals);
            vec3 n = (1.0 - hit.uv.x - hit.uv.y) * normals.at[corners.i0] + hit.uv.x * normals.at[corners.i1] +
                     hit.uv.y * normals.at[corners.i2];
            float length2 = dot(n, n);
            at.shading_normal = length2 > 0.0 ? n * inversesqrt(length2) : at.normal;
        }
    }

    if (HAS_INSTANCES) {
        // Positions by the map, normals by its inverse transpose. The margin grows with the map, and both ways of it
        // are rounded: here, and when a ray that starts here is taken back to the object's space.
        vec3 p = at.position;
        at.position = world_point(instance, p);
        vec3 there = abs_world_point(instance, abs(p));
        vec3 back = abs_world_vector(instance, abs_object_point(instance, abs(at.position)));
        at.margin = largest(abs_world_vector(instance, vec3(at.margin))) + gamma(4.0) * (largest(there) + largest(back));
        at.normal = normalize(world_normal(instance, at.normal));
        at.shading_normal = normalize(world_normal(instance, at.shading_normal));
    }
    return at;
}

// The position moved off the surface, to the side that `w` points to.
vec3 offset_origin(vec3 position, float margin, vec3 normal, vec3 w) {
    return position + (dot(w, normal) < 0.0 ? -margin : margin) * normal;
}
