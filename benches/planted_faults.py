#!/usr/bin/env python3
"""Do the tests find mistakes? Plants faults one at a time, runs the tests that should see each, and takes it out again.

    benches/planted_faults.py --list                  the table
    benches/planted_faults.py --check                 whether each fault still has its place
    benches/planted_faults.py --run [NAME...]         these or all, against the tests named for each; clean tree needed
    benches/planted_faults.py --run --whole           the same against all tests
    benches/planted_faults.py --run --json FILE       keeps results there, and goes on where it stopped (--fresh: from the beginning)

A fault is a short text that occurs once in its file, and what it becomes. Most are of one to ten per cent, since those are what
tests miss. Tests are named as `cargo test --test tests -- NAME` takes them, by a part of their name; those that begin with `lib:`
are the library's own. Exit status 1: a fault was not found, or is no fault (it does not compile, no such test).
"""
import argparse
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent

# Compiling is not the test's time. A change in what all shaders include compiles all of them.
BUILD_SECONDS = 1800
# All tests that the table names, once, or all there are.
CLEAN_SECONDS = 7200


class Fault(NamedTuple):
    name: str
    file: str
    text: str
    becomes: str
    meaning: str
    tests: list  # one of them is to fail; the fastest first
    origin: str = ""  # where it is documented


ACCURACY = "docs/accuracy.md: "
VERIFY = "docs/verify.md: "
RUNS = "docs/long_runs.md: "
CLUSTERS = "docs/clusters.md: "
RADIOSITY = "tests/radiosity.rs: "
NOTES = "closing notes: "

FURNACES = "analytic::furnaces"
FORMULAS = "analytic::formulas"
# The short form of all rows of `lumbre verify`.
ROWS = "verify::every_row_passes"
WEIGHTS = "strategies::weights_are_those_of_the_definition"
BSDF_DENSITY = "bsdf::bsdf_samples_follow_their_density"
BSDF_AGREES = "bsdf::bsdf_sample_eval_and_pdf_agree"
LIGHTS_FOUND = "lights::light_samples_are_what_rays_find"
IRRADIANCE = "lights::irradiance_is_that_of_the_emitters"
LAMPS = "lights::lamps_shed_what_their_formulas_say"
MITSUBA = "references::every_kind_agrees_with_mitsuba"
SPECIALISED = "references::specialisation_changes_no_bit"
DAMAGED = "checkpoint::damaged_files_are_refused"

FAULTS = [
    # Techniques
    Fault("path-implicit-roulette", "shaders/techniques/path/path_implicit.glsl",
          "path.throughput /= 1.0 - q;", "path.throughput /= 1.0 - 0.9 * q;",
          "roulette of a constant probability divides by a tenth less than it takes", [FURNACES],
          ACCURACY + "roulette without its division, constant"),
    Fault("path-roulette", "shaders/transport/path.glsl",
          "path.throughput /= survival;", "path.throughput /= mix(1.0, survival, 0.95);",
          "roulette by throughput gives back 5 % too little", [FURNACES, ROWS],
          ACCURACY + "roulette without its division, throughput"),
    Fault("path-emission-weight", "shaders/transport/emission.glsl",
          "light_pdf(path.from, path.ray, v.hit, v.at, v.surface);\n    float weight = path.delta ? 1.0 : power_heuristic(",
          "light_pdf(path.from, path.ray, v.hit, v.at, v.surface);\n    float weight = path.delta ? 1.0 : 1.05 * power_heuristic(",
          "emission that a sampled direction hits weighs 5 % too much", [FURNACES, FORMULAS],
          ACCURACY + "emission found by chance counted fully"),
    Fault("background-weight", "shaders/transport/emission.glsl",
          "background_pdf(path.ray.direction);\n    float weight = path.delta ? 1.0 : power_heuristic(",
          "background_pdf(path.ray.direction);\n    float weight = path.delta ? 1.0 : 1.05 * power_heuristic(",
          "the same of the background", ["bidirectional::every_light", MITSUBA, ROWS]),
    Fault("path-recursive-weight", "shaders/techniques/path/path_recursive.glsl",
          "handed_down * s.weight / survival;", "handed_down * s.weight / mix(1.0, survival, 0.95);",
          "calls that roulette ended are made up for by 5 % too little", ["recursion::what_calls_return"]),
    Fault("direct-emitter-weight", "shaders/techniques/path/direct.glsl",
          "SAMPLING == SAMPLING_MIS ? nee_weight(n)", "SAMPLING == SAMPLING_MIS ? 1.03 * nee_weight(n)",
          "light samples weigh 3 % too much where both are taken", [FORMULAS, "agreement::techniques_agree_on_cornell"]),
    Fault("light-importance", "shaders/transport/camera_connection.glsl",
          "c.contribution *= c.view.importance /", "c.contribution *= 1.02 * c.view.importance /",
          "connections of light subpaths to the camera are 2 % bright", [FURNACES, "agreement::techniques_agree_on_cornell"],
          NOTES + "light's importance, 2 %"),
    Fault("light-shading-eval", "shaders/transport/light_subpath.glsl",
          "(passage * abs(dot(world, v.at.normal)) / arriving)", "(passage * abs(local.z / v.wo.z))",
          "f of light's paths without the shading normal's factor", ["bidirectional::normals_and_units", ROWS],
          VERIFY + "f of light's paths without the shading normal's factor"),
    Fault("light-shading-direction", "shaders/transport/light_subpath.glsl",
          "s.eta * s.eta * geometric / shading", "s.eta * s.eta",
          "directions of light's paths without it", ["bidirectional::normals_and_units", ROWS],
          VERIFY + "directions of light's paths without it"),
    Fault("light-absorption", "shaders/lights/light.glsl",
          "e.absorption = light.absorption;", "e.absorption = 0.9 * light.absorption;",
          "light paths begin with a tenth less absorption", ["bidirectional::lights_within_what_absorbs"],
          NOTES + "absorption -10 %"),
    Fault("bdpt-connection", "shaders/techniques/bidirectional/connect.glsl",
          "light_vertex_eval(w, far, arrived, other, -towards) / distance2;", "light_vertex_eval(w, far, arrived, other, -towards) * 0.97 / distance2;",
          "connections of inner vertices are 3 % dark", [FURNACES, "strategies::in_the_cornell_box"]),
    Fault("vcm-merge-area", "shaders/techniques/bidirectional/camera_pass.glsl",
          "float area = PI * merge_radius()", "float area = 1.02 * PI * merge_radius()",
          "merges divide by 2 % too much area", ["merging::furnace", FORMULAS],
          NOTES + "merge's area, 2 %"),
    Fault("merge-radius-law", "src/techniques/merging/radius.rs",
          "factor *= (k + self.alpha) / (k + 1.0);", "factor *= ((k + self.alpha) / (k + 1.0)).sqrt();",
          "the radius of merges shrinks half as fast", ["lib:techniques::merging::radius", "merging::the_error_vanishes"]),
    Fault("photon-density", "shaders/techniques/photon/camera_pass.glsl",
          "path.throughput / (PI * merge_radius()", "path.throughput / (1.02 * PI * merge_radius()",
          "photons are spread over 2 % too much area", ["merging::furnace", FORMULAS],
          NOTES + "photon's density, 2 %"),
    Fault("grid-radius", "shaders/core/grid.glsl",
          "dot(d, d) < merge_radius()", "dot(d, d) < 0.97 * merge_radius()",
          "what is found lies within 3 % less area than it is divided by", ["merging::furnace"]),
    Fault("kept-share", "shaders/transport/light_subpath.glsl",
          "max(float(met) / float(light_subpaths.light_vertices), 1.0)", "max(float(met - 1u) / float(light_subpaths.light_vertices), 1.0)",
          "vertices that are kept do not stand for the last one that is not", ["merging::furnace"]),
    Fault("mlt-visits", "shaders/techniques/metropolis/chains.glsl",
          "weight *= probability * compression(f)", "weight *= 1.02 * probability * compression(f)",
          "visits of chains are 2 % bright", ["metropolis::every_length", ROWS],
          VERIFY + "visits of chains 2 % bright"),
    Fault("mlt-primary-lowest-bits", "shaders/techniques/metropolis/numbers.glsl",
          "greaterThanEqual(bits, uvec4(0x80000000u))", "notEqual(bits & 1u, uvec4(0u))",
          "the way of a perturbation comes from bits that are correlated from one mutation to the next", ["metropolis::every_length", "metropolis::the_canon"],
          NOTES + "the lowest bits of pcg4d, lamps 3 to 4 % too bright"),
    Fault("mlt-multiplexed-strategies", "shaders/techniques/metropolis/multiplexed.glsl",
          "w.by_camera ? 1.0 : float(strategies(", "w.by_camera ? 1.0 : 1.1 * float(strategies(",
          "strategies from both sides stand for a tenth too many", ["metropolis::the_canon", "metropolis::layers_add_up"],
          "docs/metropolis.md: strategies that are counted wrongly"),
    Fault("mlt-paths-running", "shaders/techniques/metropolis/path_value.glsl",
          "pow(RUN_ON, float", "pow(0.9 * RUN_ON, float",
          "the density of paths that run until they meet a light is low by a tenth for each segment", [ROWS],
          VERIFY + "their roulette left out of the density"),
    Fault("mlt-paths-refraction", "shaders/techniques/metropolis/path_value.glsl",
          "abs(v.wo.z / local.z) / (s.eta * s.eta);", "abs(v.wo.z / local.z);",
          "refraction leaves solid angles as they are", [ROWS],
          VERIFY + "refraction leaves solid angles as they are (no eta^2)"),
    Fault("mlt-paths-cosine", "shaders/techniques/metropolis/path_value.glsl",
          "next.reverse_pdf * x.leaving * next.nearness", "next.reverse_pdf * x.arriving * next.nearness",
          "the wrong one of two cosines in densities from the light", [ROWS],
          VERIFY + "the wrong one of two cosines in densities from the light"),
    Fault("mlt-paths-places", "shaders/techniques/metropolis/path_mutations.glsl",
          "m.first, last) / float(r.segments + 1u)", "m.first, last) / float(r.segments + 2u)",
          "one place too many to begin a bidirectional mutation at", [ROWS],
          VERIFY + "the number of places to begin at left out"),
    Fault("mlt-acceptance", "shaders/techniques/metropolis/chains.glsl",
          "bool accepted = u.y < acceptance;", "bool accepted = u.y < sqrt(acceptance);",
          "mutations are accepted by the root of the ratio", [ROWS, "metropolis::every_length"],
          VERIFY + "accepted by the root of the ratio"),
    Fault("mlt-bound", "shaders/techniques/metropolis/chains.glsl",
          "ratio *= compression(c.contribution) / compression(proposed);", "",
          "the bound of the target left out of the ratio", [ROWS],
          VERIFY + "the bound of the target left out of the ratio"),
    Fault("mlt-brightness-error", "src/techniques/metropolis/chains.rs",
          "variance: squares / (count * count)", "variance: 0.5 * squares / (count * count)",
          "half the variance is stated of the image's brightness", ["metropolis::brightness_states_its_error"],
          NOTES + "brightness's variance halved"),
    Fault("radiosity-albedo", "shaders/techniques/radiosity/passes.glsl",
          "clamp(sum / float(frame.sample_count)", "clamp(1.0001 * sum / float(frame.sample_count)",
          "albedos of patches are 1e-4 too large", ["radiosity::furnaces_are_exact"],
          RADIOSITY + "albedos that are 1e-4 too large"),
    Fault("radiosity-gather-weight", "shaders/techniques/radiosity/gather.glsl",
          "g.direct += PI * weight * emission;", "g.direct += PI * mix(1.0, weight, 0.9) * emission;",
          "a tenth of the emission that rays find is counted fully", ["radiosity::cornell_has_the_energy_of_path"],
          RADIOSITY + "without the weight of emission that rays find"),
    Fault("radiosity-shoot-count", "shaders/techniques/radiosity/shoot.glsl",
          "* (share / expected)", "* (share / float(count))",
          "what a ray carries is divided by the number of rays instead of its mean", ["radiosity::cornell_has_the_energy_of_path"],
          RADIOSITY + "divided by the number of rays instead of its mean"),
    Fault("whitted-refraction", "shaders/techniques/path/whitted.glsl",
          "first.wi != second.wi ? second.pdf_w", "first.wi != second.wi ? 1.03 * second.pdf_w",
          "the second branch has 3 % too much", ["whitted::chains_of_mirrors"],
          ACCURACY + "3 % too much refraction"),

    # Weights of strategies
    Fault("mis-scatter-cosine", "shaders/techniques/bidirectional/mis.glsl",
          "float there = heuristic(cosine / pdf_w);", "float there = heuristic(1.001 * cosine / pdf_w);",
          "cosines of weights are 0.1 % off", [WEIGHTS],
          VERIFY + "cosines of weights 0.1 % off"),
    Fault("mis-lens", "shaders/techniques/bidirectional/mis.glsl",
          "heuristic(lens_a * importance /", "heuristic(1.01 * lens_a * importance /",
          "1 % more importance in the weight of t = 0", [WEIGHTS],
          VERIFY + "1 % more importance in the weight of t = 0"),
    Fault("mis-refraction", "shaders/techniques/bidirectional/mis.glsl",
          "s.pdf_w * abs(v.wo.z / s.wi.z) / (s.eta * s.eta)", "s.pdf_w * abs(v.wo.z / s.wi.z)",
          "refraction is taken to leave solid angles as they are", [WEIGHTS],
          VERIFY + "refraction taken to leave solid angles as they are"),
    Fault("mis-implicit", "shaders/techniques/bidirectional/mis.glsl",
          "if_connected(m.d_vcm) * heuristic(choice_a)", "if_connected(m.d_vcm) * heuristic(1.05 * choice_a)",
          "running into a light is weighed against 5 % too many light samples", [FURNACES, WEIGHTS]),
    Fault("mis-merge", "shaders/techniques/bidirectional/mis.glsl",
          "(if_connected(m.d_vcm) + m.d_vc * heuristic(reverse_pdf_w)) / eta_vcm(opacity)",
          "(if_connected(m.d_vcm) + 1.02 * m.d_vc * heuristic(reverse_pdf_w)) / eta_vcm(opacity)",
          "merges are weighed against 2 % too much of what lies behind them", [WEIGHTS]),

    # Instant radiosity
    Fault("vpl-compensation", "shaders/techniques/vpl/camera_pass.glsl",
          "1.0 - clamped_share(path.from.normal", "1.0 - 0.9 * clamped_share(path.from.normal",
          "paths that go on make up for a tenth too much", ["vpl::diffuse_walls"]),
    Fault("vpl-subset", "shaders/techniques/vpl/camera_pass.glsl",
          "(share / float(chosen))", "(1.03 * share / float(chosen))",
          "virtual point lights are 3 % bright", ["vpl::diffuse_walls", "vpl::lengths"]),
    Fault("vpl-length", "shaders/techniques/vpl/light_pass.glsl",
          "MAX_DEPTH - y.segments < 3u", "MAX_DEPTH - y.segments < 4u",
          "light subpaths end a segment early", ["vpl::lengths"]),

    # Materials
    Fault("diffuse-density", "shaders/materials/diffuse.glsl",
          "vec3 wi) { return INV_PI * max", "vec3 wi) { return 0.95 * INV_PI * max",
          "the density of diffuse directions is 5 % low", [BSDF_AGREES, BSDF_DENSITY],
          ACCURACY + "cosine density constant"),
    Fault("conductor-dark", "shaders/materials/conductor.glsl",
          "vec3 weight = m.reflectance *", "vec3 weight = 0.9999 * m.reflectance *",
          "a smooth metal is 0.01 % dark", [ROWS],
          VERIFY + "a smooth metal 0.01 % dark"),
    Fault("rough-conductor-bright", "shaders/materials/rough_conductor.glsl",
          "valid ? f * microfacet_weight", "valid ? 1.01 * f * microfacet_weight",
          "samples of rough metal are 1 % bright", ["bsdf::bsdf_energy_is_conserved", ROWS],
          VERIFY + "rough metal 1 % too bright"),
    Fault("rough-conductor-reciprocity", "shaders/materials/rough_conductor.glsl",
          "microfacet_g2(m, wo, wi) / (4.0 * wo.z)", "microfacet_g2(m, wo, wi) * (1.0 + 0.001 * wo.z) / (4.0 * wo.z)",
          "rough metal has 0.1 % of the outgoing cosine added", ["bsdf::bsdfs_are_reciprocal"],
          VERIFY + "0.1 % of the outgoing cosine added"),
    Fault("dielectric-dark", "shaders/materials/dielectric.glsl",
          "m.transmittance / (eta * eta)", "0.999 * m.transmittance / (eta * eta)",
          "smooth glass is 0.1 % dark", [ROWS],
          VERIFY + "smooth glass 0.1 % dark"),
    Fault("thin-dielectric-series", "shaders/materials/thin_dielectric.glsl",
          "2.0 * r / (1.0 + r)", "2.0 * r / (1.0 + 0.5 * r)",
          "a thin sheet reflects 2 % more than a slab does", ["bsdf::a_thin_sheet"]),
    Fault("rough-dielectric-dark", "shaders/materials/rough_dielectric.glsl",
          "m.transmittance * (f.passed * visible", "m.transmittance * (0.97 * f.passed * visible",
          "rough glass passes 3 % less to light samples", [BSDF_AGREES, BSDF_DENSITY]),
    Fault("plastic-base", "shaders/materials/plastic.glsl",
          "/ ((1.0 - thrown_back) *", "/ (1.05 * (1.0 - thrown_back) *",
          "the base under a coating is 5 % dark", [MITSUBA]),
    Fault("rough-plastic-density", "shaders/materials/rough_plastic.glsl",
          "pdf += (1.0 - coating) * wi.z", "pdf += (0.97 - coating) * wi.z",
          "3 % of the base's directions are missing from the density of rough plastic", [BSDF_DENSITY]),
    Fault("principled-coat", "shaders/materials/principled.glsl",
          "value += 0.25 * p.clearcoat", "value += 0.26 * p.clearcoat",
          "the clear coat is 4 % bright", ["bsdf::principled_is_the_published_model"]),
    Fault("layered-density", "shaders/materials/layered.glsl",
          "pdf = lobes.x * abs(wi.z)", "pdf = 0.95 * lobes.x * abs(wi.z)",
          "the density of diffuse directions of layers is 5 % low", [BSDF_DENSITY]),
    Fault("compensation-mean", "shaders/materials/compensation.glsl",
          "return max(missing_entry(missing_row", "return max(1.05 * missing_entry(missing_row",
          "the mean of the missing energy is 5 % too large", ["analytic::compensated_spheres", "bsdf::compensated_materials_lose_nothing"],
          ACCURACY + "the mean of the missing energy 5 % too large"),
    Fault("compensation-series", "shaders/materials/compensation.glsl",
          "return f * f * (1.0 - mean) / (1.0 - f * mean);", "return f * f * (1.0 - mean);",
          "light within a metal's microfacets escapes after two reflections or never", ["bsdf::compensated_metals_follow_the_series"],
          ACCURACY + "a compensated metal's series without its second reflection"),
    Fault("blend-share", "shaders/materials/bsdf.glsl",
          "next4(random).x < weight ?", "next4(random).x < 0.9 * weight ?",
          "blends take their second material a tenth too seldom", [MITSUBA]),
    Fault("texture-reflectance", "src/layout/properties.rs",
          'PROPERTY_REFLECTANCE linear "b.m.reflectance *= value.rgb;";', 'PROPERTY_REFLECTANCE linear "b.m.reflectance *= 0.97 * value.rgb;";',
          "textured reflectances are 3 % dark", ["gltf::textures_are_upright"]),
    Fault("ggx-density", "shaders/materials/microfacet.glsl",
          "return ggx_g1(wo, alpha) * max", "return 1.03 * ggx_g1(wo, alpha) * max",
          "the density of GGX is 3 % high", [BSDF_DENSITY, ROWS],
          ACCURACY + "GGX density 3 % too large"),
    Fault("ggx-masking", "shaders/materials/microfacet.glsl",
          "1.0 / (1.0 + lambda_o + lambda_i) :", "1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i)) :",
          "masking without height correlation", ["bsdf::ggx_albedo", ROWS],
          VERIFY + "masking without height correlation"),
    Fault("fresnel-low", "shaders/materials/fresnel.glsl",
          "return 0.5 * (parallel * parallel +", "return 0.485 * (parallel * parallel +",
          "Fresnel reflectance of dielectrics is 3 % low", ["bsdf::smooth_glass_follows", FORMULAS],
          VERIFY + "Fresnel 3 % low"),
    Fault("medium-absorption", "shaders/transport/path.glsl",
          "path.throughput *= exp(-path.absorption *", "path.throughput *= exp(-0.98 * path.absorption *",
          "media absorb 2 % too little", ["gltf::glass_absorbs"]),
    Fault("normal-scale", "shaders/transport/shading_basis.glsl",
          "n.xy *= scale;", "n.xy *= 1.1 * scale;",
          "normal maps tilt a tenth too far", ["gltf::normal_maps_tilt"]),

    # Lights
    Fault("triangle-light-density", "shaders/lights/triangle.glsl",
          "float pdf_w = light.probability *", "float pdf_w = 0.98 * light.probability *",
          "triangle lights are 2 % bright", [LIGHTS_FOUND, IRRADIANCE, FORMULAS],
          ACCURACY + "triangle lights 2 % too bright"),
    Fault("solid-angle", "shaders/lights/spherical_triangle.glsl",
          "2.0 * angle_of(volume, sum)", "1.98 * angle_of(volume, sum)",
          "solid angles of triangles are 1 % small", [IRRADIANCE, FORMULAS]),
    Fault("sphere-light-cone", "shaders/lights/sphere.glsl",
          "float cone = sphere_cone(", "float cone = 1.01 * sphere_cone(",
          "a sphere light's cone is 1 % wide", [LIGHTS_FOUND, ROWS],
          ACCURACY + "a sphere light's cone 1 % too wide"),
    Fault("point-light-bright", "shaders/lights/point.glsl",
          "light.radiance / density, 1.0", "1.01 * light.radiance / density, 1.0",
          "a point light is 1 % bright", [LAMPS, FORMULAS],
          VERIFY + "a point light 1 % bright"),
    Fault("spot-falloff", "shaders/lights/spot.glsl",
          "clamp((cutoff - angle) / (cutoff - beam)", "clamp(1.02 * (cutoff - angle) / (cutoff - beam)",
          "a spot falls off 2 % late", [LAMPS]),
    Fault("spot-gltf-falloff", "shaders/lights/spot.glsl",
          "falloff = way * way;", "falloff = way;",
          "a spot of glTF falls off linearly with the cosine", ["gltf::candela"]),
    Fault("projector-cosine", "shaders/lights/projector.glsl",
          "(distance2 * local.z * local.z * local.z)", "(distance2 * local.z * local.z)",
          "a projector's light samples lack a cosine", [LAMPS, MITSUBA]),
    Fault("directional-emission", "shaders/lights/directional.glsl",
          "e.power = light.radiance /", "e.power = 0.95 * light.radiance /",
          "light paths of the sun carry 5 % too little", ["bidirectional::every_light", "caustic::a_ring_throws_a_nephroid"]),
    Fault("environment-density", "shaders/lights/background.glsl",
          "/ (2.0 * PI * PI * max", "/ (1.98 * PI * PI * max",
          "densities of an environment's directions are 1 % high", ["lights::light_samples_follow_their_density", IRRADIANCE]),
    Fault("background-chosen", "shaders/lights/light.glsl",
          "bool chosen = u < share;", "bool chosen = u < 0.97 * share;",
          "the background is chosen 3 % too seldom", [IRRADIANCE]),
    Fault("surface-emission", "shaders/lights/emit.glsl",
          "float cosine_over_pdf = cosine / surface", "float cosine_over_pdf = 1.02 * cosine / surface",
          "light paths of area lights carry 2 % too much", [FURNACES, WEIGHTS]),
    Fault("light-tree-reach", "shaders/lights/light_tree.glsl",
          "float spread = float(bits >> 24) * (1.0 / 127.0);", "float spread = max(0.5, float(bits >> 24) * (1.0 / 127.0));",
          "lights are taken to shed within 60 degrees only", ["light_tree::no_light_is_lost"],
          ACCURACY + "light tree: lights taken to shed within 60 degrees only"),
    Fault("light-tree-chance", "shaders/lights/light_tree.glsl",
          "probability *= chance;", "probability *= min(1.01 * chance, 1.0);",
          "the tree states 1 % more than it chooses by, each turn", ["light_tree::densities_agree"]),
    Fault("middle-of-triangle", "shaders/lights/middle.glsl",
          "vec2 b = vec2(1.0 / 3.0);", "vec2 b = vec2(0.36);",
          "the point that stands for a triangle is not its centroid", ["whitted::the_middle_stands_for_the_lamp"],
          NOTES + "middle moved (triangle)"),
    Fault("light-density", "src/scene/compile/light_table.rs",
          "{ (f64::from(light.probability) / area) as f32 }", "{ (1.02 * f64::from(light.probability) / area) as f32 }",
          "surfaces state 2 % more than triangle lights are sampled with", [LIGHTS_FOUND, FURNACES]),
    Fault("alias-table", "src/scene/compile/alias.rs",
          "share[greater] -= 1.0 - share[lesser];", "share[greater] -= 0.97 * (1.0 - share[lesser]);",
          "what an entry gives away is taken from it by 3 % too little", ["lib:entries_are_selected_in_proportion"]),

    # Backends
    Fault("bvh-padding", "shaders/trace/bvh.glsl",
          "vec3 margin = CELL_MARGIN * abs(scale) + gamma(4.0) * abs(start);", "vec3 margin = vec3(0.0);",
          "slabs without padding", [ROWS],
          VERIFY + "slabs without padding"),
    Fault("bvh-child", "shaders/trace/bvh.glsl",
          "child < 4u;", "child < 4u - side;",
          "the last of eight children is skipped", [ROWS, "rays::counts_are_those"],
          VERIFY + "a child skipped"),
    Fault("triangle-edges", "shaders/trace/triangle.glsl",
          "<= 0 || max(negated.x, max(negated.y, negated.z)) <= 0", "< 0 || max(negated.x, max(negated.y, negated.z)) < 0",
          "edges belong to no triangle", [ROWS],
          ACCURACY + "edges belong to no triangle"),
    Fault("sphere-radius", "shaders/trace/sphere.glsl",
          "float r2 = radius * radius;", "float r2 = 0.99 * radius * radius;",
          "rays meet spheres that are half a per cent small", [ROWS]),
    Fault("ray-query-shadows", "shaders/trace/ray_query.glsl",
          "if (any) return true;", "if (any) return kind == gl_RayQueryCommittedIntersectionTriangleEXT;",
          "spheres throw no shadows by ray queries", [ROWS, "agreement::techniques_agree_on_cornell_spheres"]),
    Fault("inline-spheres", "shaders/trace/inline.glsl",
          "TAKE(index, sphere_hit(ray.origin, ray.direction, centre, radius, t))", "TAKE(index, sphere_hit(ray.origin, ray.direction, centre, 0.999 * radius, t))",
          "inlined spheres are a thousandth small", ["traversal::inline_primitives"]),
    Fault("inline-shadows", "shaders/trace/inline.glsl",
          "t < ray.t_max ||", "t < 0.95 * ray.t_max ||",
          "shadow rays end 5 % early among inlined primitives", ["traversal::inline_primitives"]),
    Fault("instance-normals", "shaders/trace/instance.glsl",
          "return n.x * i.object0.xyz + n.y * i.object1.xyz + n.z * i.object2.xyz;", "return world_vector(i, n);",
          "an instance's normals go by its map instead of the inverse transpose", ["scenes::stretched_instances", ROWS],
          ACCURACY + "an instance's normals by its map"),
    Fault("instance-margin", "shaders/trace/interaction.glsl",
          " + gamma(4.0) * (largest(there) + largest(back))", "",
          "points on instances without a margin of their own", [ROWS],
          VERIFY + "points on instances without a margin"),
    Fault("offset-zero", "shaders/trace/interaction.glsl",
          "(dot(w, normal) < 0.0 ? -margin : margin) *", "0.0 *",
          "rays start on the surface, not off it", [FURNACES, ROWS],
          ACCURACY + "rays start on the surface, not off it"),

    # Camera, film, filters, random numbers
    Fault("camera-importance", "shaders/core/camera.glsl",
          "return length2 * sqrt(length2) / abs(volume);", "return length2 / abs(volume);",
          "the importance of a pinhole lacks a cosine", [FURNACES, "bidirectional::every_light"]),
    Fault("orthographic-shift", "shaders/core/camera.glsl",
          "scene.camera_origin + position.x * scene.lens_x", "scene.camera_origin + (position.x + 0.5) * scene.lens_x",
          "parallel rays are half a pixel aside", [FORMULAS],
          VERIFY + "parallel rays half a pixel aside"),
    Fault("lens-area", "shaders/core/camera.glsl",
          "{ return PI * dot(scene.lens_x", "{ return 1.05 * PI * dot(scene.lens_x",
          "a lens is 5 % large to paths that run into it", [WEIGHTS, "strategies::to_a_lens"]),
    Fault("filter-gaussian", "shaders/core/camera.glsl",
          "exp(-x * x / (2.0 * p * p)) -", "exp(-x * x / (2.1 * p * p)) -",
          "a Gaussian is 5 % wide where it weighs, not where it is sampled", ["scenes::filters_keep_the_mean"]),
    Fault("filter-of-light-paths", "shaders/core/camera.glsl",
          "(value < 0.0 ? -total : total) *", "0.97 * (value < 0.0 ? -total : total) *",
          "what light paths show is 3 % dark along each axis of a filter", ["bidirectional::every_camera_and_filter", "strategies::to_a_lens"]),
    Fault("film-plain-sum", "shaders/core/film.glsl",
          "low = left;", "low = vec3(0.0);",
          "sums are plain ones", ["analytic::sums", ROWS],
          ACCURACY + "plain sums"),
    Fault("film-layer-shift", "shaders/core/film.glsl",
          "e.by_length[min(length, LENGTH_LAYERS) - 1u]", "e.by_length[min(length + 1u, LENGTH_LAYERS) - 1u]",
          "layers by length are shifted by one", [FURNACES],
          ACCURACY + "layers by length shifted by one"),
    Fault("film-not-finite", "shaders/core/film.glsl",
          "any(isnan(x)) || any(isinf(x))", "any(isnan(x))",
          "infinite samples are kept", [ROWS, "checkpoint::dropped_samples_are_kept"],
          ACCURACY + "non-finite samples kept"),
    Fault("film-cut", "shaders/core/film.glsl",
          "vec3 x = e.radiance * pixel.filter_weight;", "vec3 x = min(e.radiance, 1e6) * pixel.filter_weight;",
          "a sample's radiance is cut at 10^6", [ROWS],
          VERIFY + "a sample's radiance cut at 10^6"),
    Fault("splat-not-atomic", "shaders/core/splat.glsl",
          "if (amount != 0l) atomicAdd(sums.channel[i], amount);", "sums.channel[i] += amount;",
          "sums of splats are not atomic", ["analytic::sums", ROWS],
          VERIFY + "sums of splats not atomic"),
    Fault("random-half", "shaders/core/rng.glsl",
          "pcg4d(uvec4(s.pixel, s.sample_index, s.dimension, s.seed))", "pcg4d(uvec4(s.pixel >> 1u, s.sample_index, s.dimension, s.seed))",
          "two pixels share their random numbers", [ROWS],
          VERIFY + "half of the pixels' numbers"),
    Fault("halves-alike", "shaders/core/rng.glsl",
          "sobol_pairs(s, s.sample_index & 1u, s.sample_index >> 1u)", "sobol_pairs(s, 0u, s.sample_index >> 1u)",
          "both halves of a pixel's samples are the same", ["sampling::sobol_pairs_are_nets", "error_target::the_error_is_what_was_asked_for"]),
    Fault("difference-of-all", "shaders/core/film.glsl",
          "(pixel.sample_index & 1u) == 0u ? x : -x", "(pixel.sample_index & 3u) == 0u ? x : -x",
          "the difference of the halves is that of other parts", ["error_target::the_error_is_what_was_asked_for"]),
    Fault("light-alias", "shaders/lights/light.glsl",
          "alias ? (u.z - keep) / (1.0 - keep) : u.z / keep", "alias ? u.z - keep : u.z / keep",
          "samples on lights that are an entry's alias are not uniform", ["lights::light_samples_follow_their_density"]),
    Fault("whole-rounds", "shaders/core/whole.glsl",
          "floor(x) + 8388608.0", "x + 8388608.0",
          "positive floats are rounded to integers, not cut off", ["lights::light_samples_follow_their_density"]),
    Fault("sobol-bit", "shaders/core/rng.glsl",
          "& 0x0f0f0f0fu;", "& 0x0f0f0f0eu;",
          "one bit of the Sobol sequence's second dimension is missing", ["sampling::sobol_pairs_are_nets"]),

    # Textures
    Fault("texel-centre", "shaders/core/texture.glsl",
          "(nearest ? 0.0 : 0.5)", "(nearest ? 0.0 : 0.45)",
          "textures are a twentieth of a texel aside", [LAMPS, IRRADIANCE]),
    Fault("mip-level", "shaders/core/texture.glsl",
          "clamp(log2(texels), 0.0", "clamp(log2(2.0 * texels), 0.0",
          "mip maps are looked up a level too coarse", ["mip_maps::one_sample_sees"]),
    Fault("mip-odd-sides", "src/scene/compile/mip_maps.rs",
          "*share > 1e-9", "*share > 0.2",
          "levels of odd sides leave out parts of texels", ["mip_maps::levels_are_the_means"]),
    Fault("srgb-decoding", "src/image/srgb.rs",
          "((encoded + 0.055) / 1.055).powf(2.4)", "((encoded + 0.055) / 1.055).powf(2.35)",
          "sRGB is decoded by a slightly lower power", ["mip_maps::levels_are_the_means", "gltf::textures_are_upright"]),

    # Scene files
    Fault("mitsuba-transform-order", "src/scene/load/mitsuba/transform.rs",
          "total = parse_part(part)? * total;", "total = total * parse_part(part)?;",
          "a transform's parts apply in reverse", ["scenes::transforms_apply_in_order"]),
    Fault("mitsuba-envmap-poles", "src/scene/load/mitsuba/emitter.rs",
          "[0.0, (rows - 1.0) / rows, 0.5 / rows]", "[0.0, 1.0, 0.0]",
          "an environment's poles are half a row off", [MITSUBA]),
    Fault("mitsuba-spot-beam", "src/scene/load/mitsuba/emitter.rs",
          "cutoff * 0.75", "cutoff * 0.7",
          "a spot's beam is 7 % narrow where the file does not say", [MITSUBA]),
    Fault("gltf-transform", "src/scene/load/gltf/textures.rs",
          "[-sin * sx, cos * sy, y]", "[-sin * sy, cos * sy, y]",
          "a texture's rotation takes the other axis's scale", ["gltf::texture_transforms"]),
    Fault("gltf-normalised", "src/scene/load/gltf/accessors.rs",
          "low(1)])), 32767.0)", "low(1)])), 32768.0)",
          "normalised shorts do not reach one", ["gltf::all_ways_to_store_numbers"]),
    Fault("gltf-attenuation", "src/scene/load/gltf/materials.rs",
          "(-channel.ln()).clamp", "(-0.97 * channel.ln()).clamp",
          "volumes absorb 3 % less than their attenuation colour says", ["gltf::layers_reach_the_material", "gltf::glass_absorbs"]),
    Fault("obj-colour", "src/scene/load/obj/materials.rs",
          "channel.clamp(0.0, 1.0) as f32", "channel.clamp(0.0, 0.75) as f32",
          "colours of MTL files are cut at 0.75", ["scenes::obj_brings_its_materials"]),
    Fault("ply-float", "src/scene/load/ply.rs",
          "Property::Float(value) => Some(f64::from(*value))", "Property::Float(value) => Some(1.01 * f64::from(*value))",
          "single floats of PLY files are 1 % large", ["scenes::ply_encodings_agree"]),
    Fault("serialized-v", "src/scene/load/serialized.rs",
          "Vec2::new(u as f32, v as f32)", "Vec2::new(u as f32, 1.0 - v as f32)",
          "texture coordinates of serialized meshes are upside down", ["lib:serialized::tests::meshes_come_back"]),
    Fault("emitters-coincide", "src/scene/compile/flatten.rs",
          "sides.clone().any(|side| self.emitting.contains(&side))", "false",
          "emitters that coincide are kept", [FURNACES, ROWS],
          VERIFY + "emitters that coincide kept"),
    Fault("degenerate-tiny", "src/scene/compile/flatten.rs",
          "scaled_normal.length_squared() == 0.0", "scaled_normal.length_squared() < 1e-20",
          "triangles under 5e-11 in area are taken for degenerate", [ROWS],
          VERIFY + "triangles under 5e-11 in area taken for degenerate"),
    Fault("origin-stays", "src/scene/compile/placement.rs",
          "if far <= 4.0 *", "if far <= 4.0e9 *",
          "scenes are not moved near the origin", ["scenes::far_scenes_keep_their_detail", ROWS],
          ACCURACY + "scenes not moved near the origin"),

    # Checkpoints
    Fault("checkpoint-film", "src/render/sums.rs",
          "stream.buffer(film)?;", "",
          "the film is not kept", ["checkpoint::every_technique"],
          RUNS + "the film is not kept"),
    Fault("checkpoint-rays", "src/render/counted.rs",
          "stream.long(&mut self.rays)?;", "stream.long(&mut self.rays.clone())?;",
          "the count of rays is written down and not taken up", ["checkpoint::every_technique"],
          RUNS + "the count of rays is not kept"),
    Fault("shards-sums", "src/render/sums.rs",
          "*own = blocks::sum(*own, *other)", "*own = *other",
          "of merged shards the last one alone counts", ["shards::merged_shards_have_the_bits_of_one_run"],
          CLUSTERS + "the sums of shards are not added"),
    Fault("checkpoint-chains", "src/techniques/metropolis/chains.rs",
          "[&self.bootstrap, &self.states, &self.values, &self.numbers]", "[&self.bootstrap, &self.states, &self.values]",
          "the random numbers of chains are not kept", ["checkpoint::every_technique"]),
    Fault("checkpoint-seed", "src/checkpoint/identity.rs",
          "(\"seed\", seed.to_string())", "(\"seed\", (seed & 1).to_string())",
          "seeds are told apart by their last bit only", ["checkpoint::checkpoints_of_other_renderings"],
          RUNS + "a constant seed in what a checkpoint belongs to"),
    Fault("checkpoint-checksum", "src/checkpoint/format.rs",
          "if u32::from_le_bytes(stated) != sum.finalize()", "if u32::from_le_bytes(stated) & 3 != sum.finalize() & 3",
          "two bits of the checksum are compared", [DAMAGED],
          RUNS + "the checksum's verdict is not asked"),
    Fault("checkpoint-good", "src/checkpoint/files.rs",
          "self.is_good = path == self.path || !self.path.exists();", "self.is_good = true;",
          "a damaged file pushes out the good one", [DAMAGED],
          RUNS + "a damaged file pushes out the good one"),
    Fault("checkpoint-sync", "src/checkpoint/format.rs",
          "file.sync_all().map_err(failed)", "Ok(())",
          "a file takes its place before it is synced", ["checkpoint::what_cannot_be_synced"],
          RUNS + "a file takes its place before it is synced"),

    # Output
    Fault("exr-half", "src/image/exr.rs",
          "map(|pixel| pixel[index]).collect();", "map(|pixel| f32::from_bits(pixel[index].to_bits() & 0xffff_e000)).collect();",
          "EXR files have the digits of half precision", [ROWS],
          VERIFY + "EXR files of half precision"),
    Fault("png-power", "src/image/srgb.rs",
          "c.powf(1.0 / 2.4)", "c.powf(1.0 / 2.3)",
          "PNG files are encoded by a slightly higher power", ["mip_maps::levels_are_the_means"]),

    # Statistics
    Fault("sample-variance", "src/render/film.rs",
          "((squares - sum * sum / n) / (n - 1.0))", "(0.85 * (squares - sum * sum / n) / (n - 1.0))",
          "the variance of samples is 15 % low", ["error_target::the_error_is_what_was_asked_for"]),
    Fault("sidak", "src/statistics/significance.rs",
          "powf(1.0 / count.max(1) as f64)", "powf(1.0 / (count.max(1) + 10) as f64)",
          "the correction for many tests is too strict", ["lib:sidak_of_one_test"]),
    Fault("relmse", "src/image/metrics/mod.rs",
          "difference * difference / (b * b + RELATIVE_FLOOR)", "difference * difference / (a * a + RELATIVE_FLOOR)",
          "relMSE is relative to the image instead of the reference", ["lib:figures_by_hand"]),
    Fault("verdict-nan", "src/verify/figure.rs",
          "if figure <= bound {", "if !(figure > bound) {",
          "what is no number is within every bound", ["verify::figures_can_fail"]),

    # The specialiser
    Fault("spirv-comparison", "src/spirv/fold.rs",
          "op::U_GREATER_THAN => u64::from(a > b)", "op::U_GREATER_THAN => u64::from(a >= b)",
          "a comparison is folded wrongly where both sides are equal", [SPECIALISED, FURNACES]),
    Fault("spirv-sign", "src/spirv/fold.rs",
          "u64::from(signed_a < signed_b)", "u64::from(a < b)",
          "numbers with a sign are compared without it", ["lib:spirv::fold"]),
    Fault("spirv-live-store", "src/spirv/live.rs",
          "op::ACCESS_CHAIN | op::IN_BOUNDS_ACCESS_CHAIN | op::COPY_OBJECT);", "op::ACCESS_CHAIN | op::IN_BOUNDS_ACCESS_CHAIN | op::COPY_OBJECT | op::FUNCTION_CALL);",
          "stores that only a called function reads are dropped", [SPECIALISED, FURNACES]),
    Fault("spirv-varying", "src/spirv/propagate.rs",
          "let new = old.or(self.known[operands[0] as usize]);", "let new = if old == Known::Nothing { self.known[operands[0] as usize] } else { old };",
          "what a function returns counts as constant if its first way out returns one", [SPECIALISED, FURNACES]),
    Fault("spirv-branch", "src/spirv/propagate.rs",
          "(!goes_back).then(|| operands[if condition == 1 { 1 } else { 2 }])", "(!goes_back).then(|| operands[if condition == 1 { 2 } else { 1 }])",
          "the wrong side of a decided branch is kept", [SPECIALISED, FURNACES]),
    Fault("spirv-or", "src/spirv/fold.rs",
          "op::LOGICAL_OR if of(0) == Some(1) || of(1) == Some(1) => return Some(1)", "op::LOGICAL_OR if of(0) == Some(0) || of(1) == Some(0) => return Some(0)",
          "one operand that is false decides an or", ["lib:spirv::fold", SPECIALISED]),

    # What a reference knows of itself.
    Fault("reference-own-error", "src/reference/tails.rs",
          "* weight / (1.0 - weight)", "* weight / (1.1 - weight)", "a reference's own error 10 % too small", ["lib:reference::tails"]),
    Fault("reference-blur", "src/reference/tails.rs",
          "SHIFT_OF_MEAN * ((sum / pixels).max(0.0)", "0.25 * ((sum / pixels).max(0.0)", "blur a third of what it is", ["lib:reference::tails"]),
    Fault("reference-witness-blind", "src/reference/witness.rs",
          "sidak(sidak(ALPHA, sizes.len()), count)", "sidak(sidak(1e-9 * ALPHA, sizes.len()), count)",
          "a witness that sees nothing but blunders", ["witness::a_wrong_scale_in_a_twentieth_is_found", "lib:reference::witness"]),
    Fault("reference-witness-nervous", "src/reference/witness.rs",
          "sidak(sidak(ALPHA, sizes.len()), count)", "ALPHA", "each tile at the level of all", ["lib:reference::witness"]),
    Fault("reference-unseen", "src/reference/witness.rs",
          "deviations < 0.0 && kinds.of_witness.is_some()", "deviations < 0.0 && kinds.of_reference.is_some()",
          "a witness that misses light blames the reference", ["witness::missing_light_is_found"]),
    Fault("reference-halves", "src/reference/series.rs",
          "(weights[0] * weights[1]).sqrt()", "0.8 * (weights[0] * weights[1]).sqrt()", "a reference's noise a fifth too small", ["lib:reference::series"]),
    Fault("reference-schedule", "src/techniques/merging/radius.rs",
          "sample.saturating_mul(stride)", "sample", "several renderings blur as much as one short one", ["lib:techniques::merging::radius"]),
    Fault("bench-own-noise", "src/image/metrics/pixels.rs",
          "zip(&noise).map(|(error, noise)| error - noise)", "zip(&noise).map(|(error, noise)| error - 0.5 * noise)",
          "half of the reference's noise stays in the relMSE of parts", ["lib:image::metrics::pixels"]),
    Fault("fingerprint-sky", "src/scene/fingerprint.rs",
          "bits(from_world, hasher);", "let _ = from_world;", "a sky that was turned is the same scene", ["lib:scene::fingerprint"]),
]


def occurrences(fault):
    path = ROOT / fault.file
    return path.read_text("utf-8").count(fault.text) if path.is_file() else -1


def check(faults):
    """What is wrong with the table, a line each."""
    wrong = []
    for fault in faults:
        count = occurrences(fault)
        if count != 1:
            wrong.append(f"{fault.name}: {fault.file} " + ("is not there" if count < 0 else f"has its text {count} times: {fault.text}"))
        if fault.text == fault.becomes or not fault.tests:
            wrong.append(f"{fault.name}: it changes nothing, or names no test")
    names = [fault.name for fault in FAULTS]
    return wrong + [f"{name}: the name is taken twice" for name in sorted({name for name in names if names.count(name) > 1})]


def show(faults):
    for fault in faults:
        print(f"{fault.name}: {fault.meaning}\n    {fault.file}: {fault.text}\n    {'becomes':<{len(fault.file)}}: {fault.becomes or '(nothing)'}")
        print(f"    tests: {', '.join(fault.tests)}" + (f"\n    {fault.origin}" if fault.origin else ""))
    print(f"{len(faults)} faults, {sum(bool(fault.origin) for fault in faults)} of them documented")


class TimeLimit(Exception):
    """A command took longer than it may."""


def run(command, seconds):
    """Runs a command of cargo; its exit status and all that it printed. Whatever happens, nothing of it goes on."""
    environment = dict(os.environ)
    # As the Makefile has them: tests run on lavapipe, with both backends.
    environment.setdefault("LUMBRE_TEST_DEVICE", "llvmpipe")
    environment.setdefault("LUMBRE_TEST_BACKENDS", "all")
    process = subprocess.Popen(command, cwd=ROOT, env=environment, text=True, errors="replace", start_new_session=True,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    try:
        printed, _ = process.communicate(timeout=max(seconds, 1))
    except subprocess.TimeoutExpired:
        raise TimeLimit from None
    finally:
        if process.poll() is None:
            # The tests are children of cargo.
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
    return process.returncode, printed


def targets(tests):
    """The arguments of cargo for each kind of test, with the names for it. No names at all stand for all tests."""
    if not tests:
        return [([], [])]
    library = [test.removeprefix("lib:") for test in tests if test.startswith("lib:")]
    others = [test for test in tests if not test.startswith("lib:")]
    return [(target, names) for target, names in ((["--lib"], library), (["--test", "tests"], others)) if names]


def build(tests):
    """What the compiler says if it does not compile, or nothing."""
    for target, _ in targets(tests):
        status, printed = run(["cargo", "test", "--release", "--no-run", *target], BUILD_SECONDS)
        if status != 0:
            return printed
    return ""


def failing(tests, seconds):
    """The tests that fail, and what was printed."""
    end, failed, all_printed = time.monotonic() + seconds, [], ""
    for target, names in targets(tests):
        command = ["cargo", "test", "--release", "--no-fail-fast", *target, "--", *names]
        status, printed = run(command, end - time.monotonic())
        all_printed += printed
        here = list(dict.fromkeys(re.findall(r"^test (\S+).* FAILED$", printed, re.MULTILINE)))
        here += [name for name in re.findall(r"^    (\S+)$", printed.partition("\nfailures:")[2], re.MULTILINE) if name not in here and "::" in name]
        if status != 0 and not here:
            here = ["a test program ended without a verdict"]
        failed += here
    return failed, all_printed


def known_tests():
    """The names of all tests, as the table has them."""
    names = []
    for target, prefix in ((["--lib"], "lib:"), (["--test", "tests"], "")):
        status, printed = run(["cargo", "test", "--release", *target, "--", "--list"], BUILD_SECONDS)
        if status != 0:
            sys.exit(f"the tests cannot be listed:\n{printed[-4000:]}")
        names += [prefix + name for name in re.findall(r"^(\S+): test$", printed, re.MULTILINE)]
    return names


def matches(wanted, name):
    return wanted.startswith("lib:") == name.startswith("lib:") and wanted.removeprefix("lib:") in name.removeprefix("lib:")


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def try_out(fault, whole, seconds):
    """Plants the fault, runs tests, and takes it out: what came of it, and by which tests."""
    path = ROOT / fault.file
    before = path.read_bytes()
    tests = [] if whole else fault.tests
    try:
        path.write_bytes(before.replace(fault.text.encode(), fault.becomes.encode()))
        try:
            if printed := build(tests):
                return "did not compile", re.findall(r"^.*error.*$", printed, re.MULTILINE)[:1]
            failed, _ = failing(tests, seconds)
        except TimeLimit:
            # Without a fault they do end: a kernel that never comes back, say.
            return "found", ["tests that do not end"]
        return ("found", failed) if failed else ("NOT FOUND", [])
    finally:
        path.write_bytes(before)


class Results:
    """What is known so far, in a file if there is one. Errors of the table are tried again."""

    def __init__(self, path, fresh):
        self.path = path
        self.rows = json.loads(path.read_text()) if path and path.exists() and not fresh else []

    def find(self, name, whole):
        return next((row for row in self.rows if row["name"] == name and row["whole"] == whole and row["outcome"] != "did not compile"), None)

    def add(self, row):
        self.rows = [old for old in self.rows if (old["name"], old["whole"]) != (row["name"], row["whole"])] + [row]
        if self.path:
            # Whole or not at all: an interrupt must not lose what hours have found.
            partial = self.path.with_name(self.path.name + ".partial")
            partial.write_text(json.dumps(self.rows, indent=2) + "\n")
            partial.replace(self.path)


def prepare(faults, whole, seconds):
    """Ends the program unless each fault has tests, and all of these pass without a fault."""
    known = known_tests()
    wanted = [] if whole else sorted({test for fault in faults for test in fault.tests})
    missing = [test for test in wanted if not any(matches(test, name) for name in known)]
    for test in missing:
        print(f"no test is named {test}", flush=True)
    without = [fault.name for fault in faults if not whole and all(test in missing for test in fault.tests)]
    if without:
        sys.exit(f"no test at all is there for {', '.join(without)}")
    started = time.monotonic()
    try:
        if printed := build(wanted):
            sys.exit(f"the tree without a fault does not compile:\n{printed[-4000:]}")
        failed, printed = failing(wanted, seconds)
    except TimeLimit:
        sys.exit("without a fault the tests take longer than --clean-limit, or compiling longer than half an hour")
    if failed:
        sys.exit(f"{printed[-8000:]}\nwithout a fault fails {', '.join(failed)}: what it finds tells nothing")
    print(f"without a fault all pass, {time.monotonic() - started:.0f} s", flush=True)


def run_all(faults, args):
    if changes := git("status", "--porcelain", "--untracked-files=no"):
        sys.exit(f"the working tree has changes, which a fault could be taken for; commit or undo them:\n{changes}")
    results = Results(args.json, args.fresh)
    left = [fault for fault in faults if not results.find(fault.name, args.whole)]
    if left:
        prepare(left, args.whole, args.clean_limit)
    commit = git("rev-parse", "HEAD")
    for fault in left:
        started = time.monotonic()
        outcome, by = try_out(fault, args.whole, args.limit)
        took = time.monotonic() - started
        results.add({"name": fault.name, "outcome": outcome, "by": by, "seconds": round(took, 1), "whole": args.whole, "commit": commit})
        reasons = (" by " if outcome == "found" else ": ") + ", ".join(by[:3]) + (" and others" if len(by) > 3 else "") if by else ""
        print(f"{fault.name}: {outcome}{reasons}, {took:.0f} s", flush=True)
    rows = [results.find(fault.name, args.whole) for fault in faults]
    found = sum(row is not None and row["outcome"] == "found" for row in rows)
    print(f"{found} of {len(faults)} found")
    for fault, row in zip(faults, rows):
        if row is None or row["outcome"] != "found":
            print(f"  {fault.name}: {row['outcome'] if row else 'did not compile'}")
    return found == len(faults)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--list", action="store_true")
    what.add_argument("--check", action="store_true")
    what.add_argument("--run", action="store_true")
    parser.add_argument("names", nargs="*", metavar="NAME", help="faults; all without any")
    parser.add_argument("--whole", action="store_true", help="all tests instead of those that are named")
    parser.add_argument("--json", type=Path, metavar="FILE", help="where results are kept")
    parser.add_argument("--fresh", action="store_true", help="forget what FILE has")
    parser.add_argument("--limit", type=float, metavar="SECONDS", help="for the tests of a fault (600, of all tests 7200)")
    parser.add_argument("--clean-limit", type=float, default=CLEAN_SECONDS, metavar="SECONDS", help="for the tests without a fault")
    args = parser.parse_args()
    args.limit = args.limit or (7200 if args.whole else 600)
    # So that what was planted is taken out.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("terminated"))
    signal.signal(signal.SIGHUP, lambda *_: sys.exit("terminated"))

    if unknown := [name for name in args.names if all(fault.name != name for fault in FAULTS)]:
        sys.exit(f"no fault is named {', '.join(unknown)}")
    faults = [fault for fault in FAULTS if not args.names or fault.name in args.names]
    if args.list:
        show(faults)
        return
    if wrong := check(faults):
        sys.exit("\n".join(wrong))
    if args.check:
        print(f"{len(faults)} faults have their place")
        return
    try:
        ok = run_all(faults, args)
    except KeyboardInterrupt:
        sys.exit("interrupted; what was planted is taken out")
    sys.exit(0 if ok else 1)


if __name__ == "__main__":
    main()
