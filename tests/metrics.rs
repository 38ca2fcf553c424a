//! FLIP against NVIDIA's own implementation.

use lumbre::image::metrics::flip_map;
use lumbre::image::{Image, srgb_to_linear};

/// A picture of 8-bit sRGB values with edges, gradients and noise.
fn picture(width: u32, height: u32, seed: u32) -> Vec<u8> {
    let mut state = seed;
    (0..width * height)
        .flat_map(|pixel| {
            let (x, y) = (pixel % width, pixel / width);
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = (state >> 27) as i32 - 16;
            let block = if (x / 9 + y / 7) % 2 == 0 { 60 } else { 190 };
            let value = |base: i32| (base + noise * (seed as i32 % 3)).clamp(0, 255) as u8;
            [value(block), value((x * 255 / width) as i32), value((y * 255 / height) as i32)]
        })
        .collect()
}

fn to_linear(width: u32, height: u32, bytes: &[u8]) -> Image {
    let pixels =
        bytes.chunks_exact(3).map(|pixel| [0, 1, 2].map(|c: usize| srgb_to_linear(f32::from(pixel[c]) / 255.0)));
    Image { width, height, pixels: pixels.collect() }
}

#[test]
fn flip_is_the_reference_implementations() {
    let (width, height) = (72, 50);
    let reference = picture(width, height, 3);
    for seed in [1, 2, 4, 5] {
        let mut test = picture(width, height, seed);
        if seed == 5 {
            // A small bright feature on an otherwise equal picture.
            test.clone_from(&reference);
            test[3 * (20 * width as usize + 30)..][..6].fill(255);
        }
        let theirs = nv_flip::flip(
            nv_flip::FlipImageRgb8::with_data(width, height, &reference),
            nv_flip::FlipImageRgb8::with_data(width, height, &test),
            nv_flip::DEFAULT_PIXELS_PER_DEGREE,
        )
        .to_vec();
        let ours = flip_map(&to_linear(width, height, &test), &to_linear(width, height, &reference));
        let worst = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
        println!(
            "picture {seed}: mean {:.5} against {:.5}, largest difference {worst:.1e}",
            mean(&ours),
            mean(&theirs)
        );
        assert!(mean(&theirs) > 1e-3, "the pictures should differ");
        assert!(worst < 2e-3, "picture {seed}: {worst}");
    }
}

#[test]
fn flip_of_equal_pictures_is_zero() {
    let image = to_linear(20, 20, &picture(20, 20, 1));
    assert!(flip_map(&image, &image).iter().all(|value| *value == 0.0));
}
