//! Lights that are small, far, bright, or a sun: irradiance of a patch, whose radiance is albedo / pi times it.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

use super::expectations::{polygon_irradiance, triangle_solid_angle};
use super::figure::{Figure, Worst};
use super::formulas::patch_under;
use super::geometry::{lamp, polygon};
use super::sampling::spread;
use super::{Run, room};
use crate::error::Result;
use crate::image::{Texels, TextureImage};
use crate::layout::backend::Backend;
use crate::layout::{LightAnswer, LightQuery};
use crate::render::Settings;
use crate::scene::texture::{Pattern, TextureDescription, Wrap};
use crate::scene::{Scene, SceneBuilder};

/// Every technique that aims at lights (and, where `found` by chance, those that do not) gives albedo / pi times the irradiance.
fn patch(run: &mut Run, what: &str, scene: &Scene, expected: f64, spp: u32) -> Result<()> {
    let aimed = run.thorough(scene).into_iter().filter(|technique| *technique != "path-implicit");
    let direct = run.pick(vec!["direct", "direct:sampling=emitter"], Vec::new());
    for technique in aimed.chain(direct).collect::<Vec<_>>() {
        let settings = Settings { max_depth: Some(2), ..run.settings(scene, technique)? };
        let film = run.render(scene, &settings, spp)?;
        run.mean(technique, what, &film, 0, 0.5 / PI * expected);
    }
    Ok(())
}

/// A square that is a millionth of the scene's size.
pub(super) fn millionth(run: &mut Run) -> Result<()> {
    let side = 2e-6;
    let scene = patch_under(|builder, surface| {
        let half = side / 2.0;
        let v = |x: f64, z: f64| DVec3::new(0.3 + x, 1.0, 0.2 + z);
        polygon(builder, &[v(-half, -half), v(-half, half), v(half, half), v(half, -half)], surface);
        let dark = builder.matte([0.0; 3]);
        builder.parallelogram(DVec3::new(-1.0, -0.01, -1.0), DVec3::Z * 2.0, DVec3::X * 2.0, dark);
    })?;
    let d = DVec3::new(0.3, 1.0, 0.2);
    // E = L A cos^2 / d^2, of which the square's extent changes 1e-12. Its sides are those of its corners in single precision.
    let side_of = |middle: f64| f64::from((middle + side / 2.0) as f32) - f64::from((middle - side / 2.0) as f32);
    let expected = side_of(0.3) * side_of(0.2) * d.normalize().y.powi(2) / d.length_squared();
    patch(run, "a square of side 2e-6", &scene, expected, 500)
}

/// A radiance of 10^8: the room's image is 10^8 times as bright and nothing else.
pub(super) fn bright(run: &mut Run) -> Result<()> {
    let (plain, bright) =
        (room::scaled(room::MATTE, room::MATTE, 32, 1.0, 1.0)?, room::scaled(room::MATTE, room::MATTE, 32, 1.0, 1e8)?);
    let all = if run.backend == Backend::Bvh { vec!["path", "light", "bdpt", "vcm", "photon"] } else { vec!["path"] };
    for technique in run.pick(all, vec!["path", "light"]) {
        let settings = run.settings(&plain, technique)?;
        let (a, b) = (run.render(&plain, &settings, 16)?.mean(), run.render(&bright, &settings, 16)?.mean());
        let mut worst = Worst::default();
        for (pixel, (a, b)) in a.pixels.iter().zip(&b.pixels).enumerate() {
            for (channel, (a, b)) in a.iter().zip(b).enumerate() {
                let (a, b) = (f64::from(*a), f64::from(*b) * 1e-8);
                worst.see((a - b).abs() / a.max(1e-3), || {
                    format!("pixel ({}, {}), channel {channel}: {a} and {b}", pixel % 32, pixel / 32)
                });
            }
        }
        run.note(worst.figure(technique, "a pixel against 10^8 times the plain one, relative", 1e-5));
    }
    Ok(())
}

/// Suns: a ball of half a degree far away, and one texel of an image of the sky.
pub(super) fn suns(run: &mut Run) -> Result<()> {
    // E = pi L sin^2(half the angle) cos.
    let sine = 0.25f64.to_radians().sin();
    let towards = DVec3::new(0.4, 0.8, -0.3).normalize();
    for distance in [10.0, 1e5] {
        let scene =
            patch_under(|builder, surface| builder.sphere(0, "sun", towards * distance, distance * sine, surface))?;
        let expected = PI * sine * sine * towards.y;
        patch(run, &format!("a ball of half a degree at {distance}"), &scene, expected, 500)?;
    }
    let (width, height) = (512usize, 256usize);
    let (column, row) = (200, 60);
    let scene = patch_under(|builder, _| {
        let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
        texels[row * width + column] = [1.0; 4];
        let image = builder.image(TextureImage {
            source: "sky".into(),
            width: width as u32,
            height: height as u32,
            texels: Texels::Float(texels),
        });
        let wrap = [Wrap::Repeat, Wrap::Clamp];
        let texture = builder.texture(TextureDescription { wrap, ..TextureDescription::new(Pattern::Image(image)) });
        builder.background = Some([1e5; 3]);
        builder.environment = Some((texture, DMat3::IDENTITY));
    })?;
    // The texel is a tent two texels wide: by the midpoint rule.
    const STEPS: usize = 400;
    let mut expected = 0.0;
    for j in 0..STEPS {
        for i in 0..STEPS {
            let step = |index: usize| 2.0 * (index as f64 + 0.5) / STEPS as f64 - 1.0;
            let (s, t) = (step(i), step(j));
            let tent = (1.0 - s.abs()) * (1.0 - t.abs());
            let theta = PI * (row as f64 + 0.5 + t) / height as f64;
            let cell = (2.0 / STEPS as f64).powi(2) * TAU / width as f64 * PI / height as f64;
            expected += 1e5 * tent * theta.sin() * theta.cos() * cell;
        }
    }
    patch(run, "one texel of a sky", &scene, expected, run.pick(4000, 1500))
}

/// Squares of solid angles from 1e-10 to 6.28, across the switch between ways of sampling.
pub(super) fn small_and_far(run: &mut Run) -> Result<()> {
    let v = DVec3::new;
    let corners = [v(-1.0, -1.0, 0.0), v(-1.0, 1.0, 0.0), v(1.0, 1.0, 0.0), v(1.0, -1.0, 0.0)];
    let mut builder = SceneBuilder::new("square");
    let surface = lamp(&mut builder, [1.0; 3]);
    builder.parallelogram(corners[0], corners[1] - corners[0], corners[3] - corners[0], surface);
    let scene = builder.finish()?;
    let probe = run.probe(&scene, "light")?;
    let numbers = spread::<4>(1 << run.pick(15, 13));
    let distances = [
        0.002, 0.02, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 35.0, 40.0, 43.0, 44.0, 44.5, 45.0, 46.0, 50.0, 60.0, 63.0,
        64.0, 100.0, 1e3, 2e4, 2e5,
    ];
    let mut worst = Worst::default();
    for distance in distances {
        for aside in [0.0, 0.45] {
            let point = v(0.3 + aside * distance, -0.2, -distance);
            let normal = v(0.2, -0.1, 1.0).normalize();
            let [a, b, c, d] = corners.map(|corner| corner - point);
            let omega = triangle_solid_angle(a, b, c) + triangle_solid_angle(a, c, d);
            let expected = polygon_irradiance(&corners, point, normal);
            let from = (point - scene.origin).as_vec3().to_array();
            let ask = |u: &[f32; 4]| LightQuery { point: from, direction: [0.0, 0.0, 1.0], normal: [0.0; 3], u: *u };
            let answers: Vec<LightAnswer> = probe.run(&numbers.iter().map(ask).collect::<Vec<_>>())?;
            let (mut sum, mut squares) = (0.0, 0.0);
            for answer in answers.iter().filter(|answer| answer.visible != 0) {
                let wi = DVec3::from(answer.wi.map(f64::from));
                let value = f64::from(answer.weight[1]) * wi.dot(normal).max(0.0);
                (sum, squares) = (sum + value, squares + value * value);
            }
            let n = numbers.len() as f64;
            let (mean, sigma) = (sum / n, ((squares / n - (sum / n).powi(2)).max(0.0) / n).sqrt());
            let bound = (1e-3f64).max(3.0 * sigma / expected);
            let off = (mean - expected).abs() / expected / bound;
            worst.see(off, || format!("{omega:.2e} sr: {mean:.6e} against {expected:.6e}"));
        }
    }
    run.note(worst.figure("light", "irradiance off Lambert's, in bounds of 0.1 % or 3 sigma", 1.0));
    Ok(())
}

/// Scenes in millimetres and in kilometres are the image of the scene in metres: what rounding sends another way is far below the noise.
pub(super) fn units(run: &mut Run) -> Result<()> {
    let all = if run.backend == Backend::Bvh { vec!["path", "vcm"] } else { vec!["path"] };
    for technique in run.pick(all, vec!["path"]) {
        let film = |run: &mut Run, scale: f64, seed: u32| {
            let scene = room::scaled(room::MATTE, room::ROUGH_METAL, 32, scale, 1.0)?;
            let settings = Settings { seed, ..run.settings(&scene, technique)? };
            Ok::<_, crate::Error>(run.render(&scene, &settings, 64)?.mean())
        };
        let (one, other) = (film(run, 1.0, 0)?, film(run, 1.0, 1)?);
        let noise = crate::image::metrics::compare(&one, &other)?.relmse;
        for (unit, scale) in
            [("millimetres", 1e3), ("kilometres", 1e-3), ("tenths of millimetres", 1e4), ("tens of kilometres", 1e-4)]
        {
            let difference = crate::image::metrics::compare(&film(run, scale, 0)?, &one)?.relmse;
            run.note(Figure::at_most(
                technique,
                format!("in {unit}: relMSE as a share of the noise's"),
                difference / noise,
                0.02,
            ));
        }
    }
    Ok(())
}
