// What the camera sees of surfaces, apart from how light is transported: the layers of docs/aovs.md. Samples stand where those of the image
// stand, with its places under the pixel filter and on the lens; the host runs this kernel once the image is there.
#version 460
#define SPLITS_LOBES true
#include "core/prelude.glsl"
#include "trace/trace.glsl"
#include "transport/emission.glsl"
#include "materials/albedo.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AovTables { AovTable at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer AovPixels { AovPixel at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Numbers { uint at[]; };

// Mirrors and smooth glass that a path goes on from, at most: between two mirrors it would have no end.
const uint MOST_SPECULAR = 32u;

// Whether a surface shows what lies elsewhere rather than itself: all its lobes are deltas or narrow. A mixture has broad ones if they return or
// let through anything of the directions in which all of them do, if any.
bool is_specular(Bsdf b, vec3 wo) {
    if (!bsdf_has_broad(b)) return true;
    if (!SPLITS || !IS_MIXTURE(b)) return false;
    Bsdf broad = broad_lobes(b);
    bool shows = false;
    for (uint turn = 0u; turn < turns(2u); turn++) shows = shows || bsdf_eval(broad, wo, turn == 0u ? vec3(-wo.xy, wo.z) : -wo) != vec3(0.0);
    return !shows;
}

layout(local_size_x = WORKGROUP) in;

void main() {
    if (gl_GlobalInvocationID.x >= frame.slot_count) return;
    Pixel pixel = pixel_open(frame.first_slot + gl_GlobalInvocationID.x);
    if (!pixel.inside) return;
    AovTable table = AovTables(frame.technique).at[0];
    AovPixel sums = AovPixels(table.pixels).at[pixel.index];
    uint rays = 0u;
    for (; pixel_has_sample(pixel); pixel.sample_index += 1u) {
        // 1. The ray of the image's sample.
        Sampler random;
        vec2 on_lens;
        vec2 offset = sample_offset(pixel, random, on_lens);
        Path path = path_from_camera(camera_ray(vec2(pixel.xy) + 0.5 + offset, on_lens), random);

        // 2. The first surface, or the first one behind mirrors and smooth glass.
        Vertex v;
        Bsdf b;
        vec3 emission = vec3(0.0);
        float depth = 0.0;
        bool found, has_bsdf, goes_on;
        do {
            found = path_arrive(path, v, rays);
            has_bsdf = found && v.material != NONE;
            goes_on = false;
            if (found) {
                emission += path.throughput * vertex_emission(v, path.ray);
                depth += distance(path.from.position, v.at.position);
            } else if (HAS_BACKGROUND) {
                emission += background_contribution(path);
            }
            if (has_bsdf) {
                b = vertex_material(v, path.ray, path.random);
                if (table.through_specular != 0u && path.depth < MOST_SPECULAR && is_specular(b, v.wo)) {
                    BsdfSample s = vertex_sample(v, b, path.ray, next4(path.random).xyz);
                    goes_on = s.weight != vec3(0.0);
                    if (goes_on) path_scatter(path, v, b, s);
                }
            }
        } while (goes_on);

        // 3. What it is. Radiance in a medium of index eta is 1 / eta^2 of that outside, which is not the colour of anything.
        float w = pixel.filter_weight;
        sums.emission += w * emission;
        if (!found) continue;
        sums.coverage += w;
        if (has_bsdf) sums.albedo += w * bsdf_albedo(b, v.wo) * path.throughput * (path.eta * path.eta);
        sums.normal += w * v.basis.normal;
        sums.geometric_normal += w * v.at.normal;
        sums.position += w * v.at.position;
        sums.depth += w * depth;
        sums.uv += w * v.at.uv;
        float nearness = 1.0 / (1e-6 + dot(offset, offset));
        if (nearness > sums.nearness) {
            sums.nearness = nearness;
            sums.material_id = v.material == NONE ? 0u : v.material + 1u;
            sums.object_id = Numbers(table.objects).at[v.hit.instance] + Numbers(table.shapes).at[v.hit.primitive] + 1u;
        }
    }
    AovPixels(table.pixels).at[pixel.index] = sums;
    count_rays(rays);
}
