//! The rendering equation evaluated as it recurses, against the loop that comes of it.

#![allow(clippy::unwrap_used)]

mod common;

use common::{backends, canon, render, settings, with_gpu};
use lumbre::film::Film;
use lumbre::render::Settings;
use lumbre::scene::Scene;

fn both(scene: &Scene, technique: &str, change: &dyn Fn(&mut Settings), compare: &dyn Fn(&str, &Film, &Film)) {
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            let film = |technique: &str| {
                let mut settings = settings(scene, technique, backend);
                change(&mut settings);
                render(gpu, scene, &settings, 32)
            };
            compare(&format!("{technique} on {}", backend.name()), &film("path"), &film(technique));
        }
    });
}

/// Scenes with glass, textures of light from everywhere, lights of every size, and paths of a hundred segments and more.
fn scenes() -> Vec<(Scene, u32)> {
    vec![
        (canon("cornell_spheres.xml", &[("size", "48")]), 5),
        (canon("furnace_box.xml", &[("size", "32")]), 200), // no roulette for long: the stack overflows
        (canon("many_lights.xml", &[("width", "48"), ("height", "32")]), 5),
    ]
}

#[test]
fn a_call_with_nothing_left_to_do_is_the_loop() {
    for (scene, rr_depth) in scenes() {
        let change = |settings: &mut Settings| {
            settings.rr_depth = rr_depth.min(40);
            settings.lengths = 4;
        };
        both(&scene, "path-recursive:returns=nothing", &change, &|what, path, recursive| {
            assert_eq!(path.sums, recursive.sums, "{what}");
            assert_eq!(path.squares, recursive.squares, "{what}");
            assert_eq!(
                (0..4).map(|k| path.length(k).pixels).collect::<Vec<_>>(),
                (0..4).map(|k| recursive.length(k).pixels).collect::<Vec<_>>(),
                "{what}"
            );
        });
    }
}

#[test]
fn what_calls_return_is_the_same_but_for_rounding() {
    for (scene, rr_depth) in scenes() {
        let change = |settings: &mut Settings| {
            settings.rr_depth = rr_depth.min(40);
            settings.lengths = 48;
        };
        both(&scene, "path-recursive", &change, &|what, path, recursive| {
            let mut images = vec![(path.mean(), recursive.mean())];
            images.extend([0, 1, 2, 3, 20, 36, 47].map(|k| (path.length(k), recursive.length(k))));
            for (a, b) in images {
                let scale = a.pixels.iter().flatten().copied().fold(0.0, f32::max);
                let off = a
                    .pixels
                    .iter()
                    .flatten()
                    .zip(b.pixels.iter().flatten())
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f32::max);
                println!("{what}: off by {off:e} of at most {scale:e}");
                assert!(off <= 1e-5 * scale, "{what}: off by {off} of at most {scale}");
            }
        });
    }
}
