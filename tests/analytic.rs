//! Every technique that can solve a case against what is known in closed form: rows of `lumbre verify`, and what is none of them.

use crate::common::{average, backends, backends_in_time, canon, render, settings, verify, with_gpu};
use glam::DVec3;
use lumbre::render::Technique;
use lumbre::scene::{Camera, Scene, SceneBuilder, SurfaceDescription, material};
use lumbre::techniques::{Bias, Correlated, Solves, TECHNIQUES, TechniqueRow};

// Rows in their full form: more techniques and more samples than in the short one, which tests/verify.rs has on every backend each time.

#[test]
fn furnaces() {
    verify(&["furnace"]);
}

#[test]
#[ignore = "half a minute: `make thorough` runs it"]
fn furnaces_in_full() {
    verify(&["coplanar", "roulette"]);
}

#[test]
fn formulas() {
    verify(&["emitters", "half-lit-sphere", "inside-glass"]);
}

/// What these ask of other techniques than `path` is asked of them above or, of a point light, in tests/bidirectional.rs.
#[test]
#[ignore = "half a minute: `make thorough` runs it"]
fn formulas_in_full() {
    verify(&["cube-point-light", "form-factors", "slab"]);
}

/// Layers that sum to the image are tested with each technique: tests/strategies.rs, tests/metropolis.rs, tests/merging.rs, tests/radiosity.rs.
#[test]
#[ignore = "half a minute: `make thorough` runs it"]
fn sums() {
    verify(&["long-sums", "layers", "splats"]);
}

/// The techniques that account for everything.
fn complete() -> impl Iterator<Item = &'static TechniqueRow> {
    unbiased().filter(|row| row.solves == Solves::Everything)
}

/// Those whose expectation is a closed form. What is only consistent has tests of its own.
fn unbiased() -> impl Iterator<Item = &'static TechniqueRow> {
    TECHNIQUES.iter().filter(|row| row.bias == Bias::Unbiased && row.correlated == Correlated::Nothing)
}

/// Those that find all there is in a scene which the camera sees a tiny part of. Light tracing would, but next to none of its paths
/// come there.
fn thorough(scene: &Scene) -> Vec<&'static TechniqueRow> {
    complete()
        .filter(|row| Technique::parse(row.name).unwrap().misses(scene).is_none() && row.name != "light")
        .collect()
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
                for backend in backends_in_time(gpu) {
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
