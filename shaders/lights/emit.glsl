// The beginning of a light path: a point and a direction, chosen in proportion to what is emitted as far as that is cheap.

struct EmittedRay {
    vec3 origin;    // moved off the light's own surface
    vec3 direction; // unit
    vec3 power;     // emitted radiance (or intensity, or irradiance) and cosine over the density of the choice, W
    vec3 position;  // of an area light: the point ...
    vec3 normal;    // ... and its normal
    float pdf_a;    // of an area light: density of the point per area, selection included
    float pdf_w;    // of a delta position: density of the direction over solid angle
    float d_vc;     // cosine at the light over the density of point and direction, in squares of the scene's radius; 0 of a delta light
    bool delta;     // no path from the camera runs into this light
    bool distant;   // the light is infinitely far
    uint light;     // index; NONE is the background
};

EmittedRay no_emission() {
    return EmittedRay(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), vec3(0.0), vec3(0.0), 1.0, 1.0, 0.0, false, false, NONE);
}

// A point of an area light, with a direction by the cosine.
EmittedRay surface_emit(Light light, vec3 position, float margin, vec3 normal, float area, vec2 v) {
    EmittedRay e = no_emission();
    e.direction = to_world(frame_from_normal(normal), sample_cosine_hemisphere(v));
    e.origin = offset_origin(position, margin, normal, e.direction);
    e.position = position;
    e.normal = normal;
    e.pdf_a = light.emission_probability / area;
    e.power = light.radiance * (PI / e.pdf_a); // radiance cos / (pdf_a cos / pi)
    e.d_vc = PI / (e.pdf_a * scene.radius * scene.radius);
    return e;
}

// What lights that are infinitely far shine through: a disk across their direction that hides the scene.
float disk_area() { return PI * scene.radius * scene.radius; }

vec3 disk_origin(vec3 direction, vec2 u) {
    vec2 d = scene.radius * sample_disk(u);
    return scene.centre + to_world(frame_from_normal(direction), vec3(d, -scene.radius));
}
