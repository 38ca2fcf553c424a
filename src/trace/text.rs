//! A trace as text.

use std::fmt::Write;

use super::types::{Emission, Proposal, Subpath, Trace, Vertex, Visit};

/// A number with so many digits that two values can be told apart.
fn number(value: f64) -> String {
    let size = value.abs();
    match size {
        0.0 => String::from("0"),
        _ if (1e-3..1e5).contains(&size) => {
            format!("{value:.5}").trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => format!("{value:.3e}"),
    }
}

fn vector(v: [f64; 3]) -> String {
    format!("({}, {}, {})", number(v[0]), number(v[1]), number(v[2]))
}

/// The trace as text, a paragraph for each vertex.
pub fn text(trace: &Trace) -> String {
    let mut out = String::new();
    let Trace { pixel: [x, y], sample, seed, .. } = trace;
    line(
        &mut out,
        0,
        &format!(
            "{}: {} on {}, pixel {x},{y}, sample {sample} of seed {seed}",
            trace.scene, trace.integrator, trace.backend
        ),
    );
    line(
        &mut out,
        0,
        &format!("value      {}, of which the filter's weight is {}", vector(trace.value), number(trace.filter_weight)),
    );
    if trace.value.iter().any(|channel| !channel.is_finite()) {
        line(&mut out, 0, "not finite: the film has dropped it");
    }
    if let Some(proposal) = &trace.proposal {
        proposed(&mut out, proposal);
    }
    for path in &trace.subpaths {
        subpath(&mut out, path, trace.proposal.is_some());
    }
    if !trace.strategies.is_empty() {
        line(&mut out, 0, "strategies (s, t), contribution, weight");
        let mut sorted: Vec<_> = trace.strategies.iter().collect();
        sorted.sort_by_key(|one| (one.s + one.t, one.s));
        for one in sorted {
            line(
                &mut out,
                2,
                &format!(
                    "({}, {}) {:<9}  {}  {}",
                    one.s,
                    one.t,
                    one.how,
                    vector(one.contribution),
                    number(one.mis_weight)
                ),
            );
        }
    }
    if !trace.contributions.is_empty() {
        line(&mut out, 0, "contributions of the camera's paths");
        for one in &trace.contributions {
            let plural = if one.segments == 1 { "" } else { "s" };
            line(&mut out, 2, &format!("{} segment{plural}  {}", one.segments, vector(one.value)));
        }
    }
    if !trace.visits.is_empty() {
        line(&mut out, 0, "visits of chains");
        for visit in &trace.visits {
            let is_told = |told: &Proposal| [told.chain, told.mutation] == [visit.chain, visit.proposed_by];
            line(&mut out, 2, &visited(visit, trace.proposal.as_ref().is_some_and(is_told)));
        }
    } else if !trace.splats.is_empty() {
        line(&mut out, 0, "splats of light subpaths (s, t), value, weight");
        for splat in &trace.splats {
            let strategy = format!("({}, {})", splat.s.unwrap_or_default(), splat.t.unwrap_or_default());
            line(
                &mut out,
                2,
                &format!("subpath {} {strategy}  {}  {}", splat.source, vector(splat.value), number(splat.weight)),
            );
        }
    }
    line(&mut out, 0, &format!("sum        {}", vector(trace.sum)));
    out
}

/// What has proposed the path of a chain that is told.
fn proposed(out: &mut String, told: &Proposal) {
    let by = match told.mutation {
        0 => format!("the {} that it began at", told.sort),
        mutation => format!("proposed by mutation {mutation}, a {}", told.sort),
    };
    line(out, 0, &format!("path of the visit that adds most: chain {}, {by}", told.chain));
    line(out, 0, &format!("share      {}: the path's value times this is its contribution", number(told.share)));
}

fn visited(visit: &Visit, is_told: bool) -> String {
    let what = match visit.proposed_by {
        _ if visit.is_proposal => String::from("proposal, accepted"),
        0 => String::from("current path, the bootstrap sample that it began at, proposal accepted"),
        mutation => format!("current path, of mutation {mutation}, proposal accepted"),
    };
    format!(
        "chain {}, mutation {}: {what} with probability {}, contribution {}, adds {}{}",
        visit.chain,
        visit.mutation,
        number(visit.acceptance),
        vector(visit.contribution),
        vector(visit.value),
        if is_told { " (told above)" } else { "" }
    )
}

fn line(out: &mut String, indent: usize, text: &str) {
    let _ = writeln!(out, "{:indent$}{text}", "");
}

fn subpath(out: &mut String, path: &Subpath, of_chain: bool) {
    let begins = &path.beginning;
    let title = match path.from_light {
        true if of_chain => String::from("light subpath"),
        true => format!("light subpath {}", path.index),
        false => String::from("path from the camera"),
    };
    line(out, 0, &title);
    let power = begins.power.map_or(String::new(), |power| format!(", power {} W", vector(power)));
    line(out, 2, &format!("0  {} towards {}{power}", vector(begins.position), vector(begins.direction)));
    path.vertices.iter().for_each(|one| vertex(out, one));
    if path.leaves_the_scene() {
        line(out, 2, "leaves the scene");
    }
    if let Some(background) = &path.background {
        emission(out, background, "the background");
    }
}

fn emission(out: &mut String, emission: &Emission, of: &str) {
    let radiance = vector(emission.radiance);
    if emission.is_delta {
        return line(out, 5, &format!("emission of a light that no path meets by chance: {radiance}"));
    }
    let by_bsdf = emission
        .pdf_w
        .map_or(String::from("by a delta or the camera"), |pdf| format!("pdf {} /sr by the BSDF", number(pdf)));
    let by_light = number(emission.light_pdf_w);
    line(
        out,
        5,
        &format!(
            "emission of {of}: {radiance}, {by_bsdf}, {by_light} /sr by light sampling, MIS weight {}",
            number(emission.mis_weight)
        ),
    );
}

fn vertex(out: &mut String, vertex: &Vertex) {
    let material = vertex.material.as_deref().unwrap_or("nothing that reflects");
    let shape = vertex.shape.as_ref().map_or(String::new(), |name| format!("{name}, "));
    line(out, 2, &format!("{}  {}  {shape}{material}", vertex.index, vector(vertex.position)));
    line(out, 5, &format!("normal {}, throughput {}", vector(vertex.normal), vector(vertex.throughput)));
    if let Some(own) = &vertex.emission {
        emission(out, own, "the surface");
    }
    for light in &vertex.light_samples {
        let place = light
            .position
            .map_or_else(|| format!("in direction {}", vector(light.direction)), |at| format!("at {}", vector(at)));
        let pdf = if light.is_delta {
            format!("probability {}", number(light.pdf))
        } else {
            format!("pdf {} /sr", number(light.pdf))
        };
        let visibility = match light.transmittance {
            0.0 if light.f_cos == [0.0; 3] => String::from("below the surface"),
            0.0 => String::from("in shadow"),
            1.0 => String::from("visible"),
            share => format!("{} comes through", number(share)),
        };
        line(
            out,
            5,
            &format!(
                "light sample {place}: {pdf}, {} /sr by the BSDF, MIS weight {}, {visibility}",
                number(light.bsdf_pdf_w),
                number(light.mis_weight)
            ),
        );
        if light.transmittance > 0.0 {
            line(
                out,
                7,
                &format!(
                    "f|cos| {} x radiance/pdf {} adds {}",
                    vector(light.f_cos),
                    vector(light.radiance_over_pdf),
                    vector(light.contribution)
                ),
            );
        }
    }
    for scattering in &vertex.scatterings {
        let how = if scattering.transmits { "transmits" } else { "reflects" };
        let pdf = if scattering.lobe == "delta" {
            format!("probability {}", number(scattering.pdf))
        } else {
            format!("pdf {} /sr", number(scattering.pdf))
        };
        line(
            out,
            5,
            &format!(
                "{how} by a {} lobe to {}: {pdf}, f|cos|/pdf {}",
                scattering.lobe,
                vector(scattering.direction),
                vector(scattering.weight)
            ),
        );
    }
    match vertex.roulette {
        Some(roulette) if roulette.ends => line(
            out,
            5,
            &format!("Russian roulette ends it; it would have gone on with probability {}", number(roulette.survival)),
        ),
        Some(roulette) if roulette.survival < 1.0 => {
            line(out, 5, &format!("Russian roulette: goes on, with probability {}", number(roulette.survival)))
        }
        _ => {}
    }
}
