//! What becomes of samples: sums, layers, samples that are not finite, files.

use glam::DVec3;

use super::comparison::{average, differing};
use super::figure::{Figure, Worst};
use super::geometry::{lamp, look};
use super::{Run, room};
use crate::error::Result;
use crate::image::{Image, Picture, read_image, write_picture};
use crate::layout::backend::Backend;
use crate::render::{Renderer, Settings};
use crate::scene::{Scene, SceneBuilder};
use crate::techniques::{TECHNIQUES, TechniqueRow};

/// A light that fills the image.
fn light(size: u32, emission: [f64; 3]) -> Result<Scene> {
    let mut builder = SceneBuilder::new("light");
    let surface = lamp(&mut builder, emission);
    builder.parallelogram(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0, surface);
    look(&mut builder, size, DVec3::Z * 5.0, DVec3::ZERO, 1.0)?;
    builder.finish()
}

/// 2^25 samples in one pixel; a plain sum in single precision stands still at 2^24.
pub(super) fn long_sums(run: &mut Run) -> Result<()> {
    let emission = [0.1, 0.7, 3.3];
    let scene = light(1, emission)?;
    let power = run.pick(25, 20);
    let film = run.render(&scene, &run.settings(&scene, "path")?, 1 << power)?;
    for (channel, expected) in emission.into_iter().enumerate() {
        let expected = f64::from(expected as f32);
        let found = average(&film)[channel].mean;
        run.note(Figure::relative(
            "path",
            format!("2^{power} samples in a pixel, channel {channel}"),
            found,
            expected,
            1e-6,
        ));
    }
    Ok(())
}

/// The layers by path length sum to the image, exactly, and to the one rendered without them but for rounding.
pub(super) fn layers(run: &mut Run) -> Result<()> {
    let scene = room::lit(room::MATTE, room::MATTE, 32)?;
    // Layers of contributions of light subpaths need no second backend.
    let all = run.pick(TECHNIQUES.len(), 4);
    let here = |row: &&TechniqueRow| run.backend == Backend::Bvh || row.is_unidirectional();
    for row in TECHNIQUES.iter().take(all).filter(here).collect::<Vec<_>>() {
        let settings = run.settings(&scene, row.name)?;
        let layered = run.render(&scene, &Settings { lengths: 5, ..settings.clone() }, 16)?;
        let plain = run.render(&scene, &settings, 16)?.mean();
        let layers: Vec<Image> = (0..5).map(|layer| layered.length(layer)).collect();
        let (mut exact, mut close) = (Worst::default(), Worst::default());
        for (pixel, value) in layered.mean().pixels.iter().enumerate() {
            for (channel, value) in value.iter().enumerate() {
                let sum: f64 = layers.iter().map(|layer| f64::from(layer.pixels[pixel][channel])).sum();
                exact.see(f64::from((sum as f32 - value).abs()), || format!("pixel {pixel}, channel {channel}"));
                let other = plain.pixels[pixel][channel];
                close.see(f64::from((value - other).abs() / other.max(1e-3)), || {
                    format!("pixel {pixel}, channel {channel}")
                });
            }
        }
        run.note(exact.figure(row.name, "sum of the layers against the image, absolute", 0.0));
        run.note(close.figure(row.name, "against the image without layers, relative", 1e-6));
    }
    Ok(())
}

/// Samples that are not finite are dropped, counted and located, and their neighbours are untouched.
pub(super) fn not_finite(run: &mut Run) -> Result<()> {
    const SPP: u32 = 2;
    let scene = |is_bad: bool| {
        let mut builder = SceneBuilder::new("light");
        let glowing = lamp(&mut builder, [0.5, 1.0, 1.0]);
        let mut left = glowing;
        if is_bad {
            // What a lamp over nearly the half space sheds is beyond single precision, and so infinite on the device.
            left = builder.matte([0.5; 3]);
            let sky = lamp(&mut builder, [3e38, 1.0, 1.0]);
            builder.parallelogram(DVec3::new(200.0, -200.0, 20.0), DVec3::X * -400.0, DVec3::Y * 400.0, sky);
        }
        for (x, surface) in [(-2.0, left), (0.0, glowing)] {
            builder.parallelogram(DVec3::new(x, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0, surface);
        }
        look(&mut builder, 16, DVec3::Z * 5.0, DVec3::ZERO, 10.0)?;
        builder.finish()
    };
    let (bad, good) = (scene(true)?, scene(false)?);
    let settings = Settings { max_depth: Some(2), ..run.settings(&bad, "path")? };
    let film = run.film(&bad, &settings, SPP)?;
    let sound = run.render(&good, &settings, SPP)?;
    let expected = 16.0 * 8.0 * f64::from(SPP);
    run.note(Figure::at_most(
        "path",
        "count of those that were injected, off by",
        (film.nonfinite as f64 - expected).abs(),
        0.0,
    ));
    let astray = film.bad_samples.iter().filter(|bad| bad.x >= 8 || bad.y >= 16 || bad.sample >= SPP).count();
    let astray = if film.bad_samples.is_empty() { f64::NAN } else { astray as f64 };
    run.note(Figure::at_most("path", "located where there are none", astray, 0.0));
    let (mut neighbours, mut inside) = (0.0, 0.0);
    for (pixel, (a, b)) in film.sums.iter().zip(&sound.sums).enumerate() {
        if pixel % 16 < 8 {
            inside += a.iter().map(|value| value.abs()).sum::<f64>();
        } else if a != b {
            neighbours += 1.0;
        }
    }
    run.note(Figure::at_most("path", "their sum in the image", inside, 0.0));
    run.note(Figure::at_most("path", "neighbours that changed", neighbours, 0.0));
    Ok(())
}

/// A radiance of 10^6, in an EXR file and read from it.
pub(super) fn output(run: &mut Run) -> Result<()> {
    let scene = light(4, [1e6, 1e6 + 0.0625, 1e-6])?;
    let image = run.render(&scene, &run.settings(&scene, "path")?, 4)?.mean();
    let folder = tempfile::tempdir()
        .map_err(|error| crate::error::Error::write(std::path::Path::new("a folder for temporary files"), error))?;
    let file = folder.path().join("bright.exr");
    write_picture(&file, &Picture { image: image.clone(), layers: Vec::new(), header: Vec::new() })?;
    let read = read_image(&file)?;
    let differ =
        image.pixels.iter().zip(&read.pixels).filter(|(a, b)| a.map(f32::to_bits) != b.map(f32::to_bits)).count();
    run.note(Figure::at_most("path", "pixels of the file that are not the film's bits", differ as f64, 0.0));
    run.note(Figure::relative("path", "a pixel", f64::from(read.pixels[0][1]), 1e6 + 0.0625, 0.0));
    Ok(())
}

/// Splats come in any order, and their sums are the same bits.
pub(super) fn splats(run: &mut Run) -> Result<()> {
    let scene = room::lit(room::MATTE, room::MATTE, 32)?;
    for technique in match run.backend {
        Backend::Bvh => run.pick(vec!["light", "bdpt", "vcm", "photon", "mlt"], vec!["light"]),
        Backend::RayQuery => vec!["light"],
    } {
        let settings = run.settings(&scene, technique)?;
        let (a, b) = (run.render(&scene, &settings, 16)?, run.render(&scene, &settings, 16)?);
        let dark = f64::from(u8::from(a.average()[1] <= 0.0));
        run.note(Figure::at_most(technique, "pixels that differ between two runs", differing(&a, &b) + dark, 0.0));
        // A device may take threads in the same order each time. In small frames it cannot.
        let mut renderer = Renderer::new(run.gpu, &scene, &Settings { expected_samples: 16 << 10, ..settings })?;
        renderer.bound_frames(128);
        while renderer.advance(16)? {}
        let differ = differing(&a, &renderer.film()?);
        run.note(Figure::at_most(technique, "pixels that differ from those of small frames", differ, 0.0));
    }
    Ok(())
}
