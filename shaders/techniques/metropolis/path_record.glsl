// What `lumbre trace` is told of a path that a chain proposes: its vertices in the order of a path from the camera, whichever way they were made. All of
// them have the numbers of path_value, which multiplies them: f |cos| / pdf at each vertex, and at the last one what is emitted.
#include "techniques/metropolis/path_vertices.glsl"
#include "transport/path.glsl"

// The vertex at hand: the throughput of the path up to there; f |cos| / pdf where it scatters, and the density of that, of a delta lobe the
// probability of choosing it.
struct RecordedVertex {
    vec3 throughput;
    vec3 weight;
    float pdf;
};

RecordedVertex recorded_vertex;

void record_route_weight(vec3 weight, float pdf) {
    recorded_vertex.weight = weight;
    recorded_vertex.pdf = pdf;
}

void record_route_begin(vec3 position, vec3 direction) {
    if (!records(RECORD_BEGIN)) return;
    PathRecord r = record_of(RECORD_BEGIN, 0u);
    r.position = position;
    r.direction = direction;
    record_append(r);
}

// Vertex i, where the path has arrived along the ray.
void record_route_vertex(uint i, PathVertex x, Ray ray) {
    if (!records(RECORD_VERTEX)) return;
    PathRecord r = record_of(RECORD_VERTEX, i);
    r.position = x.position;
    r.direction = -ray.direction;
    r.throughput = recorded_vertex.throughput;
    if (vertex_kind(x) == VERTEX_SURFACE) {
        Vertex v = vertex_at(ray, vertex_hit(x));
        r.normal = v.at.normal;
        r.material = v.material;
        r.primitive = x.index;
        r.instance = x.detail.x;
    } else {
        if (vertex_kind(x) == VERTEX_AREA) r.normal = light_normal(x);
        r.primitive = x.index;
        r.flags = RECORDED_LIGHT;
    }
    record_append(r);
}

// Vertex i, which scatters into the direction.
void record_route_scatter(uint i, PathVertex x, Bsdf b, Ray ray, vec3 direction) {
    record_route_vertex(i, x, ray);
    if (!records(RECORD_SCATTER)) return;
    bool delta = scatters_by_delta(x);
    PathRecord r = record_of(RECORD_SCATTER, i);
    r.position = x.position;
    r.direction = direction;
    r.value = recorded_vertex.weight;
    r.throughput = recorded_vertex.throughput * recorded_vertex.weight;
    r.pdf = recorded_vertex.pdf;
    r.flags = delta ? RECORDED_DELTA | RECORDED_NARROW : !IS_MIXTURE(b) && IS_ROUGH(b) && is_narrow(roughness(b.m)) ? RECORDED_NARROW : 0u;
    record_append(r);
}

// The light's vertex, the i-th, with what it emits along the path; both densities are over solid angle at the vertex before.
void record_route_light(uint i, PathVertex x, PathVertex before, vec3 direction, float distance2, vec3 emitted) {
    if (!is_distant(x)) record_route_vertex(i, x, Ray(x.position, direction, INFINITY));
    if (!records(RECORD_EMISSION)) return;
    PathRecord r = record_of(RECORD_EMISSION, i);
    r.direction = -direction;
    r.value = emitted;
    r.throughput = recorded_vertex.throughput;
    r.pdf = i == 1u || scatters_by_delta(before) || is_alone(x) ? 0.0 : before.pdf;
    r.other_pdf = is_alone(x) ? 0.0 : is_distant(x) ? x.pdf : x.pdf * distance2 / x.arriving;
    r.weight = 1.0;
    r.flags = is_alone(x) ? RECORDED_DELTA : 0u;
    record_append(r);
}
