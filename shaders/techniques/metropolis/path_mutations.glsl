// Mutations of paths (Veach and Guibas 1997): what a chain proposes to go to from its current path, and how likely it goes.
//
//     large step            an independent path: bidirectional, of all vertices, or from the camera until it meets a light
//     bidirectional         some vertices in a row are replaced by as many new ones, one or two more, or one or two fewer
//     from the camera       the place in the image moves a little, and the path follows it as far as its second vertex in a row that
//                           scatters: a lens perturbation, or where lobes are delta in between, a multi-chain perturbation
//     towards the camera    the direction in which light leaves the last vertex before a chain of delta lobes moves a little, and the path
//                           follows it to the first vertex that the camera sees: a caustic perturbation
//
// Each makes vertices from the camera first, then from the light, and joins them by a segment. A proposal whose lobes are of other kinds
// than the perturbation's own is none: the way back would be another one.
#include "techniques/metropolis/path_value.glsl"

const uint INDEPENDENT = 0u;
const uint BIDIRECTIONAL = 1u;
const uint FROM_CAMERA = 2u;
const uint TOWARDS_CAMERA = 3u;

// Perturbations: from these to those angles and distances, with equal density of their logarithm (Veach 1997, section 11.4.2). Of places in the
// image they are pixels, up to a circle of one twentieth of it.
const float SHORTEST_MOVE = 0.1;
const float LARGEST_SHARE = 0.05;
const float SMALLEST_TURN = 1e-4;
const float LARGEST_TURN = 0.1;
// Of parallel light it is the place that moves, in radii of the scene.
const float SHORTEST_SHIFT = 1e-4;
const float LONGEST_SHIFT = 0.05;

// What a proposal is on its way to.
struct Mutation {
    Route route;
    Sampler random;    // the mutation's own numbers
    uint current;      // the other path
    uint from_segments;
    uint kind;
    uint first, last;  // vertices of the route in between are made; `last` may be k + 1
    uint from_camera;  // the last one that is made from the camera; `first` where none is
    uint at;           // vertex that was made last
    bool backwards;    // towards the camera
    bool leaves;       // `ray` leaves it already
    bool runs;         // until it meets a light
    bool ended;        // without a path
    vec2 position;     // in the image
    Ray ray;
};

vec2 on_circle(float u) { return vec2(cos(2.0 * PI * u), sin(2.0 * PI * u)); }

float between(float least, float most, float u) { return least * exp(u * log(most / least)); }

// A direction turned by a small angle; the way back is as likely.
vec3 turned(vec3 direction, vec2 u) {
    float angle = between(SMALLEST_TURN, LARGEST_TURN, u.x);
    return normalize(to_world(basis_from_normal(direction), vec3(sin(angle) * on_circle(u.y), cos(angle))));
}

// The direction in which the current path leaves vertex i.
vec3 current_direction(Mutation m, uint i, bool backwards) {
    Route c = m.route;
    c.slot = m.current;
    PathVertex x = route_vertex(c, i);
    if (!backwards) return segment_direction(x, route_vertex(c, i + 1u));
    if (i == 1u && CAMERA == CAMERA_ORTHOGRAPHIC) return -scene.camera_corner;
    return is_distant(x) ? -x.position : -segment_direction(route_vertex(c, i - 1u), x);
}

// Where a perturbation from the camera of the current path meets what is kept, as its doc says: vertex n is joined to n + 1, or is the light.
uint camera_chain(Route r) {
    for (uint n = 1u; n < r.segments; n++) {
        if (scatters_by_delta(route_vertex(r, n))) continue;
        if (n + 1u == r.segments || !scatters_by_delta(route_vertex(r, n + 1u))) return n;
    }
    return r.segments;
}

// Where one towards the camera begins; 0 where there is none.
uint caustic_chain(Route r) {
    if (r.segments < 2u || scatters_by_delta(route_vertex(r, 1u))) return 0u;
    uint m = 2u;
    while (m < r.segments && scatters_by_delta(route_vertex(r, m))) m += 1u;
    return m;
}

void copy_vertices(Mutation m, uint first, uint end, uint from) {
    for (uint i = first; i < end; i++) path_vertex(m.route.chain, m.route.slot, i).vertex = path_vertex(m.route.chain, m.current, from + i - first).vertex;
}

// The camera's vertex: a point of its lens.
void place_camera(Mutation m, vec3 position) {
    path_vertex(m.route.chain, m.route.slot, 0u).vertex = new_vertex(position, VERTEX_SURFACE);
}

// Begins to make vertices from the light: chooses its own too where all are replaced.
void begin_light(inout Mutation m) {
    m.backwards = true;
    m.leaves = false;
    m.at = m.last;
    if (m.last <= m.route.segments) return;
    m.at = m.route.segments;
    m.random.dimension = 4u;
    vec4 u = next4(m.random);
    vec4 v = next4(m.random);
    EmittedRay e = light_emit(u, v);
    PathVertex x = new_vertex(e.position, VERTEX_AREA);
    if (e.distant) x = new_vertex(-e.direction, e.delta ? VERTEX_PARALLEL : VERTEX_BACKGROUND);
    else if (e.delta) x = new_vertex(e.origin, VERTEX_POINT);
    x.index = e.light;
    if (vertex_kind(x) == VERTEX_AREA) {
        x.detail = floatBitsToUint(e.normal);
        x.own = floatBitsToUint(e.radiance_over_pdf * e.pdf_a);
        x.pdf = e.pdf_a;
        x.leaving = distance(e.origin, e.position);
        m.ended = e.radiance_over_pdf == vec3(0.0);
    }
    if (m.at > m.from_camera + 1u && e.power == vec3(0.0)) m.ended = true;
    path_vertex(m.route.chain, m.route.slot, m.at).vertex = x;
    m.ray = Ray(e.origin, e.direction, INFINITY);
    m.leaves = true;
}

// Begins the mutation: decides on it, keeps what it keeps of the current path, and starts from where vertices are made first.
void mutation_begin(inout Mutation m) {
    m.random.dimension = 0u;
    vec4 u = next4(m.random);
    vec4 v = next4(m.random);
    vec4 w = next4(m.random);
    Route r = m.route, c = m.route;
    c.slot = m.current;
    c.segments = m.from_segments;
    uint k = m.from_segments;
    m.ended = false;
    m.backwards = false;
    m.leaves = true;
    uint caustic = 0u;
    if (m.kind != INDEPENDENT) {
        caustic = caustic_chain(c);
        m.kind = u.x < 1.0 / 3.0 ? BIDIRECTIONAL : caustic > 0u && u.x < 2.0 / 3.0 ? TOWARDS_CAMERA : FROM_CAMERA;
    }
    if (m.kind == INDEPENDENT) {
        m.first = 0u;
        m.last = r.segments + 1u;
    } else if (m.kind == BIDIRECTIONAL) {
        // As many are replaced by as many as the other way round.
        uint choice = min(uint(u.y * 9.0), 8u);
        uint fewer = choice / 3u, more = choice % 3u;
        m.first = min(uint(u.z * float(k + 1u)), k);
        uint after = m.first + fewer + 1u; // the first one that is kept of the current path
        m.last = m.first + more + 1u;
        r.segments = k + more - fewer;
        m.ended = after > k + 1u || after == k || fewer + more == 0u || r.segments == 0u || r.segments > most_segments();
        m.ended = m.ended || m.first > 0u && scatters_by_delta(route_vertex(c, m.first)) || after < k && scatters_by_delta(route_vertex(c, after));
        m.ended = m.ended || m.last > r.segments && more == 0u || m.first == k;
        if (m.ended) return;
        m.route = r;
        if (m.first > 0u) copy_vertices(m, 0u, m.first + 1u, 0u);
        if (after <= k) copy_vertices(m, m.last, r.segments + 1u, after);
    } else if (m.kind == FROM_CAMERA) {
        uint n = camera_chain(c);
        m.first = 0u;
        m.last = n + 1u;
        copy_vertices(m, 0u, 1u, 0u);
        if (n < k) copy_vertices(m, n + 1u, k + 1u, n + 1u);
        float longest = sqrt(LARGEST_SHARE * INV_PI * scene.width * scene.height);
        m.position += between(SHORTEST_MOVE, max(longest, 2.0 * SHORTEST_MOVE), u.y) * on_circle(u.z);
        m.ended = !inside_image(m.position);
    } else {
        m.first = 0u;
        m.last = caustic;
        copy_vertices(m, 0u, 1u, 0u);
        copy_vertices(m, caustic, k + 1u, caustic);
    }
    r.kept_before = m.first;
    r.kept_after = m.last;
    m.route = r;
    if (m.ended) return;

    uint made = m.last - m.first - 1u;
    m.from_camera = m.first;
    if (m.kind <= BIDIRECTIONAL) m.from_camera += min(uint(v.x * float(made + 1u)), made);
    if (m.kind == FROM_CAMERA || m.runs) m.from_camera = m.last - 1u;
    m.route.joined = m.from_camera == r.segments ? NONE : m.from_camera;
    m.at = m.first;
    if (m.kind == TOWARDS_CAMERA) {
        m.backwards = true;
        m.at = caustic;
        PathVertex x = route_vertex(m.route, caustic);
        vec3 direction = current_direction(m, caustic, true);
        if (is_distant(x)) {
            // From outside of the scene.
            vec3 through = route_vertex(c, caustic - 1u).position;
            vec2 shift = scene.radius * between(SHORTEST_SHIFT, LONGEST_SHIFT, u.y) * on_circle(u.z);
            float back = 2.0 * scene.radius + dot(direction, through - scene.centre);
            m.ray = Ray(through - back * direction + to_world(basis_from_normal(direction), vec3(shift, 0.0)), direction, INFINITY);
        } else {
            direction = turned(direction, u.yz);
            vec3 origin = x.position;
            if (vertex_kind(x) == VERTEX_AREA) origin = offset_origin(x.position, x.leaving, light_normal(x), direction);
            if (vertex_kind(x) == VERTEX_SURFACE) {
                Interaction at = interaction_at(Ray(x.position, -direction, INFINITY), vertex_hit(x));
                origin = offset_origin(at.position, at.margin, at.normal, direction);
            }
            m.ray = Ray(origin, direction, INFINITY);
        }
        return;
    }
    if (m.first > 0u) {
        m.leaves = false;
        if (m.from_camera == m.first) begin_light(m);
        return;
    }
    vec3 shift = m.kind == FROM_CAMERA ? route_vertex(m.route, 0u).position - scene.camera_origin : lens_shift(w.xy);
    if (m.kind != FROM_CAMERA) m.position = image_place(v.zw);
    m.ray = camera_ray_from(shift, m.position);
    place_camera(m, m.ray.origin);
    if (m.from_camera == 0u) begin_light(m);
}

// The direction in which the path leaves the vertex that was made last; false where it ends there.
bool mutation_scatter(inout Mutation m) {
    PathVertex x = route_vertex(m.route, m.at);
    vec3 arrived;
    if (m.backwards) {
        PathVertex next = route_vertex(m.route, m.at + 1u);
        arrived = -segment_direction(x, next);
    } else {
        arrived = m.at == 1u && CAMERA == CAMERA_ORTHOGRAPHIC ? scene.camera_corner : segment_direction(route_vertex(m.route, m.at - 1u), x);
    }
    Ray ray = Ray(x.position, arrived, INFINITY);
    Vertex v = vertex_at(ray, vertex_hit(x));
    if (v.material == NONE) return false;
    bool perturbs = m.kind >= FROM_CAMERA;
    vec3 direction;
    if (perturbs && !scatters_by_delta(x)) {
        m.random.dimension = 8u + m.at;
        direction = turned(current_direction(m, m.at, m.backwards), next4(m.random).xy);
    } else {
        Sampler random = vertex_random(x, 0u);
        v.from_light = m.backwards;
        Bsdf b = vertex_material(v, ray, random);
        random = vertex_random(x, SCATTER_NUMBERS);
        BsdfSample s = vertex_sample(v, b, ray, next4(random).xyz);
        if (s.weight == vec3(0.0)) return false;
        // Between what is kept and what is made, vertices scatter by other lobes.
        if (perturbs && !s.delta || s.delta && (m.at == m.first || m.at == m.last)) return false;
        if (s.delta != scatters_by_delta(x)) {
            x.kind ^= VERTEX_DELTA;
            path_vertex(m.route.chain, m.route.slot, m.at).vertex = x;
        }
        direction = vertex_to_world(v, s.wi);
    }
    m.ray = vertex_ray(v, direction);
    return true;
}

// Makes the next vertex; false where all are made, or none can be.
bool mutation_extend(inout Mutation m, inout uint rays) {
    uint target = m.backwards ? m.from_camera + 1u : m.from_camera;
    if (m.ended) return false;
    if (m.at != target) {
        if (m.runs && m.at >= RUN_SURE) {
            m.random.dimension = 8u + m.at;
            if (next4(m.random).x >= RUN_ON) {
                m.ended = true;
                return false;
            }
        }
        if (!m.leaves && !mutation_scatter(m)) {
            m.ended = true;
            return false;
        }
        m.leaves = false;
        uint i = m.backwards ? m.at - 1u : m.at + 1u;
        PathVertex x = new_vertex(vec3(0.0), VERTEX_SURFACE);
        x.own = vertex_key(m.random, i + (m.backwards ? 512u : 0u));
        if (m.kind >= FROM_CAMERA) {
            PathVertex old = path_vertex(m.route.chain, m.current, i).vertex;
            x.kind = old.kind & VERTEX_DELTA;
            // Towards the camera, a number of the vertex's own decides to which side a mapped normal flips, and reverse_pdf has the density of that: it
            // is drawn anew, or the way back, which keeps another number, would be none.
            if (vertex_kind(old) == VERTEX_SURFACE && !(HAS_FLIPPED_NORMALS && m.backwards)) x.own = old.own;
        }
        Vertex met;
        Sampler masks = Sampler(m.random.chain, m.random.mutation, (i + (m.backwards ? 513u : 1u)) * VERTEX_NUMBERS + MASK_NUMBERS, 0u);
        if (vertex_arrive(m.ray, !m.backwards && i == 1u, met, masks, rays)) {
            x.position = met.at.position;
            x.detail = uvec3(met.hit.instance, floatBitsToUint(met.hit.uv));
            x.index = met.hit.primitive;
        } else {
            x.position = m.ray.direction;
            x.kind = VERTEX_BACKGROUND;
            if (!HAS_BACKGROUND || m.backwards || !m.runs && i != m.route.segments) {
                m.ended = true;
                return false;
            }
        }
        path_vertex(m.route.chain, m.route.slot, i).vertex = x;
        m.at = i;
        if (m.runs) {
            if (vertex_kind(x) == VERTEX_BACKGROUND || is_lamp(met)) {
                m.route.segments = m.from_camera = i;
                m.last = i + 1u;
                return false;
            }
            m.ended = i == m.route.segments;
            return !m.ended;
        }
    }
    if (m.at != target) return true;
    if (m.backwards || m.from_camera + 1u >= m.last) return false;
    if (m.kind == TOWARDS_CAMERA) return false;
    begin_light(m);
    return !m.ended && m.at != m.from_camera + 1u;
}

// Begins a proposal for the chain, or a bootstrap sample in its room.
void mutation_open(Proposal p, uint room, out Mutation m) {
    bool begun = p.from.known != NONE && !p.bootstrap;
    m.random = p.random;
    m.random.known = 0u;
    m.current = begun ? p.from.known : 1u;
    m.from_segments = p.from.kind + 1u;
    m.kind = p.large ? INDEPENDENT : BIDIRECTIONAL;
    m.runs = p.large && p.kind == most_segments();
    m.position = p.from.position;
    m.route = Route(room, 1u - m.current, p.large ? min(p.kind + 1u, most_segments()) : m.from_segments, 0u, 0u, NONE, false);
    mutation_begin(m);
}

// Where the camera sees the path's first vertex that was not made from there; false where it does not.
bool mutation_join_camera(inout Mutation m) {
    if (m.route.joined != 0u) return true;
    PathVertex x = route_vertex(m.route, 1u);
    if (is_distant(x) || is_alone(x)) return false;
    CameraView view = camera_view_from(route_vertex(m.route, 0u).position - scene.camera_origin, x.position);
    m.position = view.position;
    if (!view.visible || !inside_image(view.position)) return false;
    place_camera(m, view.target);
    return true;
}

// Contribution of the path over the density of being proposed by a mutation that keeps some of it, in all that varies between it and the one at the
// other end.
float mutation_quotient(Mutation m, Route r, float value, uint last) {
    if (m.kind == FROM_CAMERA) return camera_quotient(r, value, last - 1u);
    if (m.kind == TOWARDS_CAMERA) return caustic_quotient(r, value, last);
    // Where to begin was one of segments + 1 of the other path; the factor is the inverse on both sides of the ratio.
    return bidirectional_quotient(r, value, m.first, last) / float(r.segments + 1u);
}

// What a proposal comes to at its end.
struct Weighed {
    float share; // one over the density at which large steps make it, over that of making it from the camera
    float ran;   // the part of that density which is of running until a light is met
    float ratio; // acceptance ratio f(y) T(y -> x) / (f(x) T(x -> y)), before target compression
};

// Follows the proposal to its next vertex; at its end, weighs it.
bool mutation_follow(inout Mutation m, Proposal p, inout Estimate e, inout Weighed w) {
    if (mutation_extend(m, e.rays)) return true;
    w = Weighed(1.0, 0.0, 0.0);
    if (m.ended || !mutation_join_camera(m)) return false;
    vec3 value = path_value(m.route, e.rays);
    float f = scalar_contribution(value);
    if (!(f > 0.0)) return false;
    path_vertex(m.route.chain, m.route.slot, 0u).vertex.nearness = f;
    contribute(e, m.route.segments, value);
    vec2 density = large_density(m.route);
    w.share = 1.0 / density.y;
    w.ran = density.x / density.y;
    if (p.from.known == NONE) return false;
    if (m.kind == INDEPENDENT) {
        w.ratio = f * w.share / p.from.contribution;
        return false;
    }
    Route current = m.route;
    current.slot = m.current;
    current.segments = m.from_segments;
    w.ratio = mutation_quotient(m, m.route, f, m.last) /
              mutation_quotient(m, current, route_vertex(current, 0u).nearness, m.last + m.from_segments - m.route.segments);
    return false;
}
