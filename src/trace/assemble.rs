//! Records of a sample, put together.

use glam::DVec3;

use super::types::{
    Beginning, Contribution, Emission, LightSample, Proposal, Roulette, Scattering, Splat, StrategyContribution,
    Subpath, Trace, Vertex, Visit,
};
use super::{Request, names};
use crate::layout::{
    PathRecord, RECORD_BEGIN, RECORD_CONTRIBUTION, RECORD_EMISSION, RECORD_LIGHT_SAMPLE, RECORD_MUTATION,
    RECORD_ROULETTE, RECORD_SCATTER, RECORD_SPLAT, RECORD_STRATEGY, RECORD_VALUE, RECORD_VERTEX, RECORD_VISIT,
    RECORDED_CANDIDATE, RECORDED_DELTA, RECORDED_DISTANT, RECORDED_ENDS, RECORDED_MERGED, RECORDED_NARROW,
    RECORDED_PROPOSAL,
};
use crate::render::Renderer;
use crate::scene::Scene;

fn real(v: [f32; 3]) -> [f64; 3] {
    v.map(f64::from)
}

fn product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    product(a, b).iter().sum()
}

/// What the records say; `factor` makes an image of the film's sums.
pub(super) fn assemble(
    scene: &Scene,
    renderer: &Renderer,
    request: Request,
    records: &[PathRecord],
    factor: f64,
) -> Trace {
    let settings = renderer.settings();
    let mut trace = Trace {
        scene: scene.source.display().to_string(),
        integrator: settings.technique.describe(),
        backend: settings.backend.name().to_owned(),
        pixel: [request.x, request.y],
        sample: request.sample,
        seed: settings.seed,
        filter_weight: 1.0,
        value: [0.0; 3],
        sum: [0.0; 3],
        subpaths: Vec::new(),
        strategies: Vec::new(),
        contributions: Vec::new(),
        splats: Vec::new(),
        visits: Vec::new(),
        proposal: None,
    };
    let scaled = |v: [f32; 3]| real(v).map(|channel| channel * factor);
    let is_chain = records.iter().any(|record| record.kind == RECORD_VISIT);
    for record in records {
        match record.kind {
            RECORD_CONTRIBUTION => {
                trace.contributions.push(Contribution { segments: record.vertex, value: real(record.value) })
            }
            RECORD_STRATEGY => trace.strategies.push(StrategyContribution {
                s: record.s,
                t: record.t,
                how: match record.flags {
                    RECORDED_MERGED => "merged",
                    RECORDED_CANDIDATE => "candidate",
                    _ => "connected",
                },
                contribution: real(record.value),
                mis_weight: f64::from(record.weight),
            }),
            RECORD_SPLAT => trace.splats.push(Splat {
                source: record.vertex,
                s: (!is_chain).then_some(record.s),
                t: (!is_chain).then_some(record.t),
                value: scaled(record.value),
                weight: f64::from(record.weight),
            }),
            RECORD_VISIT => trace.visits.push(Visit {
                chain: record.s,
                mutation: record.t,
                proposed_by: record.vertex,
                is_proposal: record.flags & RECORDED_PROPOSAL != 0,
                acceptance: f64::from(record.probability),
                probability: f64::from(record.weight),
                contribution: real(record.value),
                value: scaled(record.throughput),
            }),
            RECORD_MUTATION => {
                trace.proposal = Some(Proposal {
                    chain: record.s,
                    mutation: record.t,
                    sort: names::mutation(record.vertex),
                    share: f64::from(record.weight),
                });
            }
            RECORD_VALUE => {
                trace.value = scaled(record.value);
                trace.filter_weight = f64::from(record.probability);
            }
            _ => follow(&mut trace.subpaths, scene, renderer, record),
        }
    }
    // Light subpaths after the camera's.
    trace.subpaths.sort_by_key(|subpath| subpath.from_light);
    let filtered =
        trace.contributions.iter().map(|one| one.value.map(|channel| channel * trace.filter_weight * factor));
    let all = filtered.chain(trace.splats.iter().map(|splat| splat.value));
    trace.sum = all.fold([0.0; 3], |sum, value| [sum[0] + value[0], sum[1] + value[1], sum[2] + value[2]]);
    trace
}

/// Takes a record of what happens along a subpath.
fn follow(subpaths: &mut Vec<Subpath>, scene: &Scene, renderer: &Renderer, record: &PathRecord) {
    let world = |position: [f32; 3]| (DVec3::from(real(position)) + scene.origin).to_array();
    let from_light = record.from_light == 1;
    let is_distant = record.flags & RECORDED_DISTANT != 0;
    if record.kind == RECORD_BEGIN {
        let beginning = Beginning {
            position: world(record.position),
            direction: real(record.direction),
            power: from_light.then(|| real(record.value)),
            pdf_a: from_light.then(|| f64::from(record.pdf)),
        };
        subpaths.push(Subpath { from_light, index: record.pixel, beginning, vertices: Vec::new(), background: None });
        return;
    }
    let own =
        |subpath: &&mut Subpath| subpath.from_light == from_light && (!from_light || subpath.index == record.pixel);
    let Some(subpath) = subpaths.iter_mut().rev().find(own) else { return };
    if record.kind == RECORD_VERTEX {
        subpath.vertices.push(Vertex {
            index: record.vertex,
            position: world(record.position),
            normal: real(record.normal),
            towards_previous: real(record.direction),
            shape: names::shape(scene, renderer.scene(), record),
            material: names::material(scene, record),
            throughput: real(record.throughput),
            emission: None,
            light_samples: Vec::new(),
            scatterings: Vec::new(),
            roulette: None,
        });
        return;
    }
    let vertex = subpath.vertices.iter_mut().rev().find(|vertex| vertex.index == record.vertex);
    match (record.kind, vertex) {
        (RECORD_EMISSION, vertex) => {
            let emission = Emission {
                radiance: real(record.value),
                throughput: real(record.throughput),
                pdf_w: (record.pdf > 0.0).then(|| f64::from(record.pdf)),
                light_pdf_w: f64::from(record.other_pdf),
                is_delta: record.flags & RECORDED_DELTA != 0,
                mis_weight: f64::from(record.weight),
            };
            *vertex.map_or(&mut subpath.background, |vertex| &mut vertex.emission) = Some(emission);
        }
        (RECORD_LIGHT_SAMPLE, Some(vertex)) => {
            let (f_cos, radiance_over_pdf, mis_weight) =
                (real(record.value), real(record.throughput), f64::from(record.weight));
            let unweighted = product(product(vertex.throughput, f_cos), radiance_over_pdf);
            vertex.light_samples.push(LightSample {
                position: (!is_distant).then(|| world(record.position)),
                direction: real(record.direction),
                f_cos,
                radiance_over_pdf,
                pdf: f64::from(record.pdf),
                is_delta: record.flags & RECORDED_DELTA != 0,
                bsdf_pdf_w: f64::from(record.other_pdf),
                mis_weight,
                transmittance: f64::from(record.probability),
                contribution: unweighted.map(|channel| channel * mis_weight),
            });
        }
        (RECORD_SCATTER, Some(vertex)) => {
            let direction = real(record.direction);
            vertex.scatterings.push(Scattering {
                direction,
                weight: real(record.value),
                pdf: f64::from(record.pdf),
                lobe: match record.flags {
                    flags if flags & RECORDED_DELTA != 0 => "delta",
                    flags if flags & RECORDED_NARROW != 0 => "narrow",
                    _ => "broad",
                },
                transmits: dot(direction, vertex.normal) * dot(vertex.towards_previous, vertex.normal) < 0.0,
                throughput: real(record.throughput),
            });
        }
        (RECORD_ROULETTE, Some(vertex)) => {
            let (survival, ends) = (f64::from(record.probability), record.flags & RECORDED_ENDS != 0);
            vertex.roulette = Some(Roulette { survival, ends });
        }
        _ => {}
    }
}
