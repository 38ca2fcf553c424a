//! Every technique that can solve a case, on every backend, against what is known in closed form.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::PI;

use common::{assert_mean, average, backends, backends_for, canon, render, settings, with_gpu};
use glam::{DAffine3, DVec3};
use lumbre::integrator::{Bias, INTEGRATORS, Integrator, Solves};
use lumbre::metrics::stats::Estimate;
use lumbre::render::Technique;
use lumbre::scene::{Camera, Mesh, Scene, SceneBuilder, SurfaceDescription, material};

/// The techniques that account for everything.
fn complete() -> impl Iterator<Item = &'static Integrator> {
    unbiased().filter(|row| row.solves == Solves::Everything)
}

/// Those whose expectation is a closed form. What is only consistent has tests of its own.
fn unbiased() -> impl Iterator<Item = &'static Integrator> {
    INTEGRATORS.iter().filter(|row| row.bias == Bias::Unbiased)
}

/// Those that find all there is in a scene which the camera sees a tiny part of. Light tracing would, but next to none of its paths
/// come there.
fn thorough(scene: &Scene) -> Vec<&'static Integrator> {
    complete()
        .filter(|row| Technique::parse(row.name).unwrap().misses(scene).is_none() && row.name != "light")
        .collect()
}

/// A furnace of emission 1 and albedo r has radiance 1 / (1 - r); paths of k segments bring r^(k-1).
fn furnace(name: &str) {
    const ALBEDO: [f64; 3] = [0.5, 0.25, 0.75];
    const LAYERS: u32 = 6;
    let scene = canon(name, &[("size", "32")]);
    with_gpu(|gpu| {
        for row in unbiased() {
            for backend in backends_for(gpu, row) {
                let mut settings = settings(&scene, row.name, backend);
                settings.lengths = LAYERS;
                let film = render(gpu, &scene, &settings, 1024);
                let most = if row.solves < Solves::Everything { 2 } else { u32::MAX };
                let what = format!("{name}, {} on {}", row.name, backend.name());
                for (channel, r) in ALBEDO.into_iter().enumerate() {
                    let expected = if most == 2 { 1.0 + r } else { 1.0 / (1.0 - r) };
                    assert_mean(&format!("{what}, channel {channel}"), average(&film)[channel], expected);
                }
                for layer in 0..LAYERS {
                    // The last layer takes all longer paths: the rest of the geometric series.
                    let r = ALBEDO[0];
                    let open_ended = layer + 1 == LAYERS;
                    let expected = match layer {
                        _ if layer >= most => 0.0,
                        _ if open_ended => r.powi(layer as i32) / (1.0 - r),
                        _ => r.powi(layer as i32),
                    };
                    let values = film.length(layer as usize);
                    let per_pixel: Vec<f64> = values.pixels.iter().map(|pixel| f64::from(pixel[0])).collect();
                    let measured = Estimate::of(&per_pixel);
                    if expected == 0.0 {
                        assert_eq!(measured.mean, 0.0, "{what}, layer {layer}");
                    } else {
                        assert_mean(&format!("{what}, {} segments", layer + 1), measured, expected);
                    }
                }
            }
        }
    });
}

#[test]
fn furnace_sphere() {
    furnace("furnace_sphere.xml");
}

#[test]
fn furnace_box() {
    furnace("furnace_box.xml");
}

/// What is lossless cannot be seen under a white sky: rough spheres of a perfect mirror and of glass disappear once they get
/// back what they lose to multiple scattering, and are darker without.
#[test]
fn compensated_spheres_disappear_under_a_white_sky() {
    let mirror = material::conductor([0.0; 3], [1.0; 3], [1.0; 3], Some([0.6; 2]));
    let glass = material::dielectric(1.5, [1.0; 3], [1.0; 3], Some([0.6; 2]));
    with_gpu(|gpu| {
        for (name, record) in [("mirror", mirror), ("glass", glass)] {
            let scene = |compensate: bool| {
                let plain = material::MaterialDescription::from(record);
                let mut builder = SceneBuilder::new(name);
                let id = builder.material(if compensate { plain.compensated() } else { plain });
                let surface = builder.surface(SurfaceDescription { front: Some(id), ..SurfaceDescription::default() });
                builder.sphere(0, "sphere", DVec3::ZERO, 1.0, surface);
                builder.background = Some([1.0; 3]);
                let eye = DVec3::new(0.0, 0.0, 3.0);
                builder.cameras.push(Camera::look_at(eye, DVec3::ZERO, DVec3::Y, 20.0).unwrap());
                builder.finish().unwrap()
            };
            let (full, plain) = (scene(true), scene(false));
            for row in thorough(&full) {
                for backend in backends_for(gpu, row) {
                    let mean = |scene: &Scene, spp: u32| {
                        let mut settings = settings(scene, row.name, backend);
                        (settings.width, settings.height) = (32, 32);
                        average(&render(gpu, scene, &settings, spp))[0]
                    };
                    let what = format!("{name}, {} on {}", row.name, backend.name());
                    let (full, plain) = (mean(&full, 1024), mean(&plain, 64));
                    let sigma = full.variance.sqrt();
                    println!("{what}: {:.5} +- {sigma:.5} with compensation, {:.5} without", full.mean, plain.mean);
                    assert!(sigma < 1.6e-3 && (full.mean - 1.0).abs() < 5e-3, "{what}: {} +- {sigma}", full.mean);
                    assert!(plain.mean < 0.95, "{what}: {} without compensation", plain.mean);
                }
            }
        }
    });
}

/// The layers by path length sum to the image exactly, and to the image that is rendered without them but for rounding.
#[test]
fn layers_by_length_sum_to_the_image() {
    let scene = canon("cornell.xml", &[("size", "64")]);
    with_gpu(|gpu| {
        for row in INTEGRATORS {
            for backend in backends_for(gpu, row) {
                let mut with_layers = settings(&scene, row.name, backend);
                with_layers.lengths = 5;
                let layered = render(gpu, &scene, &with_layers, 16);
                let plain = render(gpu, &scene, &settings(&scene, row.name, backend), 16).mean();
                let sum = layered.mean();
                for pixel in 0..sum.pixels.len() {
                    for channel in 0..3 {
                        let layers: f64 =
                            (0..5).map(|layer| f64::from(layered.length(layer).pixels[pixel][channel])).sum();
                        assert_eq!(layers as f32, sum.pixels[pixel][channel]);
                        let (a, b) = (sum.pixels[pixel][channel], plain.pixels[pixel][channel]);
                        assert!(
                            (a - b).abs() <= 1e-6 * b.max(1e-3),
                            "{} on {}: {a} against {b}",
                            row.name,
                            backend.name()
                        );
                    }
                    if pixel == 200 {
                        break; // `length` makes a whole image each time: a few rows are enough
                    }
                }
            }
        }
    });
}

/// The luminance of a wall of the cube with a point light at its centre, at six points (Khodulev's values to one decimal).
#[test]
fn cube_with_a_point_light() {
    let points = [
        ("centre", 892.8),
        ("quarter", 768.7),
        ("diagonal", 686.6),
        ("edge", 565.1),
        ("edge_quarter", 522.4),
        ("corner", 388.4),
    ];
    let scene = canon("cube_point_light.xml", &[("size", "32")]);
    with_gpu(|gpu| {
        for row in thorough(&scene) {
            for backend in backends_for(gpu, row) {
                for (camera, expected) in points {
                    let mut settings = settings(&scene, row.name, backend);
                    settings.camera = Some(camera.to_owned());
                    let film = render(gpu, &scene, &settings, 600);
                    assert_mean(&format!("{camera}, {} on {}", row.name, backend.name()), average(&film)[0], expected);
                }
            }
        }
    });
}

/// A diffuse patch at the origin facing +y, seen from above, under an emitter of radiance 1.
fn patch_under(emitter: impl FnOnce(&mut SceneBuilder, usize)) -> Scene {
    let mut builder = SceneBuilder::new("patch");
    let floor = builder.matte([0.5; 3]);
    builder.parallelogram(DVec3::new(-1e-3, 0.0, -1e-3), DVec3::Z * 2e-3, DVec3::X * 2e-3, floor);
    let light = builder.surface(SurfaceDescription {
        front: None,
        back: None,
        emission: [1.0; 3],
        ..SurfaceDescription::default()
    });
    emitter(&mut builder, light);
    builder.film.width = 16;
    builder.film.height = 16;
    builder.cameras.push(Camera::look_at(DVec3::new(0.0, 0.4, 0.3), DVec3::ZERO, DVec3::Y, 0.05).unwrap());
    builder.finish().unwrap()
}

/// Irradiance at the origin, on a surface facing +y, from a polygon of radiance 1 (Lambert 1760; Baum, Rushmeier and Winget
/// 1989): E = 1/2 sum of the edges' angles times the vertical part of their planes' normals.
fn lambert(corners: &[DVec3]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let sum: f64 = corners.iter().zip(next).map(|(a, b)| a.angle_between(*b) * a.cross(*b).normalize().y).sum();
    0.5 * sum.abs()
}

/// A polygon whose front faces the origin, as a fan.
fn polygon(builder: &mut SceneBuilder, corners: &[DVec3], surface: usize) {
    let mut triangles: Vec<_> = (1..corners.len() as u32 - 1).map(|index| [0, index, index + 1]).collect();
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if normal.dot(corners[0]) > 0.0 {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    let mesh = Mesh { positions: corners.to_vec(), triangles, ..Mesh::default() };
    builder.mesh(0, "polygon", mesh, DAffine3::IDENTITY, surface);
}

/// Every technique, and every way of direct lighting, gives radiance albedo / pi times the irradiance.
fn irradiance(what: &str, scene: &Scene, expected: f64, spp: u32) {
    with_gpu(|gpu| {
        let techniques = thorough(scene).into_iter().map(|row| row.name);
        for technique in techniques.chain(["direct", "direct:sampling=emitter", "direct:sampling=bsdf"]) {
            for backend in backends_for(gpu, Technique::parse(technique).unwrap().row) {
                let mut settings = settings(scene, technique, backend);
                settings.max_depth = Some(2);
                // What only the BSDF's choice of direction finds is seldom found.
                let implicit = technique == "path-implicit" || technique.ends_with("bsdf");
                let film = render(gpu, scene, &settings, if implicit { 30 * spp } else { spp });
                assert_mean(
                    &format!("{what}, {technique} on {}", backend.name()),
                    average(&film)[0],
                    0.5 / PI * expected,
                );
            }
        }
    });
}

#[test]
fn irradiance_from_a_polygon() {
    let corners =
        [DVec3::new(-1.0, 1.0, 0.5), DVec3::new(0.5, 1.4, 1.2), DVec3::new(1.3, 0.9, -0.2), DVec3::new(0.1, 0.8, -1.0)];
    // The fan's triangles must be one plane for the formula to be the polygon's: project the last corner onto it.
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    let last = corners[3] - normal * normal.dot(corners[3] - corners[0]);
    let corners = [corners[0], corners[1], corners[2], last];
    let scene = patch_under(|builder, surface| polygon(builder, &corners, surface));
    irradiance("polygon", &scene, lambert(&corners), 500);
}

/// A disk on the axis: E = pi L R² / (R² + h²). Its polygon of 512 corners has 2.5e-5 less.
#[test]
fn irradiance_from_a_disk() {
    let (radius, height) = (0.7, 1.1);
    let corners: Vec<_> = (0..512)
        .map(|index| {
            let angle = 2.0 * PI * f64::from(index) / 512.0;
            DVec3::new(radius * angle.cos(), height, radius * angle.sin())
        })
        .collect();
    let exact = PI * radius * radius / (radius * radius + height * height);
    assert!((lambert(&corners) / exact - 1.0).abs() < 1e-4);
    let scene = patch_under(|builder, surface| polygon(builder, &corners, surface));
    irradiance("disk", &scene, exact, 500);
}

/// A sphere wholly above the horizon: E = pi L (R / d)² cos of the angle at which its centre stands.
#[test]
fn irradiance_from_a_sphere() {
    let (centre, radius) = (DVec3::new(0.4, 1.2, -0.3), 0.5);
    let scene = patch_under(|builder, surface| builder.sphere(0, "light", centre, radius, surface));
    let expected = PI * radius * radius / centre.length_squared() * centre.normalize().y;
    irradiance("sphere", &scene, expected, 500);
}

/// A slab of glass met head-on: reflections within it sum to R = 2 r / (1 + r) and T = (1 - r) / (1 + r), r = 0.04. Green
/// light comes through it, red light back from it.
#[test]
fn slab_of_glass() {
    let mut builder = SceneBuilder::new("slab");
    let glass = builder.material(material::dielectric(1.5, [1.0; 3], [1.0; 3], None));
    let glass = builder.surface(SurfaceDescription {
        front: Some(glass),
        back: None,
        emission: [0.0; 3],
        ..SurfaceDescription::default()
    });
    // Two faces, each with its front to the outside.
    builder.parallelogram(DVec3::new(-5.0, -5.0, 1.0), DVec3::X * 10.0, DVec3::Y * 10.0, glass);
    builder.parallelogram(DVec3::new(-5.0, -5.0, 0.0), DVec3::Y * 10.0, DVec3::X * 10.0, glass);
    let red = builder.surface(SurfaceDescription {
        front: None,
        back: None,
        emission: [1.0, 0.0, 0.0],
        ..SurfaceDescription::default()
    });
    builder.parallelogram(DVec3::new(-5.0, -5.0, 9.0), DVec3::Y * 10.0, DVec3::X * 10.0, red);
    let green = builder.surface(SurfaceDescription {
        front: None,
        back: None,
        emission: [0.0, 1.0, 0.0],
        ..SurfaceDescription::default()
    });
    builder.parallelogram(DVec3::new(-5.0, -5.0, -9.0), DVec3::X * 10.0, DVec3::Y * 10.0, green);
    builder.film.width = 32;
    builder.film.height = 32;
    builder.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 0.01).unwrap());
    let scene = builder.finish().unwrap();
    with_gpu(|gpu| {
        for row in thorough(&scene) {
            for backend in backends_for(gpu, row) {
                let mut settings = settings(&scene, row.name, backend);
                settings.rr_depth = 50;
                let film = render(gpu, &scene, &settings, 2000);
                let what = format!("slab, {} on {}", row.name, backend.name());
                assert_mean(&format!("{what}, reflected"), average(&film)[0], 0.076_923_1);
                assert_mean(&format!("{what}, transmitted"), average(&film)[1], 0.923_076_9);
            }
        }
    });
}

/// A furnace of radiance 1 at this albedo, seen from inside.
fn bright_furnace(albedo: f64) -> Scene {
    let mut builder = SceneBuilder::new("furnace");
    let front = Some(builder.material(material::diffuse([albedo as f32; 3])));
    let surface = builder.surface(SurfaceDescription {
        front,
        back: None,
        emission: [1.0 - albedo; 3],
        ..SurfaceDescription::default()
    });
    builder.sphere(0, "furnace", DVec3::ZERO, -1.0, surface);
    builder.film.width = 16;
    builder.film.height = 16;
    builder.cameras.push(Camera::look_at(DVec3::new(0.1, 0.2, 0.3), DVec3::X, DVec3::Y, 60.0).unwrap());
    builder.finish().unwrap()
}

/// Russian roulette changes no mean: against 1, and against paths that are followed for 2000 segments.
///
/// With a constant probability q of ending, a path's weight grows by r / (1 - q) per vertex and its second moment by
/// r² / (1 - q): beyond r² = 1 - q the variance is infinite, and no number of samples would show the mean. So q = 0.1 is
/// tried at an albedo of 0.9, and 0.99 is left to roulette on throughput (which has no such limit) and to small q.
#[test]
fn roulette_is_unbiased() {
    let cases = [
        (0.99, "path", 5, 1000),
        (0.99, "path", 2000, 200),
        (0.99, "path-implicit:q=0.01", 1, 4000),
        (0.9, "path", 5, 1000),
        (0.9, "path-implicit", 1, 4000),
        (0.9, "path-implicit:q=0.02", 1, 1000),
        (0.9, "light", 5, 1000),
        (0.9, "bdpt", 5, 200),
        (0.99, "bdpt", 5, 450),
    ];
    with_gpu(|gpu| {
        for (albedo, technique, rr_depth, spp) in cases {
            let scene = bright_furnace(albedo);
            for backend in backends_for(gpu, Technique::parse(technique).unwrap().row) {
                let mut settings = settings(&scene, technique, backend);
                settings.rr_depth = rr_depth;
                settings.max_depth = Some(2000);
                let film = render(gpu, &scene, &settings, spp);
                let what = format!("albedo {albedo}, {technique}, roulette from {rr_depth}, on {}", backend.name());
                // What paths of more than 2000 segments would bring: 0.99^2000 = 2e-9.
                assert_mean(&what, average(&film)[0], 1.0);
            }
        }
    });
}

/// The lecture's biased form misses exactly what it says: everything after the first light.
#[test]
fn the_biased_form_stops_at_the_first_light() {
    let scene = canon("furnace_sphere.xml", &[("size", "16")]);
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            let film = render(gpu, &scene, &settings(&scene, "path-implicit:form=biased", backend), 16);
            assert!(
                film.mean().pixels.iter().all(|pixel| *pixel == [1.0; 3]),
                "the first vertex emits, and that is all"
            );
        }
    });
}

/// Sums keep what single precision would lose: 2^18 samples of a light of radiance 0.1, whose plain sum is off by 1e-4.
#[test]
fn long_sums_stay_exact() {
    let mut builder = SceneBuilder::new("light");
    let emission = [0.1, 0.7, 3.3];
    let light = builder.surface(SurfaceDescription { emission, ..SurfaceDescription::default() });
    builder.parallelogram(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0, light);
    (builder.film.width, builder.film.height) = (8, 8);
    builder.cameras.push(Camera::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, 1.0).unwrap());
    let scene = builder.finish().unwrap();
    with_gpu(|gpu| {
        let film = render(gpu, &scene, &settings(&scene, "path", lumbre::backend::Backend::Bvh), 1 << 18);
        for (found, expected) in average(&film).iter().zip(emission) {
            let expected = f64::from(expected as f32);
            assert!((found.mean / expected - 1.0).abs() < 1e-7, "{} against {expected}", found.mean);
        }
    });
}

/// Radiance inside glass is eta^2 times what enters it: a camera within, looking straight out at light of radiance 1.
#[test]
fn radiance_is_larger_inside_of_glass() {
    let mut builder = SceneBuilder::new("inside");
    let glass = builder.material(material::dielectric(1.5, [1.0; 3], [1.0; 3], None));
    let glass = builder.surface(SurfaceDescription { front: Some(glass), ..SurfaceDescription::default() });
    builder.parallelogram(DVec3::new(-5.0, -5.0, 1.0), DVec3::X * 10.0, DVec3::Y * 10.0, glass);
    builder.background = Some([1.0; 3]);
    (builder.film.width, builder.film.height) = (8, 8);
    builder.cameras.push(Camera::look_at(DVec3::ZERO, DVec3::Z, DVec3::Y, 0.01).unwrap());
    let scene = builder.finish().unwrap();
    with_gpu(|gpu| {
        for row in thorough(&scene) {
            // Of what comes back from the glass (4 %) the background is seen as well, through nothing.
            let film = render(gpu, &scene, &settings(&scene, row.name, lumbre::backend::Backend::Bvh), 4000);
            assert_mean(&format!("inside, {}", row.name), average(&film)[0], 0.96 * 2.25 + 0.04);
        }
    });
}
