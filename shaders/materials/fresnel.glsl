// Fresnel reflectance of unpolarised light.

// Dielectric whose far side has eta times the index of the near side, given the cosines of incidence and refraction
// (Born and Wolf, Principles of Optics, section 1.5.2). The same seen from either side.
float fresnel_refracting(float cos_i, float cos_t, float eta) {
    float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

// What is not reflected, without the cancellation of 1 - reflectance towards grazing angles.
float fresnel_transmittance(float cos_i, float cos_t, float eta) {
    float parallel = eta * cos_i + cos_t;
    float perpendicular = cos_i + eta * cos_t;
    return 2.0 * eta * cos_i * cos_t * (1.0 / (parallel * parallel) + 1.0 / (perpendicular * perpendicular));
}

// Its reflectance given the cosine of incidence alone; also finds that of refraction, which is 0 under total internal reflection.
float fresnel_dielectric(float cos_i, float eta, out float cos_t) {
    float sin2_t = max(0.0, 1.0 - cos_i * cos_i) / (eta * eta);
    cos_t = sqrt(max(0.0, 1.0 - sin2_t));
    return sin2_t >= 1.0 ? 1.0 : fresnel_refracting(cos_i, cos_t, eta);
}

// Conductor of complex relative index eta + i k, per colour channel.
vec3 fresnel_conductor(float cos_i, vec3 eta, vec3 k) {
    float cos2 = cos_i * cos_i;
    float sin2 = max(0.0, 1.0 - cos2);
    vec3 eta2 = eta * eta;
    vec3 k2 = k * k;
    vec3 t0 = eta2 - k2 - sin2;
    vec3 a2_plus_b2 = sqrt(t0 * t0 + 4.0 * eta2 * k2);
    vec3 a = sqrt(max(vec3(0.0), 0.5 * (a2_plus_b2 + t0)));
    vec3 t1 = a2_plus_b2 + cos2;
    vec3 t2 = 2.0 * cos_i * a;
    vec3 perpendicular = (t1 - t2) / (t1 + t2);
    vec3 t3 = cos2 * a2_plus_b2 + sin2 * sin2;
    vec3 t4 = t2 * sin2;
    vec3 parallel = perpendicular * (t3 - t4) / (t3 + t4);
    return 0.5 * (parallel + perpendicular);
}
