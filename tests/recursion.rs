//! The rendering equation evaluated as it recurses, against the loop that comes of it.

use crate::common::{backends_in_time, canon, render, settings, with_gpu};
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::Scene;

/// Scenes with glass, textures of light from everywhere, lights of every size, and paths of a hundred segments and more; and the segments
/// before roulette.
fn scenes() -> Vec<(Scene, u32)> {
    vec![
        (canon("cornell_spheres.xml", &[("size", "48")]), 5),
        (canon("furnace_box.xml", &[("size", "32")]), 40), // the stack overflows
        (canon("many_lights.xml", &[("width", "48"), ("height", "32")]), 5),
    ]
}

/// Compares `path` with the technique on all of them, with so many layers by length.
fn compare_with_path(technique: &str, lengths: u32, compare: impl Fn(&str, &Film, &Film)) {
    for (scene, rr_depth) in scenes() {
        with_gpu(|gpu| {
            // Both forms ask rays by the same functions, which differ by backend.
            for backend in backends_in_time(gpu) {
                let film = |technique: &str| {
                    let settings = Settings { rr_depth, lengths, ..settings(&scene, technique, backend) };
                    render(gpu, &scene, &settings, 32)
                };
                compare(&format!("{technique} on {}", backend.name()), &film("path"), &film(technique));
            }
        });
    }
}

#[test]
fn a_call_with_nothing_left_to_do_is_the_loop() {
    compare_with_path("path-recursive:returns=nothing", 4, |what, path, recursive| {
        assert_eq!(path.sums, recursive.sums, "{what}");
        assert_eq!(path.squares, recursive.squares, "{what}");
        let layers = |film: &Film| (0..4).map(|k| film.length(k).pixels).collect::<Vec<_>>();
        assert_eq!(layers(path), layers(recursive), "{what}");
    });
}

#[test]
fn what_calls_return_is_the_same_but_for_rounding() {
    compare_with_path("path-recursive", 48, |what, path, recursive| {
        let mut images = vec![(path.mean(), recursive.mean())];
        images.extend([0, 1, 2, 3, 20, 36, 47].map(|k| (path.length(k), recursive.length(k))));
        for (a, b) in images {
            let (a, b) = (a.pixels.as_flattened(), b.pixels.as_flattened());
            let scale = a.iter().copied().fold(0.0, f32::max);
            let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            println!("{what}: off by {off:e} of at most {scale:e}");
            assert!(off <= 1e-5 * scale, "{what}: off by {off} of at most {scale}");
        }
    });
}
