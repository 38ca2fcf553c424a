//! Mip maps: each level against the mean of what it covers, and the level that paths look up against the noise that it leaves.

use std::path::Path;

use crate::common::{backends, render, settings, with_gpu};
use lumbre::image::{Texels, TextureImage, srgb_byte, srgb_to_linear};
use lumbre::layout::FILTER_NEAREST_BIT;
use lumbre::layout::backend::Backend;
use lumbre::render::Settings;
use lumbre::render::film::Film;
use lumbre::scene::compile::mip_maps::{append_levels, level_count};
use lumbre::scene::{LoadOptions, Needs, Scene};

/// A number in 0..256 without a pattern.
fn noise(index: usize) -> u8 {
    let mut hash = (index as u32).wrapping_mul(0x9e37_79b9);
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    (hash ^ hash >> 16).to_be_bytes()[0]
}

fn image(width: u32, height: u32, texels: Texels) -> TextureImage {
    let mut image = TextureImage { source: "test".into(), width, height, texels };
    append_levels(&mut image);
    image
}

/// The next level by counting: a grid of points that both levels' texels divide evenly.
fn brute_force(from: [usize; 2], to: [usize; 2], texels: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let mut level = vec![[0.0; 4]; to[0] * to[1]];
    for y in 0..from[1] * to[1] {
        for x in 0..from[0] * to[0] {
            let out = &mut level[y / from[1] * to[0] + x / from[0]];
            let value = texels[y / to[1] * from[0] + x / to[0]];
            out.iter_mut().zip(value).for_each(|(sum, value)| *sum += value / (from[0] * from[1]) as f64);
        }
    }
    level
}

/// Every level of a chain, by brute force in double precision.
fn brute_force_chain(width: u32, height: u32, base: Vec<[f64; 4]>) -> Vec<[f64; 4]> {
    let (mut size, mut level, mut chain) = ([width as usize, height as usize], base.clone(), base);
    while size != [1, 1] {
        let to = size.map(|side| (side / 2).max(1));
        level = brute_force(size, to, &level);
        chain.extend(&level);
        size = to;
    }
    chain
}

#[test]
fn levels_are_the_means_of_what_they_cover() {
    let mut worst = 0.0f64;
    for (width, height) in [(8, 8), (16, 4), (7, 5), (12, 7), (13, 1), (1, 9), (1, 1), (33, 30)] {
        let count = (width * height) as usize;
        let bytes: Vec<[u8; 4]> = (0..count).map(|i| [0, 1, 2, 3].map(|c| noise(4 * i + c))).collect();
        let linear = |bytes: &[u8; 4]| bytes.map(|byte| f64::from(byte) / 255.0);
        let decoded = |bytes: &[u8; 4]| {
            let [r, g, b, a] = bytes.map(|byte| f32::from(byte) / 255.0);
            [srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b), a].map(f64::from)
        };
        let chain = brute_force_chain(width, height, bytes.iter().map(linear).collect());
        let levels = level_count(width, height);
        assert!(1 << (levels - 1) <= width.max(height) && 1 << levels > width.max(height));

        let floats: Vec<[f32; 4]> = bytes.iter().map(|bytes| linear(bytes).map(|value| 3.0 * value as f32)).collect();
        let Texels::Float(floats) = image(width, height, Texels::Float(floats)).texels else {
            panic!("another format")
        };
        assert_eq!(floats.len(), chain.len(), "{width} x {height}");
        for (texel, exact) in floats.iter().flatten().zip(chain.iter().flatten()) {
            worst = worst.max((f64::from(*texel) - 3.0 * exact).abs());
        }
        // Rounded to the nearest byte: half of one, and what floats lose.
        let Texels::Linear8(rounded) = image(width, height, Texels::Linear8(bytes.clone())).texels else {
            panic!("another format")
        };
        assert_eq!(rounded.len(), chain.len());
        for (texel, exact) in rounded.iter().flatten().zip(chain.iter().flatten()) {
            assert!((f64::from(*texel) - 255.0 * exact).abs() < 0.501, "{width} x {height}: {texel} for {exact}");
        }
        let chain = brute_force_chain(width, height, bytes.iter().map(decoded).collect());
        let encoded = image(width, height, Texels::Srgb8(bytes));
        let Texels::Srgb8(encoded) = encoded.texels else { panic!("another format") };
        for (texel, exact) in encoded.iter().zip(&chain) {
            for channel in 0..3 {
                // The byte's ends, half a byte away, are on either side.
                let end = |by: f32| f64::from(srgb_to_linear((f32::from(texel[channel]) + by) / 255.0));
                let inside = end(-0.501) <= exact[channel] && exact[channel] <= end(0.501);
                assert!(inside, "{width} x {height}: {} for {}", texel[channel], exact[channel]);
                assert_eq!(texel[channel], srgb_byte(end(0.0) as f32));
            }
        }
    }
    println!("floats: off by at most {worst:.1e}");
    assert!(worst < 2e-6, "{worst}");
}

/// Texels on a side of the picture, and pixels on a side of the image: each pixel sees 8 x 8 texels.
const SIDE: u32 = 256;
const PIXELS: u32 = 32;
/// Radiance of white: diffuse, under light of irradiance 1 that comes in at 45 degrees.
const LIT: f64 = std::f64::consts::FRAC_1_SQRT_2 * std::f64::consts::FRAC_1_PI;

/// A white shape that shows black and white texels by chance, lit from afar so that its radiance is theirs, and a camera.
fn scene(folder: &Path, camera: &str, shapes: &str, filter: &str, mip_maps: bool) -> Scene {
    let texels: Vec<u8> = (0..SIDE * SIDE).map(|i| if noise(i as usize) & 1 == 0 { 0 } else { 255 }).collect();
    let rgb: Vec<u8> = texels.iter().flat_map(|texel| [*texel; 3]).collect();
    image::save_buffer(folder.join("noise.png"), &rgb, SIDE, SIDE, image::ColorType::Rgb8).unwrap();
    let text = format!(
        r#"<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="3"/></integrator>
        <sensor type="perspective">{camera}<film type="hdrfilm"><integer name="width" value="{PIXELS}"/>
            <integer name="height" value="{PIXELS}"/><rfilter type="box"/></film></sensor>
        <bsdf type="diffuse" id="noise"><texture type="bitmap" name="reflectance"><boolean name="raw" value="true"/>
            <string name="filename" value="noise.png"/><string name="filter_type" value="{filter}"/></texture></bsdf>
        <emitter type="directional"><vector name="direction" x="1" y="0" z="-1"/><rgb name="irradiance" value="1"/></emitter>
        {shapes}</scene>"#
    );
    let path = folder.join("scene.xml");
    std::fs::write(&path, text).unwrap();
    lumbre::scene::load(&path, &LoadOptions { mip_maps, ..LoadOptions::default() }).unwrap()
}

/// A camera above the origin, or looking up, that sees `width` at the distance `distance`.
fn camera(height: f64, target: f64, distance: f64, width: f64) -> String {
    let fov = 2.0 * (0.5 * width / distance).atan().to_degrees();
    format!(
        r#"<float name="fov" value="{fov}"/>
        <transform name="to_world"><lookat origin="0, 0, {height}" target="0, 0, {target}" up="0, 1, 0"/></transform>"#
    )
}

const PLANE: &str = r#"<shape type="rectangle"><ref id="noise"/></shape>"#;

/// Three squares side by side, each 32 pixels and 256 texels wide from where the camera is: one straight below, one through
/// an instance that is scaled by two, and one that stands upright and is seen in a mirror, over the same distance in all.
const SQUARES: &str = r#"
    <shape type="rectangle"><ref id="noise"/><transform name="to_world"><translate x="-2"/></transform></shape>
    <shape type="shapegroup" id="group"><shape type="rectangle"><ref id="noise"/>
        <transform name="to_world"><scale value="0.5"/></transform></shape></shape>
    <shape type="instance"><ref id="group"/><transform name="to_world"><scale value="2"/></transform></shape>
    <shape type="rectangle"><bsdf type="conductor"><string name="material" value="none"/></bsdf>
        <transform name="to_world"><scale x="1.4"/><rotate y="1" angle="45"/><translate x="1.8" z="2"/></transform></shape>
    <shape type="rectangle"><ref id="noise"/>
        <transform name="to_world"><rotate y="1" angle="-90"/><translate x="3.8" z="1.8"/></transform></shape>"#;

/// Mean of the pixels of a square, and their variance over its square: without what other squares throw on them.
fn spread(film: &Film, square: u32) -> (f64, f64) {
    let image = film.length(if square == 2 { 2 } else { 1 });
    // The outermost pixels may see past an edge of the mirror.
    let inside = (2..PIXELS - 2).flat_map(|y| (2..PIXELS - 2).map(move |x| y * image.width + square * PIXELS + x));
    let values: Vec<f64> = inside.map(|pixel| f64::from(image.pixels[pixel as usize][0])).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
    (mean, variance / (mean * mean))
}

/// One sample sees one point: black, white, or between them, a relative variance of (2/3)^2. A cone of half the pixel's width
/// leaves the mean of 4 x 4 texels, which has 1/16 of it, and a level too fine or too coarse four times or a quarter of that.
#[test]
fn one_sample_sees_the_mean_of_what_the_pixel_shows() {
    let folder = tempfile::tempdir().unwrap();
    let load = |on| scene(folder.path(), &camera(20.0, 0.0, 20.0, 6.0), SQUARES, "bilinear", on);
    let (on, off) = (load(true), load(false));
    assert!(Needs::of(&on).mip_maps && !Needs::of(&off).mip_maps);
    with_gpu(|gpu| {
        let film = |scene: &Scene, backend| {
            let settings = Settings { width: 3 * PIXELS, lengths: 3, ..settings(scene, "path", backend) };
            render(gpu, scene, &settings, 1)
        };
        let unfiltered = film(&off, Backend::Bvh);
        for backend in backends(gpu) {
            let filtered = film(&on, backend);
            for (square, name) in (0..).zip(["straight", "instance", "mirror"]) {
                let ((mean_on, on), (mean_off, off)) = (spread(&filtered, square), spread(&unfiltered, square));
                let point = 4.0 / 9.0;
                println!(
                    "{name}: mean {mean_on:.4} and {mean_off:.4}; variance {:.3}/16 with and {off:.3} without, of {point:.3}",
                    16.0 * on
                );
                assert!((off / point - 1.0).abs() < 0.15, "{name}: {off}");
                assert!((16.0 * on / point).ln().abs() < 1.6f64.ln(), "{name}: {on}");
                assert!((mean_on / (0.5 * LIT) - 1.0).abs() < 0.04, "{name}: {mean_on}");
            }
        }
    });
}

/// What asks for the nearest texel is left as it is, to the bit; and the user is told.
#[test]
fn nearest_texels_stay() {
    let folder = tempfile::tempdir().unwrap();
    let load = |on| scene(folder.path(), &camera(20.0, 0.0, 20.0, 2.0), PLANE, "nearest", on);
    let (on, off) = (load(true), load(false));
    assert!(on.textures.iter().all(|texture| texture.sampling & FILTER_NEAREST_BIT != 0 && texture.levels == 1));
    assert!(on.warnings.iter().any(|warning| warning.contains("mip maps")), "{:?}", on.warnings);
    assert_eq!(on.images[0].bytes(), off.images[0].bytes());
}

/// The figures of a rendering say whether it was filtered.
#[test]
fn the_figures_say_so() {
    let folder = tempfile::tempdir().unwrap();
    scene(folder.path(), &camera(20.0, 0.0, 20.0, 2.0), PLANE, "bilinear", false);
    let mut command = crate::common::program::lumbre();
    command.args(["render", "scene.xml", "--mip-maps", "-n", "1", "-q", "--json", "-"]).current_dir(folder.path());
    command.args(std::env::var("LUMBRE_TEST_DEVICE").iter().flat_map(|device| ["--device", device]));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let figures: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(figures["mip_maps"], true);
}
