//! Rays that graze what they meet: at vertices, at edges, along axes; and what they find against a brute force in double precision.

use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

use super::Run;
use super::brute_force::{Tally, around, judge, rays, scene};
use super::figure::Figure;
use super::geometry::{Random, closed_cube, icosphere};
use crate::error::Result;
use crate::layout::backend::Backend;
use crate::layout::{HitRecord, RayRecord};
use crate::render::{Probe, Settings};
use crate::scene::{Scene, SceneBuilder};

fn ray(origin: Vec3, direction: DVec3) -> RayRecord {
    RayRecord { origin: origin.into(), direction: direction.normalize().as_vec3().into(), t_max: 3e38 }
}

/// From inside of closed meshes every ray hits, also those at their vertices and edges; and so does every ray along an axis
/// against a floor of squares along the axes, on their corners and edges.
pub(super) fn watertight(run: &mut Run) -> Result<()> {
    let count = run.pick(1_000_000, 100_000);
    let mut random = Random(3);
    let shift = DAffine3::from_translation(DVec3::new(0.37, -1.21, 3.3));
    let axes = [DVec3::X, DVec3::NEG_Y, DVec3::Z];
    for (name, mesh, map) in [
        ("cube", closed_cube(), DAffine3::IDENTITY),
        ("ball", icosphere(3), DAffine3::IDENTITY),
        ("shifted ball", icosphere(3), shift),
    ] {
        let mut builder = SceneBuilder::new(name);
        let surface = builder.matte([0.5; 3]);
        builder.mesh(0, name, mesh, map, surface);
        let scene = builder.finish()?;
        let rays: Vec<RayRecord> = (0..count)
            .map(|index| {
                let triangle = &scene.primitives[random.below(scene.primitives.len())];
                let [a, b] = [triangle.v0, triangle.v1].map(|v| Vec3::from(v).as_dvec3());
                let origin = map.transform_point3(random.in_cube(0.5)).as_vec3();
                let direction = match index % 6 {
                    0 | 3 => a - origin.as_dvec3(),
                    1 | 4 => a.lerp(b, random.next()) - origin.as_dvec3(),
                    2 => random.direction(),
                    _ => axes[index % 3],
                };
                ray(origin, direction)
            })
            .collect();
        let lost = lost(run, &scene, &rays)?;
        for (kind, what) in ["at vertices", "at edges", "elsewhere"].into_iter().enumerate() {
            let mine: Vec<_> = lost.iter().filter(|index| *index % 3 == kind).collect();
            let place = mine.first().map(|index| format!("ray {index}: {:?}", rays[**index])).unwrap_or_default();
            let what = format!("{name}: rays lost {what}, of {}", count / 3);
            let figure = Figure::at_most("trace", what, mine.len() as f64, 0.0).worst(place);
            if kind == 2 { run.note(figure) } else { run.note_of_driver(figure) }
        }
    }
    let mut builder = SceneBuilder::new("floor");
    let surface = builder.matte([0.5; 3]);
    for x in -4..4 {
        for z in -4..4 {
            builder.parallelogram(DVec3::new(f64::from(x), -4.0, f64::from(z)), DVec3::Z, DVec3::X, surface);
        }
    }
    let scene = builder.finish()?;
    // On a grid of half units, the floor's outline left out.
    let on_grid = |random: &mut Random| ((random.in_cube(7.0)).round() * 0.5).as_vec3();
    let rays: Vec<RayRecord> =
        (0..count / 10).map(|_| ray(Vec3 { y: random.next() as f32, ..on_grid(&mut random) }, DVec3::NEG_Y)).collect();
    let lost = lost(run, &scene, &rays)?;
    let place = lost.first().map(|index| format!("{:?}", rays[*index])).unwrap_or_default();
    let what = format!("floor of squares: rays along an axis lost, of {}", rays.len());
    run.note_of_driver(Figure::at_most("trace", what, lost.len() as f64, 0.0).worst(place));
    Ok(())
}

/// Those of the rays that one of the two questions finds nothing for.
fn lost(run: &Run, scene: &Scene, rays: &[RayRecord]) -> Result<Vec<usize>> {
    let hits: Vec<HitRecord> = run.probe(scene, "trace")?.run(rays)?;
    Ok((0..rays.len()).filter(|index| hits[*index].t < 0.0 || hits[*index].blocked == 0).collect())
}

/// Random rays, and ones aimed at vertices, edges and along the axes, in a scene of instances, spheres and slivers.
/// `bvh` also with its groups cut into chunks, each with a tree of its own.
pub(super) fn brute_force(run: &mut Run) -> Result<()> {
    let scene = scene()?;
    let settings = run.settings(&scene, "path")?;
    hold(run, &scene, "", &settings, run.pick(1_000_000, 100_000))?;
    for chunk in [1, 10].into_iter().take(if run.backend == Backend::Bvh { 2 } else { 0 }) {
        hold(
            run,
            &scene,
            &format!(" in chunks of {chunk}"),
            &Settings { chunk, ..settings.clone() },
            run.pick(50_000, 10_000),
        )?;
    }
    Ok(())
}

fn hold(run: &mut Run, scene: &Scene, how: &str, settings: &Settings, count: usize) -> Result<()> {
    let rays = rays(scene, count);
    let around = around(scene);
    let probe = Probe::new(run.gpu, scene, settings, "test/trace")?;
    let hits: Vec<HitRecord> = probe.run(&rays)?;
    let is_random = |index: usize| matches!(index % 8, 0 | 1 | 4);
    for (kind, random, most_near_outline) in [("random", true, 0.002), ("aimed", false, 0.05)] {
        let tally = rays
            .par_iter()
            .zip(&hits)
            .enumerate()
            .filter(|(index, _)| is_random(*index) == random)
            .fold(Tally::default, |mut tally, (_, (ray, hit))| {
                let primitive = probe.order().get(hit.primitive as usize).copied().unwrap_or(u32::MAX);
                let instance = probe.instance_order().get(hit.instance as usize).copied().unwrap_or(u32::MAX);
                judge((scene, &around), ray, hit, primitive, instance, &mut tally);
                tally
            })
            .reduce(Tally::default, Tally::add);
        let total = tally.same + tally.misses + tally.ties + tally.near_outline + tally.wrong.len();
        let place = tally.wrong.first().cloned().unwrap_or_default();
        run.note(
            Figure::at_most(
                "trace",
                format!("{kind} rays answered wrongly{how}, of {total}"),
                tally.wrong.len() as f64,
                0.0,
            )
            .worst(place),
        );
        let share = tally.near_outline as f64 / total as f64;
        run.note(Figure::at_most(
            "trace",
            format!("share of {kind} rays that differ within the rounding of an outline"),
            share,
            most_near_outline,
        ));
        let idle = f64::from(u8::from(tally.same <= total / 4));
        run.note(Figure::at_most("trace", format!("{kind} rays: too few hit anything"), idle, 0.0));
        run.note(Figure::told("trace", format!("{kind} rays that tie within 4 ulp"), tally.ties as f64));
    }
    Ok(())
}
