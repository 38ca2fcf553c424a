// A background of constant radiance, sampled uniformly over the sphere of directions.

LightSample background_sample(vec2 u) {
    float pdf_w = scene.background_probability / (4.0 * PI);
    return LightSample(sample_sphere(u), vec3(0.0), scene.background / pdf_w, pdf_w, false, true);
}

vec3 background_radiance(vec3 direction) { return scene.background; }

float background_pdf(vec3 direction) { return scene.background_probability / (4.0 * PI); }
