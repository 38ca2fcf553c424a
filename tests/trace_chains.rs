//! `lumbre trace` of `mlt`: the path that is told of a chain's visit is worth what the visit says it contributes, in double precision.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::common::{backends_in_time, canon, settings, with_gpu};
use lumbre::gpu::Gpu;
use lumbre::layout::{PathRecord, RECORD_VISIT};
use lumbre::render::{Renderer, Settings, Wanted};
use lumbre::scene::Scene;
use lumbre::trace::{LightSample, Request, Subpath, Trace, Vertex, svg, text, trace};

/// An image of so many pixels across and down.
const SIDE: u32 = 24;
/// The sample that is traced: chains have had some before.
const SAMPLE: u32 = 7;
/// The lamp of the Cornell box: radiance, and area.
const LAMP: DVec3 = DVec3::new(18.387, 13.9873, 6.75357);
const LAMP_AREA: f64 = 130.0 * 105.0;
/// Tangent of half the field of view.
fn tangent() -> f64 {
    (39.3077_f64 / 2.0).to_radians().tan()
}
const PI: f64 = std::f64::consts::PI;

fn near(what: &str, found: DVec3, expected: DVec3, bound: f64) {
    assert!((found - expected).length() <= bound * expected.length().max(1e-30), "{what}: {found} for {expected}");
}

/// Albedo where a vertex is diffuse; nothing where it is mirror or glass.
fn albedo(vertex: &Vertex) -> Option<DVec3> {
    let material = vertex.material.as_deref().unwrap();
    Some(match material.split('\'').nth(1).unwrap() {
        "white" => DVec3::new(0.885809, 0.698859, 0.666422),
        "green" => DVec3::new(0.105421, 0.37798, 0.076425),
        "red" => DVec3::new(0.570068, 0.0430135, 0.0443706),
        "light" => DVec3::splat(0.78),
        "mirror" | "glass" => return None,
        other => panic!("{other}"),
    })
}

fn normal(vertex: &Vertex) -> DVec3 {
    DVec3::from(vertex.normal)
}

fn place(vertex: &Vertex) -> DVec3 {
    DVec3::from(vertex.position)
}

/// f |cos| / pdf of a direction, for radiance or for power, after a look at whether it may be gone in, and at the told density.
fn scattered(vertex: &Vertex, arrives: DVec3, leaves: DVec3, from_light: bool) -> DVec3 {
    let told = vertex.scatterings.first().unwrap();
    let n = normal(vertex);
    let weight = match albedo(vertex) {
        Some(albedo) => {
            let cosine = leaves.dot(n).abs();
            assert!((told.pdf - cosine / PI).abs() < 1e-4 && told.lobe == "broad", "{told:?}: cosine {cosine}");
            albedo
        }
        None if told.transmits => {
            // Snell's law: what lies along the surface is stretched by the ratio of indices.
            let along = |direction: DVec3| direction - n * direction.dot(n);
            let ratio = if arrives.dot(n) < 0.0 { 1.0 / 1.5 } else { 1.5 };
            assert!((along(leaves) - along(arrives) * ratio).length() < 1e-3, "{told:?}");
            DVec3::splat(if from_light { 1.0 } else { ratio * ratio })
        }
        None => {
            assert!(
                (leaves - (arrives - 2.0 * n * arrives.dot(n))).length() < 1e-3 && told.lobe == "delta",
                "{told:?}"
            );
            DVec3::ONE
        }
    };
    near("f |cos| / pdf", DVec3::from(told.weight), weight, 1e-4);
    weight
}

/// A subpath, followed from its vertices alone: the throughput at each, and the direction in which it arrives.
fn followed(path: &Subpath) -> Vec<(DVec3, DVec3)> {
    let mut at = DVec3::from(path.beginning.position);
    let mut told = DVec3::from(path.beginning.direction);
    let mut throughput = DVec3::ONE;
    let mut found = Vec::new();
    for (index, vertex) in path.vertices.iter().enumerate() {
        assert_eq!(vertex.index as usize, index + 1);
        let arrives = (place(vertex) - at).normalize();
        near("direction to the next vertex", told, arrives, 1e-3);
        near("towards the last vertex", DVec3::from(vertex.towards_previous), -arrives, 1e-3);
        near("throughput", DVec3::from(vertex.throughput), throughput, 1e-3);
        found.push((throughput, arrives));
        at = place(vertex);
        if let Some(scattering) = vertex.scatterings.first() {
            told = DVec3::from(scattering.direction);
            let leaves = path.vertices.get(index + 1).map_or(told, |next| (place(next) - at).normalize());
            throughput *= scattered(vertex, arrives, leaves, path.from_light);
        }
        throughput /= vertex.roulette.map_or(1.0, |roulette| roulette.survival);
    }
    found
}

/// What the lamp sends back along a direction that arrives there.
fn emitted(vertex: &Vertex, arrives: DVec3) -> DVec3 {
    assert!(vertex.material.as_deref().unwrap().starts_with("'light'"), "{vertex:?}");
    if arrives.dot(normal(vertex)) < 0.0 { LAMP } else { DVec3::ZERO }
}

fn heuristic(own: f64, other: f64) -> f64 {
    own * own / (own * own + other * other)
}

/// Light that reaches a diffuse vertex straight from a sample of the lamp, weighted.
fn lit(vertex: &Vertex, light: &LightSample) -> DVec3 {
    let direction = (DVec3::from(light.position.unwrap()) - place(vertex)).normalize();
    let cosine = direction.dot(normal(vertex)).max(0.0);
    let f_cos = albedo(vertex).unwrap() * cosine / PI;
    f_cos * LAMP / light.pdf * light.transmittance * heuristic(light.pdf, cosine / PI)
}

/// Form `primary`: emission that the path runs into and light samples, as `path` adds them.
fn value_of_primary(path: &Subpath) -> DVec3 {
    let mut value = DVec3::ZERO;
    let mut density: Option<f64> = None;
    for (vertex, (throughput, arrives)) in path.vertices.iter().zip(followed(path)) {
        if let Some(emission) = &vertex.emission {
            let weight = density.map_or(1.0, |density| heuristic(density, emission.light_pdf_w));
            value += throughput * emitted(vertex, arrives) * weight;
        }
        value += vertex.light_samples.iter().map(|light| throughput * lit(vertex, light)).sum::<DVec3>();
        let leaves = vertex.scatterings.first().map(|scattering| DVec3::from(scattering.direction));
        density = leaves.filter(|_| albedo(vertex).is_some()).map(|leaves| leaves.dot(normal(vertex)) / PI);
    }
    value
}

/// Form `paths`: the throughput up to the lamp, and what that emits.
fn value_of_path(path: &Subpath) -> DVec3 {
    let (throughput, arrives) = followed(path).pop().unwrap();
    let last = path.vertices.last().unwrap();
    let emission = last.emission.as_ref().unwrap();
    near("emission", DVec3::from(emission.radiance), LAMP, 1e-5);
    let before = path.vertices.len().checked_sub(2).map(|index| &path.vertices[index]);
    if before.is_some_and(|before| albedo(before).is_some()) {
        // The lamp's points are as likely: 1 / area, over solid angle as the vertex before sees it.
        let distance2 = (place(last) - place(before.unwrap())).length_squared();
        let expected = distance2 / (-arrives.dot(normal(last)) * LAMP_AREA);
        assert!((emission.light_pdf_w / expected - 1.0).abs() < 1e-3, "{emission:?}: {expected}");
    }
    throughput * emitted(last, arrives)
}

/// Pixels per solid angle in a direction of the camera, which looks along z.
fn importance(direction: DVec3) -> f64 {
    let pixel = 2.0 * tangent() / f64::from(SIDE);
    1.0 / (pixel * pixel * direction.z.powi(3))
}

/// Form `multiplexed` with a part from the light: the one strategy, from its two parts and their connection.
fn value_of_strategy(traced: &Trace, camera: &Subpath, light: &Subpath) -> DVec3 {
    let [strategy] = traced.strategies.as_slice() else { panic!("{:?}", traced.strategies) };
    assert_eq!([strategy.s, strategy.t], [light.vertices.len() as u32 + 1, camera.vertices.len() as u32 + 1]);
    let power = LAMP * (PI * LAMP_AREA);
    near("power", DVec3::from(light.beginning.power.unwrap()), power, 1e-4);
    let d = DVec3::from(camera.end()) - DVec3::from(light.end());
    let towards = d.normalize();
    // What leaves the light's part towards the camera's, with the cosine there.
    let leaving = match (light.vertices.last(), followed(light).last()) {
        (Some(y), Some((throughput, _))) => {
            power * throughput * albedo(y).unwrap() / PI * towards.dot(normal(y)).max(0.0)
        }
        _ => LAMP * LAMP_AREA * -towards.y,
    };
    let seen = match (camera.vertices.last(), followed(camera).last()) {
        (Some(z), Some((throughput, _))) => throughput * albedo(z).unwrap() / PI * (-towards).dot(normal(z)).max(0.0),
        _ => DVec3::splat(importance(-towards) / f64::from(SIDE * SIDE)),
    };
    let value = leaving * seen / d.length_squared();
    near("strategy", DVec3::from(strategy.contribution), value, 1e-3);
    assert!(strategy.mis_weight > 0.0 && strategy.mis_weight <= 1.0, "{strategy:?}");
    value * strategy.mis_weight
}

/// The value of what is told, before its share; and whether it is worked out from the vertices alone.
fn value(form: &str, traced: &Trace) -> (DVec3, bool) {
    match (form, traced.subpaths.as_slice()) {
        ("primary", [path]) => (value_of_primary(path), true),
        ("paths", [path]) => (value_of_path(path), true),
        ("multiplexed", [camera, light]) => (value_of_strategy(traced, camera, light), true),
        ("multiplexed", [path]) => {
            // What the camera finds by itself at each vertex.
            followed(path);
            let strategies = traced.strategies.iter();
            (strategies.map(|one| DVec3::from(one.contribution) * one.mis_weight).sum(), false)
        }
        _ => panic!("{:#?}", traced.subpaths),
    }
}

/// Some pixels whose brightest visit is of a proposal, or of the last one, and some where it is of a path that the chain has come to before that.
fn pixels(gpu: &Gpu, scene: &Scene, settings: &Settings) -> [Vec<u32>; 2] {
    let mut renderer = Renderer::new(gpu, scene, &Settings { records: 1 << 14, ..settings.clone() }).unwrap();
    let wanted = Wanted { kinds: 1 << RECORD_VISIT, sample: Some(SAMPLE), ..Wanted::NOTHING };
    renderer.want_records(&wanted).unwrap();
    while renderer.advance(SAMPLE + 1).unwrap() {}
    let (records, lost) = renderer.records().unwrap();
    assert_eq!(lost, 0);
    let added = |visit: &PathRecord| visit.throughput.iter().sum::<f32>();
    let mut brightest: BTreeMap<u32, PathRecord> = BTreeMap::new();
    for record in records {
        let of_pixel = brightest.entry(record.pixel).or_insert(record);
        if added(&record) > added(of_pixel) {
            *of_pixel = record;
        }
    }
    let is_earlier = |visit: &PathRecord| visit.vertex > 0 && visit.vertex + 1 < visit.t;
    let (earlier, others): (Vec<_>, Vec<_>) = brightest.into_iter().partition(|(_, visit)| is_earlier(visit));
    [others, earlier].map(|found| {
        let step = (found.len() / 8).max(1);
        found.into_iter().skip(step / 2).step_by(step).take(8).map(|(pixel, _)| pixel).collect()
    })
}

/// Looks at the told path of one pixel; returns whether it is worked out from its vertices, and of form `paths` perturbed from the camera.
fn look(form: &str, scene: &Scene, traced: &Trace) -> bool {
    let proposal = traced.proposal.as_ref().unwrap();
    let brightness = |value: [f64; 3]| value.iter().sum::<f64>();
    let told = traced.visits.iter().max_by(|a, b| brightness(a.value).total_cmp(&brightness(b.value))).unwrap();
    assert_eq!([proposal.chain, proposal.mutation], [told.chain, told.proposed_by]);
    assert!(if told.is_proposal { told.proposed_by == told.mutation } else { told.proposed_by < told.mutation });
    let camera = &traced.subpaths[0];
    let d = DVec3::from(camera.beginning.direction);
    let scale = f64::from(SIDE) / (2.0 * tangent() * d.z);
    let seen = [d.x, d.y].map(|across| f64::from(SIDE) / 2.0 - across * scale);
    for (seen, pixel) in seen.into_iter().zip(traced.pixel) {
        assert!((seen - f64::from(pixel) - 0.5).abs() < 0.501, "{seen} is not in {:?}", traced.pixel);
    }
    let (found, is_worked_out) = value(form, traced);
    near(form, found * proposal.share, DVec3::from(told.contribution), 1e-3);

    let words = text(traced);
    assert!(words.contains(proposal.sort) && words.contains("(told above)"), "{words}");
    let plan = svg(scene, traced, None).unwrap();
    let dashes = traced.subpaths.iter().flat_map(|path| &path.vertices).map(|vertex| vertex.light_samples.len());
    assert_eq!(plan.matches("dasharray").count(), dashes.sum::<usize>() + traced.subpaths.len() - 1, "{plan}");
    let is_from_camera = ["lens perturbation", "multi-chain perturbation"].contains(&proposal.sort);
    if is_from_camera {
        // What the camera sees first that is no mirror: where a mirror comes after it, the path was perturbed beyond.
        let mut vertices = camera.vertices.iter().skip_while(|vertex| albedo(vertex).is_none()).skip(1);
        let goes_on = vertices.next().is_some_and(|vertex| albedo(vertex).is_none());
        assert_eq!(proposal.sort == "multi-chain perturbation", goes_on, "{traced:#?}");
    }
    is_worked_out && (is_from_camera || form != "paths")
}

/// For each form, with diffuse walls, a mirror and glass: the path of the visit that adds most to a pixel, worked out from its vertices, is worth the
/// contribution of the visit; of some the chain has come there in an earlier sample.
#[test]
fn the_told_path_of_a_visit_gives_its_contribution() {
    with_gpu(|gpu| {
        let scene = canon("cornell_spheres.xml", &[]);
        for backend in backends_in_time(gpu) {
            for form in ["primary", "multiplexed", "paths"] {
                let mut settings = settings(&scene, &format!("mlt:form={form}:candidates=8192"), backend);
                (settings.width, settings.height) = (SIDE, SIDE);
                let request = |pixel: u32| Request { x: pixel % SIDE, y: pixel / SIDE, sample: SAMPLE };
                for pixels in pixels(gpu, &scene, &settings) {
                    // Of `multiplexed` not all paths can be worked out.
                    let mut looked = pixels
                        .into_iter()
                        .map(|pixel| look(form, &scene, &trace(gpu, &scene, &settings, request(pixel)).unwrap()));
                    assert!(looked.any(|is_worked_out| is_worked_out), "{form}");
                }
            }
        }
    });
}
