// A vertex of a path: the surface point where a ray arrived, its material, and the rays that leave it.
#include "transport/visibility.glsl"
#include "materials/bsdf.glsl"
#include "lights/light.glsl"

// A surface point in its local shading frame, on the side that the path came from.
struct Vertex {
    Hit hit;
    Interaction at;
    Surface surface;
    Basis basis;
    vec3 wo;           // local, towards the previous vertex
    float turned;      // -1 where the frame is turned round to face a path that came to the back
    uint material;     // NONE reflects nothing
    bool front;        // the path came to the front of the surface, by the shading normal
    bool mapped;       // a normal or bump map tilts the frame off the shading normal
    bool flips;        // ... so that the camera sees it from above: to the other side than the map says, where that is needed
    bool flipped;      // ... as is the case here
    bool shadowed;     // ... and its slopes shadow each other
    bool from_light;   // a light subpath came there
    float side;        // of what the path sees there, in texture coordinates; 0 is a point
};

// The vertex where the ray has arrived.
Vertex vertex_of(Ray ray, Hit hit, Interaction at) {
    Vertex v;
    v.hit = hit;
    v.at = at;
    v.surface = load_surface(v.at.surface);
    v.basis = basis_from_normal(v.at.shading_normal);
    v.wo = to_local(v.basis, -ray.direction);
    v.front = v.wo.z > 0.0;
    v.material = v.front || !HAS_BACK_MATERIALS ? v.surface.front : v.surface.back;
    v.turned = 1.0;
    v.mapped = v.flips = v.flipped = v.shadowed = v.from_light = false;
    v.side = 0.0;
    if (!HAS_BACK_MATERIALS && !v.front || v.wo.z == 0.0) v.material = NONE;
    return v;
}

Vertex vertex_at(Ray ray, Hit hit) { return vertex_of(ray, hit, interaction_at(ray, hit)); }

// Follows the ray to the nearest surface that does not let it pass, and moves it on behind those that do; false where it leaves the scene.
// Rays from the camera pass emitters that are hidden.
bool vertex_arrive(inout Ray ray, bool from_camera, out Vertex v, inout Sampler random, inout uint rays) {
    Hit hit;
    Interaction at;
    if (!trace_visible(ray, from_camera, hit, at, random, rays)) return false;
    v = vertex_of(ray, hit, at);
    return true;
}

#include "transport/shading_basis.glsl"

// A mapped normal that the camera's side is below of is mirrored at the shading normal (Schuessler, Heitz, Hanika and Dachsbacher 2017,
// "Microfacet-based normal mapping for robust Monte Carlo path tracing": the other facet of the V that a tilted one belongs to). The normal as the
// map has it, and mirrored:
vec3 mirrored_normal(Vertex v) { return 2.0 * dot(v.basis.normal, v.at.shading_normal) * v.at.shading_normal - v.basis.normal; }

// Whether a direction to the camera's side is below the normal that the map says, but not below the surface, or the other way round.
bool vertex_flips(Vertex v, vec3 world) {
    vec3 normal = v.basis.normal;
    if (v.flipped) normal = mirrored_normal(v);
    return dot(world, v.at.shading_normal) * dot(world, normal) <= 0.0;
}

// Probability with which a light subpath, which does not know the camera's side yet, takes the normal that it has: the mirrored one as often as cosine-weighted
// directions ask for it.
float vertex_flip_share(Vertex v) {
    float flips = clamp(0.5 * (1.0 - dot(v.basis.normal, v.at.shading_normal)), 1e-3, 1.0 - 1e-3);
    return v.flipped ? flips : 1.0 - flips;
}

void vertex_flip(inout Vertex v, Ray ray, inout Sampler random) {
    if (v.from_light ? next4(random).x >= vertex_flip_share(v) : vertex_flips(v, -ray.direction)) {
        v.basis = basis_along(mirrored_normal(v), v.at.dp_du);
        v.flipped = true;
    }
}

// The share of light from a direction that the slopes of a mapped surface let through to each other (Estevez, Lecocq and Stein 2019, "A microfacet-based
// shadowing function to solve the bump terminator problem", Ray Tracing Gems, chapter 12).
float slope_shadowing(Vertex v, vec3 light) {
    float cos_n = dot(v.basis.normal, v.at.shading_normal), cos_l = dot(light, v.at.shading_normal);
    float alpha2 = clamp(0.125 * (1.0 / (cos_n * cos_n) - 1.0), 0.0, 1.0);
    float tan2 = max(1.0 / (cos_l * cos_l) - 1.0, 0.0);
    return 2.0 / (1.0 + sqrt(1.0 + alpha2 * tan2));
}

// The vertex's material; turns the frame round where the path came to the back of something that reflects only.
Bsdf vertex_material(inout Vertex v, Ray ray, inout Sampler random) {
    Bsdf b = bsdf_at(v.material, place_of(v.at), v.side, v.at.colour, random);
    if (HAS_TANGENTS && (b.m.flags & MATERIAL_HAS_TANGENTS) != 0u) {
        v.basis = shading_basis(v.at, b.m, v.mapped);
        v.shadowed = HAS_SHADOWED_NORMALS && v.mapped && (b.m.flags & MATERIAL_SHADOWS_NORMALS) != 0u;
        v.flips = HAS_FLIPPED_NORMALS && v.mapped && (b.m.flags & MATERIAL_FLIPS_NORMALS) != 0u;
        if (v.flips) vertex_flip(v, ray, random);
        v.wo = to_local(v.basis, -ray.direction);
        // A mesh's bitangent may point the other way than the frame's.
        if (HAS_LAYERED_ANISOTROPY && v.at.tangent.w < 0.0) b.layered.anisotropy_direction.y = -b.layered.anisotropy_direction.y;
    }
    if (HAS_BACK_MATERIALS && !v.front && !bsdf_transmits(b)) {
        v.wo.z = -v.wo.z;
        v.turned = -1.0;
    }
    if (HAS_COAT_NORMALS && is_kind(b, HAS_LAYERED, MATERIAL_LAYERED)) {
        vec3 normal = to_local(v.basis, coat_normal(v.at, b.layered));
        b.layered.clearcoat_normal = vec3(v.turned * normal.xy, normal.z);
    }
    return b;
}

vec3 vertex_to_world(Vertex v, vec3 w) { return to_world(v.basis, vec3(w.xy, w.z * v.turned)); }

vec3 vertex_to_local(Vertex v, vec3 w) {
    vec3 local = to_local(v.basis, w);
    return vec3(local.xy, local.z * v.turned);
}

// A tilted frame calls directions above the surface that are below it and the other way round; neither carries light, or it
// would leak through.
bool vertex_is_sound(Vertex v, vec3 local, vec3 world) { return local.z * v.turned * dot(world, v.at.shading_normal) > 0.0; }

// The share of light that a mapped frame lets go from one direction to the other, the local and world forms of the second being given: where light
// comes from at the vertex of a camera subpath, where the camera lies at that of a light subpath. There the frame was chosen by chance.
float vertex_passage(Vertex v, Ray ray, vec3 local, vec3 world) {
    if (!v.mapped) return 1.0;
    if (!vertex_is_sound(v, v.wo, -ray.direction) || !vertex_is_sound(v, local, world)) return 0.0;
    float passage = 1.0;
    if (HAS_FLIPPED_NORMALS && v.flips && v.from_light) passage = vertex_flips(v, world) == v.flipped ? 1.0 / vertex_flip_share(v) : 0.0;
    return HAS_SHADOWED_NORMALS && v.shadowed ? passage * slope_shadowing(v, v.from_light ? -ray.direction : world) : passage;
}

vec3 vertex_eval(Vertex v, Bsdf b, Ray ray, vec3 local, vec3 world) {
    float passage = vertex_passage(v, ray, local, world);
    return passage > 0.0 ? passage * bsdf_eval(b, v.wo, local) : vec3(0.0);
}

// Takes what a mapped frame does not let pass from the weight of a sample.
void vertex_check(Vertex v, Ray ray, inout BsdfSample s) {
    if (v.mapped) s.weight *= vertex_passage(v, ray, s.wi, vertex_to_world(v, s.wi));
}

BsdfSample vertex_sample(Vertex v, Bsdf b, Ray ray, vec3 u) {
    if (v.from_light) b.m.flags |= MATERIAL_IS_ADJOINT;
    BsdfSample s = bsdf_sample(b, v.wo, u);
    vertex_check(v, ray, s);
    return s;
}

// The ray from one point to just before another.
Ray ray_between(vec3 origin, vec3 target) {
    vec3 d = target - origin;
    float distance = length(d);
    return Ray(origin, d / distance, distance * (1.0 - gamma(8.0)));
}

float vertex_opacity(Vertex v) { return surface_opacity(v.surface, place_of(v.at), v.at.colour.a); }

// The vertex as what lights shine on.
ReferencePoint vertex_reference(Vertex v, Bsdf b) { return ReferencePoint(v.at.position, v.turned * v.basis.normal, bsdf_transmits(b)); }

// The ray that leaves the vertex in the world direction w.
Ray vertex_ray(Vertex v, vec3 w) {
    return Ray(offset_origin(v.at.position, v.at.margin, v.at.normal, w), w, INFINITY);
}

// The ray from the vertex up to a target that lies off its own surface, like the origin: what is left is the rounding of t.
Ray vertex_ray_to(Vertex v, vec3 w, vec3 target) { return ray_between(vertex_ray(v, w).origin, target); }

// The ray from the vertex to another one in the world direction w, off both surfaces.
Ray vertex_ray_between(Vertex v, vec3 w, Vertex to) { return vertex_ray_to(v, w, offset_origin(to.at.position, to.at.margin, to.at.normal, -w)); }

// Absorption of the medium on the side of the vertex that a local direction leaves to, given that of the medium it was reached through.
vec3 vertex_absorption(Vertex v, Bsdf b, vec3 absorption, vec3 local) {
    if (!HAS_ABSORPTION || (b.m.flags & MATERIAL_HAS_ABSORPTION) == 0u || local.z * v.wo.z > 0.0) return absorption;
    return local.z < 0.0 ? b.layered.absorption : vec3(0.0);
}

// Share of light that passes along a ray through a medium of this absorption, from end to end, one of which may be the camera.
vec3 ray_transmittance(Ray ray, bool to_camera, vec3 absorption, inout uint rays) {
    float through = trace_transmittance(ray, to_camera, rays);
    if (!HAS_ABSORPTION || absorption == vec3(0.0)) return vec3(through);
    return ray.t_max == INFINITY ? vec3(0.0) : through * exp(-absorption * ray.t_max);
}
