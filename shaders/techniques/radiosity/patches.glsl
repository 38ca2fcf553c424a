// Patches: the pieces of surfaces that have one value each. Which of them a ray met, points of one, and the values.
#include "transport/vertex.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PatchTables { PatchTable table; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PatchFaces { PatchFace at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Patches { Patch at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Indices { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer PatchCorners { uvec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Values { vec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Counts { uint at[]; };

PatchTable patch_table() { return PatchTables(frame.technique).table; }

// The round of this dispatch, and whether it is one of those that add light of one more segment.
uint round_index() { return frame.word & ~PREPARING_BIT; }
bool round_prepares() { return (frame.word & PREPARING_BIT) != 0u; }

// The values that begin `count` vectors after an address.
Values values_after(uvec2 address, uint64_t count) { return Values(unpack32(pack64(address) + uint64_t(VEC3_BYTES) * count)); }

// A layer of irradiance in one of both halves: what patches have received from light of layer + 1 segments.
Values received(PatchTable t, uint part, uint layer) {
    return values_after(t.received, uint64_t(t.patch_count) * uint64_t(part * t.layers + layer));
}
Values newest(PatchTable t, uint part) { return values_after(t.newest, uint64_t(t.patch_count) * part); }
Values vertex_values(PatchTable t, uint layer) { return values_after(t.vertices, uint64_t(t.vertex_count) * layer); }

bool face_is_triangle(PatchFace f, Primitive p) { return f.second == NONE && !is_sphere(p); }

// A component chosen by comparison.
float component(vec3 w, uint i) { return i == 0u ? w.x : i == 1u ? w.y : w.z; }

// Coordinates on the face of a hit: along its two edges; of a sphere the azimuth in turns and the height, from pole to pole.
vec2 face_coordinates(PatchFace f, Primitive p, Hit hit, vec3 position) {
    if (is_sphere(p)) {
        vec3 object = position;
        if (HAS_INSTANCES) {
            Instance instance = load_instance(hit.instance);
            if (instance.moved != 0u) object = object_point(instance, position);
        }
        vec3 d = normalize(object - p.v0);
        return vec2(sphere_place(d).x, 0.5 - 0.5 * d.z);
    }
    vec3 w = vec3(1.0 - hit.uv.x - hit.uv.y, hit.uv);
    bool first = hit.primitive == f.primitive;
    uint turn = first ? f.turn & 3u : f.turn >> 2u;
    vec2 c = vec2(component(w, (turn + 1u) % 3u), component(w, (turn + 2u) % 3u));
    return first ? c : 1.0 - c;
}

// The hit at coordinates on the face. Of a sphere its ray must begin there: face_ray.
Hit face_hit(PatchFace f, Primitive p, vec2 c) {
    bool first = f.second == NONE || c.x + c.y <= 1.0;
    uint turn = first ? f.turn & 3u : f.turn >> 2u;
    if (!first) c = 1.0 - c;
    // The weights in the order of the face's corners, turned round to that of the triangle's.
    vec3 w = vec3(1.0 - c.x - c.y, c);
    vec2 uv = vec2(component(w, (4u - turn) % 3u), component(w, (5u - turn) % 3u));
    return Hit(0.0, first ? f.primitive : f.second, f.instance, uv);
}

// A ray of no length that arrives at those coordinates in the world direction w.
Ray face_ray(PatchFace f, Primitive p, vec2 c, vec3 w) {
    vec3 origin = vec3(0.0);
    if (is_sphere(p)) {
        float z = 1.0 - 2.0 * c.y, r = sqrt(max(0.0, 1.0 - z * z)), phi = 2.0 * PI * c.x;
        origin = p.v0 + abs(p.v1.x) * vec3(r * cos(phi), r * sin(phi), z);
        if (HAS_INSTANCES) {
            Instance instance = load_instance(f.instance);
            if (instance.moved != 0u) origin = world_point(instance, origin);
        }
    }
    return Ray(origin, w, 0.0);
}

// The cell at coordinates on the face. A triangle's are numbered like a square's: those that stand on their heads are the
// square's other half.
uint face_cell(PatchFace f, bool triangle, vec2 c) {
    vec2 scaled = clamp(c, 0.0, 1.0) * vec2(f.across, f.down);
    uvec2 cell = min(uvec2(scaled), uvec2(f.across, f.down) - 1u);
    if (triangle) {
        uint n = f.across;
        if (cell.x + cell.y >= n) cell = uvec2(cell.x, n - 1u - cell.x); // rounded across the third edge
        vec2 within = scaled - vec2(cell);
        if (within.x + within.y > 1.0 && cell.x + cell.y + 1u < n) cell = n - 1u - cell;
    }
    return cell.y * f.across + cell.x;
}

// The patch at a hit, on the front or the back, and where on its face that is; NONE where there is none.
uint patch_at(PatchTable t, Hit hit, vec3 position, bool front, out vec2 c) {
    c = vec2(0.0);
    uint index = Indices(t.face_of).at[Indices(t.face_base).at[hit.instance] + hit.primitive];
    if (index == NONE) return NONE;
    PatchFace f = PatchFaces(t.faces).at[index];
    uint first = front ? f.front : f.back;
    if (first == NONE) return NONE;
    Primitive p;
    p.surface = 0u;
    if (HAS_SPHERES) p = load_primitive(hit.primitive);
    c = face_coordinates(f, p, hit, position);
    return Indices(t.cells).at[first + face_cell(f, face_is_triangle(f, p), c)];
}

// A point of the patch, uniform over its area.
vec2 patch_coordinates(Patch p, bool triangle, vec2 u) { return p.corner + p.extent * (triangle ? sample_triangle(u) : u); }

// Irradiance at coordinates of a patch's face, from the values at its corners: bilinear, or linear on a triangle.
vec3 interpolated(PatchTable t, uint index, vec2 c, uint layer) {
    Patch p = Patches(t.patches).at[index];
    uvec4 corners = PatchCorners(t.corners).at[index];
    vec2 at = clamp((c - p.corner) / p.extent, 0.0, 1.0);
    Values values = vertex_values(t, layer);
    vec3 v0 = values.at[corners.x], v1 = values.at[corners.y], v2 = values.at[corners.z];
    if (corners.w == NONE) return v0 + at.x * (v1 - v0) + at.y * (v2 - v0);
    return mix(mix(v0, v1, at.x), mix(v2, values.at[corners.w], at.x), at.y);
}

// A sample whose weight, times eta^2, is a share of power: what leaves where as much comes from each direction.
BsdfSample power_sample(Vertex v, Bsdf b, Ray ray, vec3 u) {
    if (is_kind(b, HAS_MIXED_REFRACTION, MATERIAL_LAYERED)) b.m.flags |= MATERIAL_IS_ADJOINT; // each of its lobes has its own eta
    return vertex_sample(v, b, ray, u);
}
