// Evaluates and samples BSDFs at the directions that the host gives.
#version 460
#include "core/prelude.glsl"
#include "kernels/probe.glsl"
#include "materials/bsdf.glsl"

layout(local_size_x = WORKGROUP) in;

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer BsdfQueries { BsdfQuery at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer BsdfAnswers { BsdfAnswer at[]; };

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= frame.slot_count) return;
    BsdfQuery q = BsdfQueries(PROBE_INPUT).at[index];
    Sampler random = Sampler(index, 0u, 0u, frame.seed);
    Bsdf b = bsdf_at(q.material, place_at(vec2(0.0)), 0.0, vec4(1.0), random);
    BsdfSample s = bsdf_sample(b, q.wo, q.u);
    BsdfAnswers(PROBE_OUTPUT).at[index] =
        BsdfAnswer(bsdf_eval(b, q.wo, q.wi), bsdf_pdf(b, q.wo, q.wi), s.wi, s.weight, s.pdf_w, bsdf_eval(b, q.wo, s.wi),
                   bsdf_pdf(b, q.wo, s.wi), s.delta ? 1u : 0u);
}
