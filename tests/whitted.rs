//! Recursive ray tracing: what it accounts for, that branching changes no mean, and its two kinds of lights.

use crate::common::{assert_same_mean, backends_in_time, render, room, settings, with_gpu};
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::Scene;

/// Where everything that scatters does so this weakly, light that was scattered twice is lost in the noise.
const FAINT: &str = "<bsdf type='diffuse'><rgb name='reflectance' value='0.002, 0.001, 0.002'/></bsdf>";

/// A camera over a floor with a mirror, a ball of glass, a sheet of it and a coated block, and two lights that no direction hits.
fn mirrors_and_glass() -> Scene {
    let faint_plastic = "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.002, 0.001, 0.002'/></bsdf>";
    room::scene(&format!(
        "<sensor type='perspective'><float name='fov' value='50'/>
            <transform name='to_world'><lookat origin='0.3, 2.2, 5' target='0, 0.6, 0' up='0, 1, 0'/></transform>
            <film type='hdrfilm'><integer name='width' value='64'/><integer name='height' value='48'/><rfilter type='box'/></film></sensor>
         <emitter type='point'><point name='position' x='1.5' y='3' z='2'/><rgb name='intensity' value='9000, 9000, 8000'/></emitter>
         <emitter type='spot'><rgb name='intensity' value='5000, 9000, 9000'/><float name='cutoff_angle' value='60'/>
            <transform name='to_world'><lookat origin='-2, 3, 1' target='0, 0, 0' up='0, 0, 1'/></transform></emitter>
         <shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate x='1' angle='-90'/></transform>{FAINT}</shape>
         <shape type='rectangle'><transform name='to_world'><scale value='2'/><translate y='1' z='-1.6'/></transform><bsdf type='conductor'/></shape>
         <shape type='rectangle'><transform name='to_world'><scale value='0.7'/><translate x='-1.2' y='0.8' z='1.4'/></transform>
            <bsdf type='thindielectric'/></shape>
         <shape type='cube'><transform name='to_world'><scale value='0.4'/><translate x='-0.8' y='0.42'/></transform>{faint_plastic}</shape>
         <shape type='sphere'><point name='center' x='0.7' y='0.7' z='0.4'/><float name='radius' value='0.6'/><bsdf type='dielectric'/></shape>"
    ))
}

#[test]
fn chains_of_mirrors_and_glass_end_in_direct_light() {
    let scene = mirrors_and_glass();
    with_gpu(|gpu| {
        for backend in backends_in_time(gpu) {
            let film = |technique: &str, seed: u32, spp: u32| {
                let settings = Settings { seed, ..settings(&scene, technique, backend) };
                render(gpu, &scene, &settings, spp)
            };
            let path = film("path", 1, 2048);
            let both = film("whitted", 2, 256);
            let one = film("whitted:branches=one", 3, 1024);
            for (name, measured) in [("both branches", &both), ("one branch", &one)] {
                assert_same_mean(&format!("{name} on {}", backend.name()), measured, &path, 16);
            }
            // A sample that follows both branches leaves only what lies within a pixel to chance: nothing within the ball.
            let noise =
                |film: &Film, spp: f32| film.mean_variance().pixels.iter().map(|v| spp * v[1]).collect::<Vec<_>>();
            let pairs = noise(&both, 256.0).into_iter().zip(noise(&one, 1024.0));
            let calmer = pairs.filter(|(both, one)| *both < 0.2 * one).count();
            println!("{}: {calmer} pixels have less than a fifth of the variance", backend.name());
            assert!(calmer > 60, "{calmer}");
        }
    });
}

#[test]
fn light_that_was_scattered_twice_is_left_out() {
    // Among surfaces that only scatter, what is left is direct lighting.
    let scene = room::scene(&format!(
        "<sensor type='perspective'><transform name='to_world'><lookat origin='0, 2, 5' target='0, 0.8, 0' up='0, 1, 0'/></transform>
            <film type='hdrfilm'><integer name='width' value='48'/><integer name='height' value='48'/></film></sensor>{}{}",
        room::room("<bsdf type='diffuse'/>", "<bsdf type='diffuse'/>"),
        room::LAMP
    ));
    with_gpu(|gpu| {
        for backend in backends_in_time(gpu) {
            let direct = render(gpu, &scene, &settings(&scene, "direct", backend), 1024);
            for technique in ["whitted", "whitted:shadow-rays=7"] {
                let found = render(gpu, &scene, &Settings { seed: 4, ..settings(&scene, technique, backend) }, 256);
                assert_same_mean(&format!("{technique} on {}", backend.name()), &found, &direct, 16);
            }
        }
    });
}

/// A point stands for all of a lamp: a floor under it has rho / pi times intensity, cosine and one over the squared distance of the middle,
/// however near it is (Goral et al. 1984 call that the point-source approximation). Near lamps are sampled by solid angle otherwise.
#[test]
fn the_middle_stands_for_the_lamp() {
    const RHO: f64 = 0.5; // Mitsuba's default
    let floor = "<shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate x='1' angle='-90'/></transform><bsdf type='diffuse'/></shape>
        <sensor type='orthographic'><transform name='to_world'><scale value='0.5'/><lookat origin='0.7, 0.2, 0.4' target='0.7, 0, 0.4' up='0, 0, 1'/></transform>
            <film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/><rfilter type='box'/></film></sensor>";
    let ball = "<shape type='sphere'><point name='center' x='0' y='1.5' z='0'/><float name='radius' value='0.7'/>
        <emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>";
    // A rectangle is two triangles: their centroids lie a third of its half diagonals off its middle.
    let square = "<shape type='rectangle'><transform name='to_world'><scale value='1.2'/><rotate x='1' angle='90'/><translate y='1.5'/></transform>
        <emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>";
    let area = 1.2 * 1.2 * 2.0; // of one triangle
    let (x, z) = (0.7, 0.4);
    let of_point = |at: [f64; 3], intensity: &dyn Fn(f64) -> f64| {
        let d2 = (at[0] - x).powi(2) + at[1].powi(2) + (at[2] - z).powi(2);
        let cosine = at[1] / d2.sqrt();
        RHO / std::f64::consts::PI * intensity(cosine) * cosine / d2
    };
    let expected_of_ball = of_point([0.0, 1.5, 0.0], &|_| 5.0 * std::f64::consts::PI * 0.49);
    let by_diagonal = [[0.4, -0.4], [0.4, 0.4]].map(|[a, b]| {
        [[a, 1.5, b], [-a, 1.5, -b]].map(|at| of_point(at, &|cosine| 5.0 * area * cosine)).iter().sum::<f64>()
    });
    with_gpu(|gpu| {
        for backend in backends_in_time(gpu) {
            let found = |lamp: &str| {
                let scene = room::scene(&[floor, lamp].concat());
                let film = render(gpu, &scene, &settings(&scene, "whitted:lights=point", backend), 256);
                // The middle of the image: within a pixel of it the light is as good as linear.
                let [_, measured, _] = crate::common::tile_average(&film, 7..9, 7..9);
                measured.mean
            };
            let ball = found(ball);
            println!("{}: {ball} under a ball, {expected_of_ball} by its middle", backend.name());
            assert!((ball / expected_of_ball - 1.0).abs() < 3e-3, "{ball} against {expected_of_ball}");
            let square = found(square);
            println!("{}: {square} under a square, {by_diagonal:?} by the middles of its halves", backend.name());
            assert!(by_diagonal.iter().any(|expected| (square / expected - 1.0).abs() < 1e-2), "{square}");
        }
    });
}

#[test]
fn lights_of_one_point_have_sharp_shadows() {
    // Orthographic pixels on a floor under one large triangle and a block: with the whole lamp the block has a penumbra, with its middle
    // alone every pixel is lit or dark but for those that the shadow's edge crosses.
    let scene = room::scene(
        "<sensor type='orthographic'><transform name='to_world'><scale value='1.5'/><lookat origin='0, 1, 0' target='0, 0, 0' up='0, 0, 1'/></transform>
            <film type='hdrfilm'><integer name='width' value='64'/><integer name='height' value='64'/><rfilter type='box'/></film></sensor>
         <shape type='rectangle'><transform name='to_world'><scale value='4'/><rotate x='1' angle='-90'/></transform><bsdf type='diffuse'/></shape>
         <shape type='sphere'><point name='center' x='0' y='1.6' z='0'/><float name='radius' value='0.3'/><bsdf type='diffuse'/></shape>
         <shape type='sphere'><point name='center' x='0' y='6' z='0'/><float name='radius' value='1.5'/>
            <emitter type='area'><rgb name='radiance' value='5'/></emitter></shape>",
    );
    with_gpu(|gpu| {
        for backend in backends_in_time(gpu) {
            let partly = |technique: &str| {
                let film = render(gpu, &scene, &settings(&scene, technique, backend), 64);
                let mut values: Vec<f32> = film.mean().pixels.iter().map(|pixel| pixel[0]).collect();
                let dark = values.iter().filter(|value| **value < 1e-3).count();
                values.sort_by(f32::total_cmp);
                let lit = values[values.len() * 9 / 10];
                (dark, values.iter().filter(|value| **value >= 1e-3 && **value < 0.7 * lit).count())
            };
            let (area, point) = (partly("whitted"), partly("whitted:lights=point"));
            println!(
                "{}: dark and partly lit pixels: {area:?} under the lamp, {point:?} under a point of it",
                backend.name()
            );
            assert!(point.1 * 4 < area.1 && point.0 > 2 * area.0, "{area:?} {point:?}");
        }
    });
}
