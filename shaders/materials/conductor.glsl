// A smooth metal: mirror reflection times the Fresnel reflectance of a conductor.

BsdfSample conductor_sample(Material m, vec3 wo, vec3 u) {
    vec3 weight = m.reflectance * fresnel_conductor(wo.z, m.conductor_eta, m.conductor_k);
    return bsdf_sampled(vec3(-wo.xy, wo.z), weight, 1.0, true, 1.0);
}
