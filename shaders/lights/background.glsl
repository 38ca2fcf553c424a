// The background: one radiance in all directions, sampled uniformly over the sphere, or an image of them in latitude and
// longitude, sampled by the luminance of its cells.

// Texture coordinates of a direction and back: u runs around the up axis (+y of the background's space) from -z towards +x,
// v down from it.
vec2 background_uv(vec3 direction) {
    vec3 d = vec3(dot(scene.background_x, direction), dot(scene.background_y, direction), dot(scene.background_z, direction));
    return sphere_place(vec3(-d.z, d.x, d.y));
}

vec3 background_direction(vec2 uv) {
    float theta = uv.y * PI, phi = uv.x * 2.0 * PI;
    vec3 d = vec3(sin(phi) * sin(theta), cos(theta), -cos(phi) * sin(theta));
    return d.x * scene.background_x + d.y * scene.background_y + d.z * scene.background_z;
}

bool has_environment() { return HAS_ENVIRONMENT && scene.background_texture != NONE; }

vec3 background_radiance(vec3 direction) {
    if (!has_environment()) return scene.background;
    return scene.background * texture_at(scene.background_texture, place_at(background_uv(direction))).rgb;
}

// Density over solid angle of a place in the image, whose cells are uniform in texture coordinates: those stretch by
// 2 pi^2 sin(theta).
float background_density(uint cell, vec2 uv) {
    return AliasTable(scene.background_table).at[cell].density / (2.0 * PI * PI * max(sin(uv.y * PI), 1e-12));
}

float background_pdf(vec3 direction) {
    if (!has_environment()) return scene.background_probability / (4.0 * PI);
    vec2 uv = background_uv(direction);
    vec2 scaled = uv * vec2(scene.background_cells);
    uvec2 cell = min(uvec2(whole(scaled.x), whole(scaled.y)), scene.background_cells - 1u);
    return scene.background_probability * background_density(cell.y * scene.background_cells.x + cell.x, uv);
}

LightSample background_sample(vec3 p, vec4 u) {
    if (!has_environment()) {
        float pdf_w = scene.background_probability / (4.0 * PI);
        vec3 wi = sample_sphere(u.zw);
        return LightSample(wi, vec3(0.0), scene.background / pdf_w, pdf_w, false, true, disk_pdf(p, wi));
    }
    uint count = scene.background_cells.x * scene.background_cells.y;
    uint cell = min(uint(u.x * float(count)), count - 1u);
    AliasEntry drawn = AliasTable(scene.background_table).at[cell];
    if (u.y >= drawn.keep) cell = drawn.alias;
    vec2 uv = (vec2(cell % scene.background_cells.x, cell / scene.background_cells.x) + u.zw) / vec2(scene.background_cells);
    vec3 wi = background_direction(uv);
    float pdf_w = scene.background_probability * background_density(cell, uv);
    return LightSample(wi, vec3(0.0), pdf_w > 0.0 ? background_radiance(wi) / pdf_w : vec3(0.0), pdf_w, false, true,
                       disk_pdf(p, wi));
}

// Light paths of the background start on a disk across the direction.
EmittedRay background_emit(vec4 u, vec4 v) {
    LightSample s = background_sample(scene.centre, u.x < scene.background_probability ? vec4(u.x / scene.background_probability, u.yzw) : u);
    EmittedRay e = no_emission();
    if (s.pdf_w <= 0.0) return e;
    e.direction = -s.wi;
    e.origin = disk_origin(e.direction, v.xy);
    e.pdf_a = disk_pdf(e.origin, e.direction);
    e.power = s.weight / e.pdf_a;
    e.d_vc = 1.0 / (s.pdf_w * e.pdf_a * scene.radius * scene.radius);
    e.distant = true;
    return e;
}
