// The contribution of a path, and the densities with which mutations would have made it. All are products over its vertices and segments, and
// what two paths share cancels in the ratio that decides between them.
//
// With p_i the density of going on from vertex i away from the camera (`pdf`, over solid angle; 1 at delta lobes), A_i what takes it
// to area at the next vertex (`arriving` times `nearness`), and F the throughput of the path from the camera times what is emitted, a
// path contributes F p_0 A_1 p_1 A_2 ... A_k per area at all its vertices.
#include "techniques/metropolis/path_vertices.glsl"
#include "techniques/metropolis/path_record.glsl"
#include "transport/emission.glsl"
#include "transport/light_subpath.glsl"

// A proposed path. Vertices up to `kept_before` and from `kept_after` on are those of the current one.
struct Route {
    uint chain;        // whose room it takes
    uint slot;         // which of the chain's two paths it is
    uint segments;
    uint kept_before;
    uint kept_after;
    uint joined;       // the vertex whose segment to the next one was not traced when that was made; NONE is none
    bool meets_lamp;   // before its last vertex, filled in by path_value
};

PathVertex route_vertex(Route r, uint i) { return path_vertex(r.chain, r.slot, i).vertex; }

// Where paths that run until they meet a light end.
bool is_lamp(Vertex v) { return v.surface.emission_density > 0.0; }

// The light's vertex: what it emits along the path, its densities, and where a ray to it ends.
vec3 light_value(inout PathVertex x, PathVertex before, vec3 direction, float distance2, inout vec3 target) {
    uint kind = vertex_kind(x);
    x.arriving = 1.0;
    if (kind == VERTEX_BACKGROUND) {
        x.pdf = background_pdf(direction);
        x.reverse_pdf = disk_pdf(before.position, direction);
        return background_radiance(direction);
    }
    if (kind == VERTEX_AREA) {
        x.arriving = -dot(direction, light_normal(x));
        if (x.arriving <= 0.0) return vec3(0.0);
        x.reverse_pdf = surface_emission_pdf(x.position, -direction, x.arriving);
        target = offset_origin(x.position, x.leaving, light_normal(x), -direction);
        return light_radiance(x);
    }
    if (is_alone(x)) {
        Light light = load_light(x.index);
        LightSample s = delta_light_sample(light, before.position);
        float share = light.probability * distance2;
        x.pdf = light.emission_probability;
        x.reverse_pdf = s.emitted * share / x.pdf;
        return s.weight * share;
    }
    Ray ray = Ray(x.position, direction, INFINITY);
    Vertex v = vertex_at(ray, vertex_hit(x));
    float cosine = abs(dot(direction, v.at.normal));
    x.arriving = cosine * vertex_opacity(v);
    target = offset_origin(v.at.position, v.at.margin, v.at.normal, -direction);
    x.pdf = v.surface.emission_density;
    x.reverse_pdf = surface_emission_pdf(x.position, -direction, cosine);
    return vertex_emission(v, ray);
}

// F, and the densities of all vertices; nothing where the path contributes nothing.
vec3 path_value(inout Route r, inout uint rays) {
    if (HIDES_EMITTERS && r.segments == 1u) return vec3(0.0);
    vec3 value = vec3(1.0);
    vec3 absorption = HAS_ABSORPTION ? scene.camera_absorption : vec3(0.0);
    PathVertex before = route_vertex(r, 0u), x = route_vertex(r, 1u), next;
    r.meets_lamp = false;
    vec3 origin = before.position; // of rays away from the vertex before, moved off its surface
    vec3 direction = CAMERA == CAMERA_ORTHOGRAPHIC ? scene.camera_corner : segment_direction(before, x);
    before.pdf = camera_importance(direction) / light_path_count();
    if (RECORDS) record_route_begin(before.position, direction);
    for (uint i = 1u; i <= r.segments; i++) {
        bool last = i == r.segments, distant = is_distant(x);
        vec3 d = distant ? direction : x.position - before.position;
        float length2 = dot(d, d);
        float distance2 = distant || CAMERA == CAMERA_ORTHOGRAPHIC && i == 1u ? 1.0 : length2;
        if (!(distance2 > 0.0)) return vec3(0.0);
        vec3 target = x.position, onwards = direction, leaving_from = x.position;
        Ray ray = Ray(x.position, direction, INFINITY);
        vec3 arrived = absorption;
        if (RECORDS) recorded_vertex.throughput = HAS_ABSORPTION && !distant ? value * exp(-arrived * sqrt(length2)) : value;
        if (last) {
            vec3 emitted = light_value(x, before, direction, distance2, target);
            value *= emitted;
            if (RECORDS) record_route_light(i, x, before, direction, distance2, emitted);
        } else {
            next = route_vertex(r, i + 1u);
            onwards = segment_direction(x, next);
            Vertex v = vertex_at(ray, vertex_hit(x));
            if (v.material == NONE || is_hidden(i == 1u, v.at.surface)) return vec3(0.0);
            if (is_lamp(v)) r.meets_lamp = true;
            Sampler random = vertex_random(x, 0u);
            Bsdf b = vertex_material(v, ray, random);
            vec3 local = vertex_to_local(v, onwards);
            x.arriving = abs(dot(direction, v.at.normal));
            x.leaving = abs(dot(onwards, v.at.normal));
            if (x.arriving == 0.0 || x.leaving == 0.0) return vec3(0.0);
            if (scatters_by_delta(x)) {
                random = vertex_random(x, SCATTER_NUMBERS);
                BsdfSample s = vertex_sample(v, b, ray, next4(random).xyz);
                if (!s.delta || s.wi.z * local.z <= 0.0) return vec3(0.0);
                value *= s.weight;
                if (RECORDS) record_route_weight(s.weight, s.pdf_w);
                x.pdf = 1.0;
                // The lobe takes a solid angle to another one: n^2 |cos| of it stays (Veach 1997, section 5.2).
                x.reverse_pdf = abs(v.wo.z / local.z) / (s.eta * s.eta);
            } else {
                if (bsdf_is_delta(b)) return vec3(0.0);
                vec3 f = vertex_eval(v, b, ray, local, onwards);
                value *= f;
                x.pdf = i + 1u == r.segments && is_alone(next) ? 1.0 : bsdf_pdf(b, v.wo, local);
                x.reverse_pdf = bsdf_pdf(b, local, v.wo);
                if (!(x.pdf > 0.0)) return vec3(0.0);
                value /= x.pdf;
                if (RECORDS) record_route_weight(f / x.pdf, x.pdf);
            }
            if (RECORDS) record_route_scatter(i, x, b, ray, onwards);
            if (HAS_FLIPPED_NORMALS && v.flips) x.reverse_pdf *= vertex_flip_share(v); // a light subpath takes this frame so often
            absorption = vertex_absorption(v, b, absorption, local);
            target = offset_origin(v.at.position, v.at.margin, v.at.normal, -direction);
            leaving_from = offset_origin(v.at.position, v.at.margin, v.at.normal, onwards);
        }
        if (HAS_ABSORPTION) value *= distant ? vec3(arrived == vec3(0.0) ? 1.0 : 0.0) : exp(-arrived * sqrt(length2));
        if (!(scalar_contribution(value) > 0.0)) return vec3(0.0);
        // Segments that were kept have what they let through in them.
        if (i > r.kept_before && i <= r.kept_after) {
            float through = 1.0;
            if (HAS_MASKS || i == r.joined + 1u) through = trace_transmittance(distant ? Ray(origin, direction, INFINITY) : ray_between(origin, target), i == 1u, rays);
            x.nearness = through / distance2;
            if (through == 0.0) return vec3(0.0);
        }
        path_vertex(r.chain, r.slot, i - 1u).vertex = before;
        path_vertex(r.chain, r.slot, i).vertex = x;
        before = x;
        x = next;
        direction = onwards;
        origin = leaving_from;
    }
    return value;
}

// A_i p_(i-1): density per area with which a path from the camera comes to vertex i from the one before.
float density_from_camera(Route r, uint i) {
    PathVertex x = route_vertex(r, i);
    return route_vertex(r, i - 1u).pdf * x.arriving * x.nearness;
}

// Density per area with which a path from the light comes to vertex i from the one after.
float density_from_light(Route r, uint i) {
    PathVertex x = route_vertex(r, i);
    if (i == r.segments) return x.pdf;
    PathVertex next = route_vertex(r, i + 1u);
    return next.reverse_pdf * x.leaving * next.nearness;
}

// Whether a mutation may make vertex i from the camera and the next one from the light, and join them; with i = k the path from the camera
// runs into the light by itself.
bool joinable(Route r, uint i) {
    if (i == r.segments) return !is_alone(route_vertex(r, i));
    if (i > 0u && scatters_by_delta(route_vertex(r, i))) return false;
    if (i + 1u == r.segments) return i > 0u || vertex_kind(route_vertex(r, 1u)) == VERTEX_SURFACE || vertex_kind(route_vertex(r, 1u)) == VERTEX_AREA;
    return !scatters_by_delta(route_vertex(r, i + 1u));
}

// Of making the vertices between two others: the sum over the ways to do it, so many from the camera and the others from the light, of
// their densities, over that with all from the camera. `last` is k + 1 where the light's vertex is made too.
float ways(Route r, uint first, uint last) {
    float sum = joinable(r, first) ? 1.0 : 0.0;
    for (uint i = first + 1u; i < last; i++) {
        sum *= density_from_light(r, i) / density_from_camera(r, i);
        sum = min(sum, 1e30) + (joinable(r, i) ? 1.0 : 0.0);
    }
    return sum;
}

// Bidirectional mutations (Veach 1997, section 11.4.1) replace what lies between two vertices by as many new ones as they have drawn; each
// number of them from the camera is as likely. The contribution over the density of being proposed, in what varies between two paths of
// which one is made from the other: F, what the segment to the vertex that is kept has (that is made by no density), and the sum above.
float bidirectional_quotient(Route r, float value, uint first, uint last) {
    float quotient = value * float(last - first) / ways(r, first, last);
    if (last > r.segments) return quotient;
    return quotient * density_from_camera(r, last) * route_vertex(r, last).pdf;
}

// Large steps are of kinds: one for each number of segments, bidirectional, and one that follows a path from the camera until it meets a
// light, however long that is. Emission that next-event estimation cannot sample is met by each of them instead of by one for each length and number of
// vertices from the light. From the vertex RUN_SURE on they go on with probability RUN_ON, which lets densities depend on nothing else.
const uint RUN_SURE = 4u;
const float RUN_ON = 0.75;

// The most segments of a path; also the kind of large steps that run until they meet a light.
uint most_segments() { return chain_table().kind_count - 1u; }

// Density with which large steps make the path, over that of making it from the camera at its length: by running, and by all kinds.
vec2 large_density(Route r) {
    uint k = r.segments;
    PathVertex light = route_vertex(r, k);
    bool ends = vertex_kind(light) == VERTEX_BACKGROUND || !is_alone(light) && light.pdf > 0.0;
    float runs = ends && !r.meets_lamp ? kind_probability(most_segments()) * pow(RUN_ON, float(max(k, RUN_SURE) - RUN_SURE)) : 0.0;
    return vec2(runs, runs + kind_probability(k - 1u) * ways(r, 0u, k + 1u) / float(k + 1u));
}

// Perturbations from the camera (lens and multi-chain perturbations, Veach 1997, sections 11.4.2 and 11.4.4) move the place in the image, or
// the direction at a vertex that scatters, as far as likely either way; so the density of what they make is that of following the
// path, without the p_i: over it F p_1 ... p_n is left, and where vertex n is joined to one that is kept, A_(n+1) p_(n+1).
float camera_quotient(Route r, float value, uint n) {
    for (uint i = 1u; i <= min(n, r.segments - 1u); i++) value *= route_vertex(r, i).pdf;
    if (n == r.segments) return value;
    PathVertex x = route_vertex(r, n + 1u);
    return value * x.arriving * x.nearness * (n + 1u < r.segments ? x.pdf : 1.0);
}

// Perturbations towards the camera (caustic perturbations, section 11.4.3) move the direction in which light leaves vertex m, and follow
// it through delta lobes to vertex 1, which is joined to the camera. Each vertex comes about with its `leaving` and the next segment's nearness,
// and the reverse_pdf of the lobe before; nearness cancels but for the segment to the camera.
float caustic_quotient(Route r, float value, uint m) {
    PathVertex x = route_vertex(r, 1u);
    value *= route_vertex(r, 0u).pdf * x.arriving * x.nearness;
    for (uint i = 1u; i <= min(m, r.segments - 1u); i++) value *= route_vertex(r, i).pdf;
    for (uint i = 2u; i <= m; i++) {
        float leaving = x.leaving;
        x = route_vertex(r, i);
        value *= x.arriving / leaving;
        if (i < m) value /= x.reverse_pdf;
    }
    return value;
}
