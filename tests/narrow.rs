//! What is as smooth as a mirror, but for a roughness: every technique finds what `path` finds, or says that it does not.

use crate::common::{assert_off, has_time, render, settings, with_gpu};
use glam::DVec3;
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::layout::{Layered, Principled};
use lumbre::render::film::Film;
use lumbre::render::{Renderer, Settings, Technique};
use lumbre::scene::light::Lamp;
use lumbre::scene::material::{self, MaterialDescription, plain_layers};
use lumbre::scene::{Camera, Scene, SceneBuilder, SurfaceDescription};
use lumbre::statistics::Estimate;

/// A kind of material by its alpha, and the alphas to test, from the least that there is.
struct Kind {
    name: &'static str,
    alphas: &'static [f32],
    material: fn(f32) -> MaterialDescription,
}

const WHITE: [f32; 3] = [1.0; 3];

fn metal(alpha: f32) -> MaterialDescription {
    material::conductor([1.34, 0.96, 0.62], [7.47, 6.4, 5.3], WHITE, Some([alpha; 2])).into()
}

fn principled(alpha: f32) -> MaterialDescription {
    let half_metal = Principled { metallic: 0.7, ..Principled::default() };
    material::principled([0.8, 0.6, 0.4], alpha.sqrt(), 1.5, half_metal)
}

/// Mitsuba's least alpha is 1e-4; of principled materials and of glTF's it is 0.001.
const KINDS: [Kind; 7] = [
    Kind { name: "conductor", alphas: &[1e-4, 1e-3, 0.01], material: metal },
    Kind {
        name: "dielectric",
        alphas: &[1e-4, 1e-3, 0.01],
        material: |alpha| material::dielectric(1.5, WHITE, WHITE, Some([alpha; 2])).into(),
    },
    Kind { name: "principled", alphas: &[0.0, 0.01], material: principled },
    Kind {
        name: "plastic",
        alphas: &[1e-4, 1e-3, 0.01],
        material: |alpha| material::plastic(1.5, [0.1, 0.2, 0.3], WHITE, false, Some(alpha)),
    },
    Kind {
        name: "coat",
        alphas: &[0.0, 0.01],
        material: |alpha| {
            let coat = Principled { clearcoat: 1.0, clearcoat_gloss: 1.0 - 10.0 * alpha, ..Principled::default() };
            material::principled([0.4, 0.5, 0.6], 0.6, 1.5, coat)
        },
    },
    Kind {
        name: "glTF",
        alphas: &[0.0, 0.01],
        material: |alpha| material::layered([0.8, 0.6, 0.4], alpha.sqrt(), 1.5, plain_layers(0.7)),
    },
    Kind {
        name: "glTF chrome",
        alphas: &[0.0, 0.01],
        material: |alpha| {
            let lacquer = Layered { clearcoat: 1.0, clearcoat_roughness: alpha.sqrt(), ..plain_layers(1.0) };
            material::layered([0.8, 0.6, 0.4], alpha.sqrt(), 1.5, lacquer)
        },
    },
];

/// A floor, a wall and a ball of this material under a lamp. The camera sees all of it, or the floor in front of the ball alone.
fn room(material: MaterialDescription, sees_ball: bool) -> Scene {
    let mut builder = SceneBuilder::new("a ball in a room");
    let matte = builder.matte([0.6, 0.5, 0.4]);
    builder.parallelogram(DVec3::new(-3.0, 0.0, 3.0), 6.0 * DVec3::X, -6.0 * DVec3::Z, matte);
    builder.parallelogram(DVec3::new(-3.0, -3.0, -1.5), 6.0 * DVec3::X, 6.0 * DVec3::Y, matte);
    let transmits = material.transmits();
    let front = Some(builder.material(material));
    let back = if transmits { front } else { None };
    let ball = builder.surface(SurfaceDescription { front, back, ..SurfaceDescription::default() });
    builder.sphere(0, "ball", DVec3::new(0.0, 0.8, 0.0), 0.8, ball);
    let lamp = builder.surface(SurfaceDescription { emission: [9.0, 8.0, 7.0], ..SurfaceDescription::default() });
    builder.parallelogram(DVec3::new(-0.6, 2.6, -0.6), 1.2 * DVec3::X, 1.2 * DVec3::Z, lamp);
    let (eye, target) = if sees_ball {
        (DVec3::new(0.0, 1.0, 4.5), DVec3::new(0.0, 0.7, 0.0))
    } else {
        (DVec3::new(0.0, 1.2, 0.9), DVec3::new(0.0, 0.0, 1.4))
    };
    builder.cameras.push(Camera::look_at(eye, target, DVec3::Y, 40.0).unwrap());
    builder.finish().unwrap()
}

fn of_size(scene: &Scene, technique: &str, seed: u32) -> Settings {
    Settings { width: 24, height: 24, seed, ..settings(scene, technique, Backend::Bvh) }
}

fn film(gpu: &Gpu, scene: &Scene, technique: &str, seed: u32, spp: u32) -> Film {
    render(gpu, scene, &of_size(scene, technique, seed), spp)
}

/// Whoever evaluates lobes for directions that are given would find next to nothing here: 28 % of the light was lost.
#[test]
fn narrow_lobes_are_followed() {
    with_gpu(|gpu| {
        let scene = room(principled(0.0), true);
        let truth = film(gpu, &scene, "path", 1000, 2048);
        for technique in ["photon", "vcm:form=ppm"] {
            assert_off(technique, &film(gpu, &scene, technique, 1, 256), &truth, 0.02);
        }
    });
}

/// Light tracing says that it misses what is seen in them, and finds all of their caustics.
#[test]
fn narrow_lobes_throw_caustics() {
    with_gpu(|gpu| {
        let scene = room(metal(1e-3), false);
        assert!(Technique::parse("light").unwrap().misses(&scene).is_some_and(|what| what.contains("as smooth")));
        let truth = film(gpu, &scene, "path", 1000, 2048);
        assert_off("light", &film(gpu, &scene, "light", 1, 512), &truth, 0.02);
    });
}

/// Highlights of a light without extent, which no path hits by chance: techniques that merge and follow narrow lobes connect these to it.
#[test]
fn highlights_of_points() {
    let mut builder = SceneBuilder::new("a plate under a point");
    let plate = builder.material(metal(0.02));
    let plate = builder.surface(SurfaceDescription { front: Some(plate), ..SurfaceDescription::default() });
    builder.parallelogram(DVec3::new(-1.0, 0.0, 1.0), 2.0 * DVec3::X, -2.0 * DVec3::Z, plate);
    builder.lamps.push(Lamp::Point { position: DVec3::new(0.0, 1.0, -1.0), intensity: [1.0, 2.0, 3.0] });
    let eye = DVec3::new(0.0, 1.0, 1.0);
    builder.cameras.push(Camera::look_at(eye, DVec3::ZERO, DVec3::Y, 8.0).unwrap());
    let scene = builder.finish().unwrap();
    with_gpu(|gpu| {
        let truth = film(gpu, &scene, "path", 1000, 64);
        for technique in ["photon", "photon:direct=photons", "vcm:form=ppm"] {
            assert_eq!(Technique::parse(technique).unwrap().misses(&scene), None, "{technique}");
            assert_off(technique, &film(gpu, &scene, technique, 1, 64), &truth, 0.01);
        }
    });
}

/// Samples per pixel of one seed; fewer seeds than these tell too little of how far their means are spread.
const SPP: u32 = 256;
const FEWEST_SEEDS: u32 = 8;

/// The mean of all pixels and channels over independent seeds, until its standard error is this share of it, or after so many.
fn energy(gpu: &Gpu, scene: &Scene, technique: &str, first: u32, share: f64, most: u32) -> Estimate {
    let mut renderer = Renderer::new(gpu, scene, &of_size(scene, technique, first)).unwrap();
    let mut means = Vec::new();
    loop {
        while renderer.advance(SPP).unwrap() {}
        let film = renderer.film().unwrap();
        assert_eq!(film.nonfinite, 0, "{:?}", film.bad_samples);
        means.push(film.average().iter().sum::<f64>());
        let found = Estimate::of(&means);
        let seeds = means.len() as u32;
        if seeds == most || seeds >= FEWEST_SEEDS && found.variance.sqrt() < share * found.mean {
            return found;
        }
        renderer.restart(first + seeds).unwrap();
    }
}

/// By how much the mean may be off: where all light comes from merges, their blur takes 1.2 % of it at 256 samples, 0.5 % at 4096.
fn bound(technique: &str) -> f64 {
    if ["photon:direct=photons", "vcm:form=ppm", "vcm:form=bpm"].contains(&technique) { 0.02 } else { 0.01 }
}

/// Holds all techniques on one kind of material against `path`, at each alpha: within their bounds, or three standard errors where these are
/// less than 1 % each. Prints a row for each, and fails with all that disagree.
fn every_technique_agrees(name: &str) {
    if !has_time() {
        return;
    }
    let all = [
        "photon",
        "photon:direct=photons",
        "vcm",
        "vcm:form=ppm",
        "vcm:form=bpm",
        "vpl",
        "bdpt",
        "mlt",
        "mlt:form=multiplexed",
        "mlt:form=paths",
    ];
    let kind = KINDS.iter().find(|kind| kind.name == name).unwrap();
    let mut apart = Vec::new();
    let mut see = |alpha: f32, technique: &str, found: Estimate, truth: Estimate| {
        let ratio = found.mean / truth.mean;
        let error = ratio * (found.variance / found.mean.powi(2) + truth.variance / truth.mean.powi(2)).sqrt();
        let row = format!("| {name} | {alpha} | `{technique}` | {ratio:.4} ± {error:.4} |");
        println!("{row}");
        if !((ratio - 1.0).abs() < f64::max(bound(technique), 3.0 * error) && error < 0.01) {
            apart.push(row);
        }
    };
    with_gpu(|gpu| {
        let energy = |scene: &Scene, technique: &str, seed: u32| energy(gpu, scene, technique, seed, 2e-3, 48);
        let mirror = energy(&room((kind.material)(kind.alphas[0]), true), "whitted", 3000);
        for alpha in kind.alphas.iter().copied() {
            let scene = room((kind.material)(alpha), true);
            let truth = energy(&scene, "path", 1000);
            for technique in all {
                see(alpha, technique, energy(&scene, technique, 1), truth);
            }
            // It says that it misses what the camera sees in narrow lobes: their caustics alone.
            let hidden = room((kind.material)(alpha), false);
            see(alpha, "light", energy(&hidden, "light", 1), energy(&hidden, "path", 1000));
            // Nearly a mirror: recursive ray tracing shows in it what it shows in one.
            see(alpha, "whitted", energy(&scene, "whitted", 1), mirror);
        }
    });
    assert!(apart.is_empty(), "not the energy of `path`:\n{}", apart.join("\n"));
}

#[test]
fn every_technique_agrees_on_narrow_conductors() {
    every_technique_agrees("conductor");
}

#[test]
fn every_technique_agrees_on_narrow_dielectrics() {
    every_technique_agrees("dielectric");
}

#[test]
fn every_technique_agrees_on_narrow_principled_materials() {
    every_technique_agrees("principled");
}

#[test]
fn every_technique_agrees_on_narrow_plastics() {
    every_technique_agrees("plastic");
}

#[test]
fn every_technique_agrees_on_narrow_clear_coats() {
    every_technique_agrees("coat");
}

#[test]
fn every_technique_agrees_on_narrow_gltf_materials() {
    every_technique_agrees("glTF");
}

#[test]
fn every_technique_agrees_on_narrow_gltf_chrome() {
    every_technique_agrees("glTF chrome");
}
