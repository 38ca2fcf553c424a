// The beginning of a light subpath: a point and a direction, chosen in proportion to what is emitted as far as that is cheap.

struct EmittedRay {
    vec3 origin;    // moved off the light's own surface
    vec3 direction; // unit
    vec3 power;     // emitted radiance (or intensity, or irradiance) and cosine over the density of the choice, W
    vec3 position;  // of an area light: the point ...
    vec3 normal;    // ... and its normal
    vec3 radiance_over_pdf; // of an area light: emitted radiance over pdf_a
    float pdf_a;    // of an area light: density of the point per area, selection included; of parallel light: of the ray per area across
    float pdf_w;    // of a delta position: density of the direction over solid angle
    float d_vc;     // cosine at the light over the density of point and direction, in squares of the scene's radius; 0 of a delta light
    bool delta;     // no path from the camera runs into this light
    bool distant;   // the light is infinitely far
    uint light;     // index; NONE is the background
    vec3 absorption; // of the medium that the light shines in, 1/m
};

EmittedRay no_emission() {
    return EmittedRay(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 1.0, 1.0, 0.0, false, false, NONE, vec3(0.0));
}

// Where a light stands far off, or is infinitely far and something else stands far off, few of the directions that it shines in meet
// anything. Then most of its paths are sent towards the core, the sphere around all that does not emit (Jensen 2001 does this
// with projection maps); the others go as they would, so that none is missed.
const float TO_CORE = 0.9;
// Lights do so that see the core under less than this 1 - cos of half its angle.
const float NARROW_CORE = 0.2;

// 1 - cos of the half angle under which a sphere is seen, without cancellation for small and far ones.
float sphere_cone(float radius2, float distance2) {
    float sin2 = radius2 / distance2;
    return sin2 / (1.0 + sqrt(max(0.0, 1.0 - sin2)));
}

// 1 - cos of the half angle under which the core is seen; 0 where paths are not sent there.
float core_cone(vec3 position) {
    vec3 d = scene.core_centre - position;
    float distance2 = dot(d, d), radius2 = scene.core_radius * scene.core_radius;
    if (distance2 <= radius2) return 0.0;
    float cone = sphere_cone(radius2, distance2);
    return cone < NARROW_CORE ? cone : 0.0;
}

// Whether the line through the position meets the core, or passes it so closely that rounding might make it do so: what is sampled
// towards the core must count as that.
bool meets_core(vec3 position, vec3 direction) {
    vec3 d = scene.core_centre - position;
    float reach = scene.core_radius + 1e-6 * length(d);
    vec3 off = cross(direction, d);
    return dot(off, off) <= reach * reach;
}

// The density over solid angle with which a light subpath leaves a position, where `pdf_w` is that of going anywhere.
float emission_pdf(vec3 position, vec3 direction, float pdf_w) {
    float cone = core_cone(position);
    if (cone == 0.0) return pdf_w;
    bool inside = dot(scene.core_centre - position, direction) > 0.0 && meets_core(position, direction);
    return (1.0 - TO_CORE) * pdf_w + (inside ? TO_CORE / (2.0 * PI * cone) : 0.0);
}

// Of an area light, whose normal makes this cosine with the direction.
float surface_emission_pdf(vec3 position, vec3 direction, float cosine) { return emission_pdf(position, direction, cosine * INV_PI); }

// The axis of the core's cone and a direction in it; false where the direction is to be chosen otherwise, with what is left of u.x.
bool sample_core(vec3 position, inout vec2 u, out vec3 direction) {
    float cone = core_cone(position);
    direction = vec3(0.0);
    if (cone == 0.0) return false;
    if (u.x >= TO_CORE) {
        u.x = (u.x - TO_CORE) / (1.0 - TO_CORE);
        return false;
    }
    float one_minus_cos = cone * u.x / TO_CORE;
    float sine = sqrt(one_minus_cos * (2.0 - one_minus_cos));
    float phi = 2.0 * PI * u.y;
    direction = to_world(basis_from_normal(normalize(scene.core_centre - position)), vec3(sine * cos(phi), sine * sin(phi), 1.0 - one_minus_cos));
    return true;
}

// A point of an area light, with a direction towards the core or by the cosine.
EmittedRay surface_emit(Light light, vec3 position, float margin, vec3 normal, float area, vec2 v) {
    EmittedRay e = no_emission();
    if (!sample_core(position, v, e.direction)) e.direction = to_world(basis_from_normal(normal), sample_cosine_hemisphere(v));
    e.position = position;
    e.normal = normal;
    e.pdf_a = light.emission_probability / area;
    e.radiance_over_pdf = light.radiance / e.pdf_a;
    e.origin = offset_origin(position, margin, normal, e.direction);
    float cosine = dot(e.direction, normal);
    if (cosine <= 0.0) return e; // towards the core, but behind the light
    float cosine_over_pdf = cosine / surface_emission_pdf(position, e.direction, cosine);
    e.power = e.radiance_over_pdf * cosine_over_pdf;
    e.d_vc = cosine_over_pdf / (e.pdf_a * scene.radius * scene.radius);
    return e;
}

// Lights that are infinitely far shine through a disk across their direction: that of the core, or one that hides the scene.
bool small_core() { return scene.core_radius < 0.5 * scene.radius; }

// Density of such rays per area across.
float disk_pdf(vec3 position, vec3 direction) {
    float anywhere = INV_PI / (scene.radius * scene.radius);
    if (!small_core()) return anywhere;
    float there = meets_core(position, direction) ? INV_PI / (scene.core_radius * scene.core_radius) : 0.0;
    return mix(anywhere, there, TO_CORE);
}

vec3 disk_origin(vec3 direction, vec2 u) {
    float radius = scene.radius;
    vec3 centre = scene.centre;
    if (small_core()) {
        if (u.x < TO_CORE) {
            u.x /= TO_CORE;
            radius = scene.core_radius;
            centre = scene.core_centre;
        } else {
            u.x = (u.x - TO_CORE) / (1.0 - TO_CORE);
        }
    }
    // From outside of the scene, wherever the core lies in it.
    float back = scene.radius + dot(direction, centre - scene.centre);
    return centre + to_world(basis_from_normal(direction), vec3(radius * sample_disk(u), -back));
}
