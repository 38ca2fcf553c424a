// What lies where a ray met a surface, and how far a ray that starts there must move off the surface.
#include "trace/trace.glsl"
#include "trace/triangle_plane.glsl"
#include "core/angle.glsl"
#include "core/texture.glsl"

struct Interaction {
    vec3 position;
    float margin;        // along the geometric normal, so that a ray from there cannot meet the surface that it leaves
    vec3 normal;         // geometric normal, unit, pointing to the front side
    vec3 shading_normal; // unit; equals the geometric one where the mesh has no vertex normals
    uint surface;
    vec2 uv;             // texture coordinates
    float uv_area;       // area in them per area of the surface, only for mip maps
    vec3 dp_du;          // change of the position per unit of them; zero where it is undetermined
    vec3 dp_dv;
    vec4 tangent;        // of normal maps: direction and sign of the bitangent; zero where it follows dp_du
    vec4 colour;         // vertex colour
    uvec3 corners;       // indices of the vertices' attributes that textures show, NONE where there are none
    vec3 weights;        // of these vertices
};

TexturePlace place_of(Interaction at) { return TexturePlace(at.uv, at.corners, at.weights); }

// Texture coordinates of a sphere (azimuth around its axis, angle from its pole) and the position's change with them. Its
// orientation is a quaternion, mirrored where v1.y is negative.
void sphere_uv(Primitive p, vec3 outward, inout Interaction at) {
    vec3 q = p.v2;
    float w = sqrt(max(0.0, 1.0 - dot(q, q)));
    vec3 local = outward + 2.0 * cross(-q, cross(-q, outward) + w * outward);
    local *= p.v1.y < 0.0 ? -1.0 : 1.0;
    at.uv = sphere_place(local);
    if (HAS_MIP_MAPS) at.uv_area = 0.5 * INV_PI * INV_PI / (p.v1.x * p.v1.x * max(1e-3, length(local.xy)));
    if (HAS_TANGENTS) {
        float sine = sqrt(max(1e-12, local.x * local.x + local.y * local.y));
        vec3 du = 2.0 * PI * vec3(-local.y, local.x, 0.0);
        vec3 dv = PI * vec3(local.z * local.x / sine, local.z * local.y / sine, -sine);
        float r = abs(p.v1.x) * (p.v1.y < 0.0 ? -1.0 : 1.0);
        at.dp_du = r * (du + 2.0 * cross(q, cross(q, du) + w * du));
        at.dp_dv = r * (dv + 2.0 * cross(q, cross(q, dv) + w * dv));
    }
}

// Texture coordinates, tangents and colours of a triangle.
void triangle_attributes(Primitive p, Hit hit, inout Interaction at) {
    vec2 uv0 = vec2(0.0), uv1 = vec2(1.0, 0.0), uv2 = vec2(0.0, 1.0);
    bool has_uvs = (p.surface & UV_BIT) != 0u;
    bool has_tangents = HAS_TANGENTS && (p.surface & TANGENT_BIT) != 0u;
    bool has_colours = HAS_COLOURS && scene.colours != uvec2(0u);
    bool has_others = (HAS_ATTRIBUTES || HAS_SECOND_UVS) && scene.corners != uvec2(0u); // which textures look up by themselves
    Corners corners = Corners(0u, 0u, 0u);
    if (has_uvs || has_colours || has_tangents || has_others) corners = Triples(scene.corners).at[hit.primitive];
    if (has_uvs) {
        Vectors2 uvs = Vectors2(scene.uvs);
        uv0 = uvs.at[corners.i0], uv1 = uvs.at[corners.i1], uv2 = uvs.at[corners.i2];
    }
    vec3 b = vec3(1.0 - hit.uv.x - hit.uv.y, hit.uv);
    at.uv = b.x * uv0 + b.y * uv1 + b.z * uv2;
    if (has_others) {
        at.corners = uvec3(corners.i0, corners.i1, corners.i2);
        at.weights = b;
    }
    if (has_colours && corners.i0 != NONE) {
        Vectors4 colours = Vectors4(scene.colours);
        at.colour = b.x * colours.at[corners.i0] + b.y * colours.at[corners.i1] + b.z * colours.at[corners.i2];
    }
    if (HAS_MIP_MAPS) {
        vec2 d1 = uv1 - uv0, d2 = uv2 - uv0;
        at.uv_area = abs(d1.x * d2.y - d1.y * d2.x) / length(triangle_normal(p.v0, p.v1, p.v2));
    }
    if (HAS_TANGENTS) {
        vec2 d1 = uv1 - uv0, d2 = uv2 - uv0;
        vec3 e1 = p.v1 - p.v0, e2 = p.v2 - p.v0;
        float determinant = d1.x * d2.y - d1.y * d2.x;
        if (determinant != 0.0) {
            at.dp_du = (d2.y * e1 - d1.y * e2) / determinant;
            at.dp_dv = (d1.x * e2 - d2.x * e1) / determinant;
        }
        if (has_tangents) {
            Vectors4 tangents = Vectors4(scene.tangents);
            at.tangent = b.x * tangents.at[corners.i0] + b.y * tangents.at[corners.i1] + b.z * tangents.at[corners.i2];
        }
    }
}

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
    at.uv = vec2(0.0);
    at.uv_area = 0.0;
    at.dp_du = vec3(0.0);
    at.dp_dv = vec3(0.0);
    at.tangent = vec4(0.0);
    at.colour = vec4(1.0);
    at.corners = uvec3(NONE);
    at.weights = vec3(0.0);

    vec3 origin = ray.origin;
    vec3 direction = ray.direction;
    Instance instance;
    bool moved = false;
    if (HAS_INSTANCES) {
        instance = load_instance(hit.instance);
        moved = instance.moved != 0u;
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
        if (HAS_UVS) sphere_uv(primitive, outward, at);
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
        if (HAS_UVS) triangle_attributes(primitive, hit, at);
    }

    if (HAS_INSTANCES && moved) {
        // Positions by the map, normals by its inverse transpose. The margin grows with the map, and both ways of it
        // are rounded: here, and when a ray that starts here is taken back to the object's space.
        vec3 p = at.position;
        at.position = world_point(instance, p);
        vec3 there = abs_world_point(instance, abs(p));
        vec3 back = abs_world_vector(instance, abs_object_point(instance, abs(at.position)));
        at.margin = largest(abs_world_vector(instance, vec3(at.margin))) + gamma(4.0) * (largest(there) + largest(back));
        vec3 normal = world_normal(instance, at.normal);
        if (HAS_MIP_MAPS) at.uv_area /= abs(dot(instance.world0.xyz, cross(instance.world1.xyz, instance.world2.xyz))) * length(normal);
        at.normal = normalize(normal);
        at.shading_normal = normalize(world_normal(instance, at.shading_normal));
        if (HAS_TANGENTS) {
            at.dp_du = world_vector(instance, at.dp_du);
            at.dp_dv = world_vector(instance, at.dp_dv);
            at.tangent.xyz = world_vector(instance, at.tangent.xyz);
        }
    }
    return at;
}

// The position moved off the surface, to the side that `w` points to.
vec3 offset_origin(vec3 position, float margin, vec3 normal, vec3 w) {
    return position + (dot(w, normal) < 0.0 ? -margin : margin) * normal;
}
