//! Furnaces: closed surfaces that emit Le and reflect the share r look the same everywhere, L = Le / (1 - r), whatever their shape,
//! and paths of k segments contribute Le r^(k - 1) of it.

use glam::{DAffine3, DVec3};

use super::Run;
use super::comparison::{average, differing};
use super::figure::{Figure, Worst};
use super::geometry::{closed_cube, glowing, icosphere, inside_out, look};
use crate::error::Result;
use crate::layout::backend::Backend;
use crate::render::Settings;
use crate::scene::{Mesh, Scene, SceneBuilder};
use crate::statistics::Estimate;
use crate::techniques::Solves;

/// One albedo for each channel; radiances of 2, 4/3 and 4.
const ALBEDO: [f32; 3] = [0.5, 0.25, 0.75];
const EYE: DVec3 = DVec3::new(0.3, -0.2, 0.1);
const TARGET: DVec3 = DVec3::new(-1.0, 0.4, -0.3);

fn radiance(channel: usize) -> f64 {
    1.0 / (1.0 - f64::from(ALBEDO[channel]))
}

/// The inside of a mesh, placed and seen by a camera that is placed with it.
fn inside(mesh: Mesh, place: DAffine3) -> Result<Scene> {
    let mut builder = SceneBuilder::new("furnace");
    let wall = glowing(&mut builder, ALBEDO, [1.0; 3]);
    builder.mesh(0, "furnace", inside_out(mesh), place, wall);
    look(&mut builder, 32, place.transform_point3(EYE), place.transform_point3(TARGET), 80.0)?;
    builder.finish()
}

fn ball() -> Result<Scene> {
    let mut builder = SceneBuilder::new("furnace");
    let wall = glowing(&mut builder, ALBEDO, [1.0; 3]);
    builder.sphere(0, "furnace", DVec3::ZERO, -1.0, wall);
    look(&mut builder, 32, EYE, TARGET, 80.0)?;
    builder.finish()
}

/// A sphere and a cube, by every unbiased technique and by path length.
pub(super) fn furnace(run: &mut Run) -> Result<()> {
    const LAYERS: u32 = 6;
    for (shape, scene) in [("sphere", ball()?), ("cube", inside(closed_cube(), DAffine3::IDENTITY)?)] {
        for row in run.unbiased() {
            let settings = Settings { lengths: LAYERS, ..run.settings(&scene, row.name)? };
            // Paths from the lights come to a pixel by chance, and need them all for the layers.
            let spp = if row.splats() { run.pick(768, 256) } else { run.samples(512, 256) };
            let film = run.render(&scene, &settings, spp)?;
            let most = if row.solves < Solves::Everything { 2 } else { u32::MAX };
            for (channel, albedo) in ALBEDO.into_iter().enumerate() {
                let expected = if most == 2 { 1.0 + f64::from(albedo) } else { radiance(channel) };
                run.mean(row.name, &format!("{shape}, channel {channel}"), &film, channel, expected);
            }
            for layer in 0..LAYERS {
                // The last layer takes all longer paths: the rest of the geometric series.
                let r = f64::from(ALBEDO[0]);
                let expected = match layer {
                    _ if layer >= most => 0.0,
                    _ if layer + 1 == LAYERS => r.powi(layer as i32) / (1.0 - r),
                    _ => r.powi(layer as i32),
                };
                let pixels = film.length(layer as usize).pixels;
                let found = Estimate::of(&pixels.iter().map(|pixel| f64::from(pixel[0])).collect::<Vec<_>>());
                let what = format!("{shape}, {} segments", layer + 1);
                if expected == 0.0 {
                    run.note(Figure::at_most(row.name, what, found.mean, 0.0));
                } else {
                    run.estimate(row.name, &what, found, expected, 1e-3, String::new());
                }
            }
        }
    }
    Ok(())
}

/// The worst of many placements: relative to the bound of 0.1 % or three standard deviations, whichever is more.
struct Placements {
    worst: Worst,
    failed: Vec<String>,
}

impl Placements {
    fn see(&mut self, place: &str, found: Estimate, expected: f64) {
        let bound = (1e-3 * expected).max(3.0 * found.variance.sqrt());
        let share = (found.mean - expected).abs() / bound;
        if share > 1.0 || share.is_nan() {
            self.failed.push(place.to_owned());
        }
        self.worst.see(share, || format!("{place}: {:.5} against {expected}", found.mean));
    }

    fn figure(self, what: &str) -> Figure {
        let first =
            self.failed.first().map_or(String::from("none fails"), |place| format!("the first that fails: {place}"));
        let mut figure = self.worst.figure("path", format!("{what}: off, in bounds"), 1.0);
        figure.worst = format!("{}; {first}", figure.worst);
        figure
    }
}

/// The cube at scales 10^-6 to 10^6, and at distances of 2^0 to 2^20 of its size from the origin.
pub(super) fn far_huge_tiny(run: &mut Run) -> Result<()> {
    let spp = run.pick(64, 32);
    let place = |run: &mut Run, what: &str, all: Vec<(String, Scene)>| -> Result<()> {
        let mut found = Placements { worst: Worst::default(), failed: Vec::new() };
        for (name, scene) in all {
            let film = run.render(&scene, &run.settings(&scene, "path")?, spp)?;
            for channel in 0..3 {
                found.see(&name, average(&film)[channel], radiance(channel));
            }
        }
        run.note(found.figure(what));
        Ok(())
    };
    let powers: Vec<i32> = run.pick((-6..=6).collect(), vec![-6, 6]);
    let scaled = powers.iter().map(|k| {
        let scale = DAffine3::from_scale(DVec3::splat(10f64.powi(*k)));
        Ok((format!("10^{k}"), inside(closed_cube(), scale)?))
    });
    place(run, "scaled by 10^-6 to 10^6", scaled.collect::<Result<_>>()?)?;
    let steps: Vec<i32> = run.pick((0..=20).collect(), vec![10, 20]);
    let towards = DVec3::new(0.7, -0.5, 0.3);
    let shifted = steps.iter().map(|j| {
        let shift = DAffine3::from_translation(towards * 2f64.powi(*j));
        Ok((format!("2^{j}"), inside(closed_cube(), shift)?))
    });
    place(run, "shifted by 2^0 to 2^20", shifted.collect::<Result<_>>()?)
}

/// Walls that lie on each other: glowing ones that are there twice, and dark ones around a lamp that are there twice and once more, cut
/// another way. Which of them a ray meets changes nothing, and two runs are the same bits.
pub(super) fn coplanar(run: &mut Run) -> Result<()> {
    let spp = run.samples(512, 128);
    let mut twice = inside_out(closed_cube());
    let again = twice.triangles.clone();
    twice.triangles.extend(again);
    let mut builder = SceneBuilder::new("furnace");
    let wall = glowing(&mut builder, ALBEDO, [1.0; 3]);
    builder.mesh(0, "furnace", twice.clone(), DAffine3::IDENTITY, wall);
    builder.mesh(0, "furnace again", inside_out(closed_cube()), DAffine3::IDENTITY, wall);
    look(&mut builder, 32, EYE, TARGET, 80.0)?;
    let scene = builder.finish()?;
    let settings = run.settings(&scene, "path")?;
    let films = [run.render(&scene, &settings, spp)?, run.render(&scene, &settings, spp)?];
    for channel in 0..3 {
        run.mean("path", &format!("glowing walls, channel {channel}"), &films[0], channel, radiance(channel));
    }
    run.note(Figure::at_most("path", "pixels that differ between two runs", differing(&films[0], &films[1]), 0.0));
    let room = |walls: &[Mesh]| {
        let mut builder = SceneBuilder::new("room");
        let wall = glowing(&mut builder, ALBEDO, [0.0; 3]);
        for mesh in walls {
            builder.mesh(0, "wall", inside_out(mesh.clone()), DAffine3::IDENTITY, wall);
        }
        let light = glowing(&mut builder, ALBEDO, [1.0; 3]);
        builder.sphere(0, "lamp", DVec3::new(0.2, 0.5, -0.4), 0.3, light);
        look(&mut builder, 32, EYE, TARGET, 80.0)?;
        builder.finish()
    };
    let mut cut = closed_cube();
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    cut.triangles = faces.iter().flat_map(|[a, b, c, d]| [[*b, *c, *d], [*b, *d, *a]]).collect();
    let (once, thrice) = (room(&[closed_cube()])?, room(&[closed_cube(), closed_cube(), cut])?);
    let settings = run.settings(&once, "path")?;
    let a = run.render(&once, &settings, spp)?;
    let b = run.render(&thrice, &Settings { seed: 1, ..settings }, spp)?;
    run.same("path", "dark walls three times against once", &a, &b, 8);
    Ok(())
}

/// Triangles without area, in a line, twice the same vertex, or coordinates that are no numbers, beside the sound ones.
pub(super) fn degenerate(run: &mut Run) -> Result<()> {
    let clean = icosphere(2);
    let mut spoilt = clean.clone();
    let v = |index: usize| clean.positions[index];
    let first = spoilt.positions.len() as u32;
    spoilt.positions.extend([v(0), v(0).lerp(v(1), 0.5), v(1), DVec3::splat(f64::NAN), v(2), v(2), v(2)]);
    let bad = [[0, 0, 1], [first, first + 1, first + 2], [first + 4, first + 5, first + 6], [3, 3, 3], [7, 8, 7]];
    spoilt.triangles.extend(bad);
    let of = |mesh: Mesh| inside(mesh, DAffine3::IDENTITY);
    let mut with_nan = spoilt.clone();
    with_nan.triangles.push([0, 1, first + 3]);
    let refused = of(with_nan).err().map(|error| error.to_string());
    let named = refused.as_deref().is_some_and(|message| message.contains("finite"));
    run.note(
        Figure::at_most("loading", "coordinates that are no numbers and are let in", f64::from(u8::from(!named)), 0.0)
            .worst(refused.unwrap_or_default()),
    );
    spoilt.positions[first as usize + 3] = DVec3::ZERO;
    let (clean, spoilt) = (of(clean)?, of(spoilt)?);
    let told = spoilt.warnings.iter().any(|warning| warning.starts_with("5 of 325 triangles"));
    run.note(
        Figure::at_most("loading", "degenerate triangles that are not reported", f64::from(u8::from(!told)), 0.0)
            .worst(spoilt.warnings.join("; ")),
    );
    let film = |run: &mut Run, scene: &Scene| run.render(scene, &run.settings(scene, "path")?, 64);
    let (a, b) = (film(run, &clean)?, film(run, &spoilt)?);
    run.note(Figure::at_most("path", "pixels that differ from the cleaned mesh", differing(&a, &b), 0.0));
    for channel in 0..3 {
        run.mean("path", &format!("channel {channel}"), &b, channel, radiance(channel));
    }
    Ok(())
}

/// A camera next to nothing off a wall looks away from it and along it.
pub(super) fn touching(run: &mut Run) -> Result<()> {
    let mut found = Placements { worst: Worst::default(), failed: Vec::new() };
    for gap in [1e-7, 1e-6, 1e-5, 1e-3] {
        for (name, at) in [("away", DVec3::new(-1.0, 0.2, 0.1)), ("along", DVec3::new(0.6, 0.9, -0.4))] {
            let mut builder = SceneBuilder::new("furnace");
            let wall = glowing(&mut builder, ALBEDO, [1.0; 3]);
            builder.mesh(0, "furnace", inside_out(closed_cube()), DAffine3::IDENTITY, wall);
            look(&mut builder, 32, DVec3::new(1.0 - gap, 0.1, 0.2), at, 40.0)?;
            let scene = builder.finish()?;
            let film = run.render(&scene, &run.settings(&scene, "path")?, run.pick(64, 32))?;
            found.see(&format!("{gap:e} off, looking {name}"), average(&film)[0], radiance(0));
        }
    }
    run.note(found.figure("the mean"));
    Ok(())
}

/// Radiance 1 at this albedo, seen from inside of a sphere.
fn bright(albedo: f64) -> Result<Scene> {
    let mut builder = SceneBuilder::new("furnace");
    let wall = glowing(&mut builder, [albedo as f32; 3], [1.0 - f64::from(albedo as f32); 3]);
    builder.sphere(0, "furnace", DVec3::ZERO, -1.0, wall);
    look(&mut builder, 16, DVec3::new(0.1, 0.2, 0.3), DVec3::X, 60.0)?;
    builder.finish()
}

/// Russian roulette against 1, and against paths that are followed for 2000 segments.
///
/// With a constant probability q of ending, a path's weight grows by r / (1 - q) per vertex and its second moment by r^2 / (1 - q):
/// beyond r^2 = 1 - q the variance is infinite. So q = 0.1 is tried at an albedo of 0.9, and 0.99 is left to small q and to roulette
/// on throughput, which has no such limit.
pub(super) fn roulette(run: &mut Run) -> Result<()> {
    let all = [
        (0.99, "path", 1, 1000),
        (0.99, "path", 2000, 200),
        (0.99, "path-implicit:q=0.01", 1, 2500),
        (0.9, "path", 1, 1000),
        (0.9, "path-implicit", 1, 2500),
        (0.9, "path-implicit:q=0.02", 1, 1000),
        (0.9, "light", 1, 1000),
        (0.9, "bdpt", 1, 200),
        (0.99, "bdpt", 1, 450),
    ];
    let splats = |technique: &str| technique == "light" || technique == "bdpt";
    let on_bvh = run.backend == Backend::Bvh;
    for (albedo, technique, rr_depth, spp) in all.into_iter().take(run.pick(9, 3)) {
        if splats(technique) && !on_bvh {
            continue;
        }
        let scene = bright(albedo)?;
        let settings = Settings { rr_depth, max_depth: Some(2000), ..run.settings(&scene, technique)? };
        let film = run.render(&scene, &settings, run.samples(spp, spp / 2))?;
        run.mean(technique, &format!("albedo {albedo}, roulette from {rr_depth} segments"), &film, 0, 1.0);
    }
    Ok(())
}

/// Paths of ten thousand bounces: the contribution of an albedo of 0.9999 after them is a third of all. Without a limit the albedo is 0.999, for
/// then paths of more than that, which roulette ends faster so that they end at all, are one in 20000.
pub(super) fn bounces(run: &mut Run) -> Result<()> {
    const ALBEDO: f64 = 0.9999;
    let scene = bright(ALBEDO)?;
    let settings = Settings { rr_depth: 20_000, max_depth: Some(10_000), ..run.settings(&scene, "path")? };
    let film = run.render(&scene, &settings, run.pick(4, 1))?;
    run.mean("path", "the first 10^4 segments", &film, 0, 1.0 - f64::from(ALBEDO as f32).powi(10_000));
    let scene = bright(0.999)?;
    let film = run.render(&scene, &run.settings(&scene, "path")?, run.pick(128, 32))?;
    run.mean_within("path", "no limit, roulette on throughput, albedo 0.999", &film, 0, 1.0, 1e-2);
    Ok(())
}
