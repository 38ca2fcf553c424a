//! What finds vertices of light subpaths by a radius, photon mapping and vertex merging: the error vanishes with the number of samples,
//! nothing is counted twice or missed, and no order of photons or frames changes a bit.

use crate::common::room::{LAMP, material_pairs, room, scene};
use crate::common::{assert_off, average, canon, has_time, largest_off, render, settings, truth, with_gpu};
use lumbre::gpu::Gpu;
use lumbre::image::metrics::compare;
use lumbre::layout::backend::Backend;
use lumbre::render::film::Film;
use lumbre::render::{Renderer, Settings, Technique};
use lumbre::scene::Scene;
use lumbre::statistics::Estimate;
use lumbre::techniques::{Bias, find};

const SIZE: u32 = 64;
const ALL: [&str; 5] = ["photon", "photon:direct=photons", "vcm", "vcm:form=bpm", "vcm:form=ppm"];

fn film(gpu: &Gpu, scene: &Scene, technique: &str, seed: u32, spp: u32) -> Film {
    let settings = Settings { width: SIZE, height: SIZE, seed, ..settings(scene, technique, Backend::Bvh) };
    render(gpu, scene, &settings, spp)
}

/// `cornell_spheres` by `path`.
fn truth_of_cornell_spheres(gpu: &Gpu, scene: &Scene) -> Film {
    let settings = Settings { width: SIZE, height: SIZE, seed: 1000, ..settings(scene, "path", Backend::Bvh) };
    truth::truth(gpu, "cornell_spheres-merging-path", scene, &settings, 32768)
}

#[test]
fn the_table_says_that_they_are_consistent() {
    for name in ["photon", "vcm"] {
        assert!(matches!(find(name).unwrap().bias, Bias::Consistent(_)));
    }
}

/// The energy is that of `path`, within a bound that is three times tighter for eight times the samples.
#[test]
fn the_mean_is_that_of_path() {
    with_gpu(|gpu| {
        let scene = canon("cornell_spheres.xml", &[]);
        let truth = truth_of_cornell_spheres(gpu, &scene);
        for technique in ALL {
            let settings = Settings { width: SIZE, height: SIZE, seed: 1, ..settings(&scene, technique, Backend::Bvh) };
            let mut renderer = Renderer::new(gpu, &scene, &settings).unwrap();
            for (spp, bound) in [(32, 0.015), (256, 0.005)] {
                while renderer.advance(spp).unwrap() {}
                assert_off(&format!("{technique}, {spp}"), &renderer.film().unwrap(), &truth, bound);
            }
        }
    });
}

/// The error falls with every eightfold of samples, and where the first radius is large, more than that: with a radius that stays, blur
/// would be left.
#[test]
fn the_error_vanishes() {
    with_gpu(|gpu| {
        let scene = canon("cornell_spheres.xml", &[]);
        let truth = truth_of_cornell_spheres(gpu, &scene).mean();
        let begun = |technique: &str| {
            let settings = Settings { width: SIZE, height: SIZE, seed: 1, ..settings(&scene, technique, Backend::Bvh) };
            Renderer::new(gpu, &scene, &settings).unwrap()
        };
        let error = |renderer: &mut Renderer, spp: u32| {
            while renderer.advance(spp).unwrap() {}
            let relmse = compare(&renderer.film().unwrap().mean(), &truth).unwrap().relmse;
            println!("{}, {spp} samples: relMSE {relmse:.2e}", renderer.settings().technique.describe());
            relmse
        };
        for (technique, bound) in [("photon", 0.015), ("vcm", 0.005)] {
            let mut renderer = begun(technique);
            let errors = [8, 64, 512].map(|spp| error(&mut renderer, spp));
            assert!(errors.is_sorted_by(|a, b| *b < 0.3 * *a), "{technique}: {errors:?}");
            assert!(errors[2] < bound, "{technique}: {errors:?}");
        }
        let at = |alpha: &str| error(&mut begun(&format!("photon:radius=0.1:alpha={alpha}")), 256);
        let (shrinking, blurred) = (at("0.5"), at("1"));
        assert!(shrinking < 0.5 * blurred, "{shrinking} against {blurred}");
    });
}

/// Light paths are kept, sorted and met in any order; frames are cut within a stage, or hold all of them.
#[test]
fn no_order_changes_a_bit() {
    let scene = canon("cornell_spheres.xml", &[]);
    with_gpu(|gpu| {
        for technique in ["photon", "vcm"] {
            let settings = Settings { width: 168, height: 160, ..settings(&scene, technique, Backend::Bvh) };
            let mut renderer = Renderer::new(gpu, &scene, &settings).unwrap();
            let mut frames = 0;
            let mut run = |renderer: &mut Renderer, targets: &[u32]| {
                for target in targets {
                    loop {
                        frames += 1;
                        if !renderer.advance(*target).unwrap() {
                            break;
                        }
                    }
                }
                (renderer.film().unwrap(), std::mem::take(&mut frames))
            };
            // Seven frames for each stage of a sample, and then as many as the device's speed asks for.
            renderer.bound_frames(4096);
            let (first, cut) = run(&mut renderer, &[1, 2, 3, 4]);
            renderer.restart(settings.seed).unwrap();
            renderer.bound_frames(u64::MAX);
            let (again, whole) = run(&mut renderer, &[4]);
            println!("{technique}: {cut} frames, then {whole}");
            assert!(cut >= 4 * 7 * 2 && cut > whole);
            assert_eq!(first.sums, again.sums, "{technique}");
            assert_eq!(first.squares, again.squares, "{technique}");
            let fresh = render(gpu, &scene, &settings, 4);
            assert_eq!(first.sums, fresh.sums, "{technique}");
        }
    });
}

/// Light that was refracted before and after it met the torus: `path` finds it with rare, bright samples only, so that its image takes many
/// samples. The block of glass by itself, and the whole.
#[test]
fn light_through_glass_is_found() {
    let scene = canon("torus_in_glass.xml", &[]);
    with_gpu(|gpu| {
        let small = |technique: &str, seed: u32, spp: u32| {
            let settings = Settings { width: 32, height: 32, seed, ..settings(&scene, technique, Backend::Bvh) };
            render(gpu, &scene, &settings, spp)
        };
        let truth = Settings { width: 32, height: 32, seed: 1000, ..settings(&scene, "path", Backend::Bvh) };
        let truth = truth::truth(gpu, "torus_in_glass-path", &scene, &truth, 262144);
        for technique in ["photon:radius=0.01", "vcm:radius=0.01"] {
            let found = small(technique, 1, 2048);
            assert_off(&format!("torus_in_glass, {technique}"), &found, &truth, 0.02);
            let block = largest_off(&found, &truth, 10..22, 7..18);
            println!("torus_in_glass, {technique}: the torus is off by {:+.2} %", 100.0 * block);
            assert!(block.abs() < 0.05, "{technique}: {block}");
        }
    });
}

/// Where nothing from the camera can find the light at all, photon mapping and vertex merging converge to the same image: parallel light
/// that a mirror throws on a table, as that mirror shows it. `bdpt` says that it misses some of it, and does; where the light has an
/// extent, chance finds it, and nothing is said.
#[test]
fn hidden_caustics_are_found_by_merging_alone() {
    with_gpu(|gpu| {
        for (name, defines) in [("ring_caustic.xml", vec![("light", "directional")]), ("reflected_caustic.xml", vec![])]
        {
            let scene = canon(name, &defines);
            let misses = Technique::parse("bdpt").unwrap().misses(&scene);
            assert_eq!(misses.is_some(), scene.has_delta_lights(), "{name}: {misses:?}");
            assert_eq!(Technique::parse("vcm").unwrap().misses(&scene), None);
            let photon = film(gpu, &scene, "photon:radius=0.005", 1, 1024);
            let vcm = film(gpu, &scene, "vcm:radius=0.005", 2, 1024);
            let off = |a: Estimate, b: Estimate| (a.mean / b.mean - 1.0, (a.variance + b.variance).sqrt() / b.mean);
            let (whole, sigma) = off(average(&vcm)[1], average(&photon)[1]);
            println!("{name}: the image is off by {whole:+.4}, sigma {sigma:.4}");
            assert!(sigma < 0.015 && whole.abs() < 0.005 + 3.0 * sigma, "{name}: the image is off by {whole}");
            let mut fine = 0;
            for (x, y) in [(0, 0), (32, 0), (0, 32), (32, 32)] {
                let tile = |film: &Film| crate::common::tile_average(film, x..x + 32, y..y + 32)[1];
                let (quarter, sigma) = off(tile(&vcm), tile(&photon));
                println!("{name}: the quarter at ({x}, {y}) is off by {quarter:+.4}, sigma {sigma:.4}");
                // One sample that chance has made bright can hide a quarter: all others tell.
                fine += u32::from(sigma < 0.02);
                // Two per cent for what is left of blur.
                assert!(quarter.abs() < 0.02 + 3.0 * sigma, "{name}: the quarter at ({x}, {y}) is off by {quarter}");
            }
            assert!(fine >= 3, "{name}: {fine} quarters are fine enough to tell");
            if misses.is_some() {
                let share = average(&film(gpu, &scene, "bdpt", 3, 256))[0].mean / average(&vcm)[0].mean;
                println!("{name}: bdpt has {share:.4} of the light");
                assert!((0.85..0.93).contains(&share), "{name}: bdpt has {share} of the light");
            }
        }
    });
}

/// A furnace of albedo r: paths of k segments contribute r^(k-1). On a sphere the area within a distance is that on a plane, so that not
/// even the estimate's radius shows; albedos are high enough that many paths have more vertices than are kept.
#[test]
fn furnace() {
    const LAYERS: u32 = 5;
    let scene = canon("furnace_sphere.xml", &[("size", "32")]);
    with_gpu(|gpu| {
        for technique in ALL {
            let settings =
                Settings { lengths: LAYERS, ..settings(&scene, &format!("{technique}:radius=0.1"), Backend::Bvh) };
            let film = render(gpu, &scene, &settings, 512);
            for (channel, r) in [0.5f64, 0.25, 0.75].into_iter().enumerate() {
                let mean = average(&film)[channel].mean;
                let expected = 1.0 / (1.0 - r);
                println!("{technique}, channel {channel}: {mean:.4} against {expected:.4}");
                assert!(
                    (mean / expected - 1.0).abs() < 5e-3,
                    "{technique}, channel {channel}: {mean} against {expected}"
                );
                for layer in 0..LAYERS {
                    let last = if layer + 1 == LAYERS { 1.0 - r } else { 1.0 };
                    let expected = r.powi(layer as i32) / last;
                    let values = film.length(layer as usize);
                    let mean = values.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>()
                        / values.pixels.len() as f64;
                    println!("{technique}, channel {channel}, {} segments: {mean:.5} against {expected:.5}", layer + 1);
                    assert!(
                        (mean / expected - 1.0).abs() < 1e-2,
                        "{technique}, {} segments: {mean} against {expected}",
                        layer + 1
                    );
                }
            }
        }
    });
}

/// Where paths have to end, they end at the same number of segments as those of `path`, by whatever they were found.
#[test]
fn paths_end_where_they_have_to() {
    let scene = canon("cornell_spheres.xml", &[]);
    with_gpu(|gpu| {
        // The forms differ in what they count of direct light, at two segments; beyond that each length is as the one before.
        let all = [(1, &ALL[..1]), (2, &ALL[..]), (5, &ALL[1..3]), (3, &ALL[1..3]), (5, &ALL[..])];
        for (max_depth, techniques) in all.into_iter().take(if has_time() { 5 } else { 3 }) {
            let film = |technique: &str, seed: u32, spp: u32| {
                let settings = Settings {
                    width: SIZE,
                    height: SIZE,
                    max_depth: Some(max_depth),
                    lengths: max_depth + 1,
                    seed,
                    ..settings(&scene, technique, Backend::Bvh)
                };
                render(gpu, &scene, &settings, spp)
            };
            let truth = film("path", 1000, 2048);
            for technique in techniques {
                let found = film(technique, 1, 256);
                assert_off(&format!("{technique}, {max_depth} segments"), &found, &truth, 0.015);
                let longer = found.length(max_depth as usize);
                assert!(
                    longer.pixels.iter().all(|pixel| *pixel == [0.0; 3]),
                    "{technique}: more than {max_depth} segments"
                );
            }
        }
    });
}

/// A camera that looks at the middle of the room, with the default filter.
const CAMERA: &str = "<sensor type='perspective'><float name='fov' value='40'/>
    <transform name='to_world'><lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/></transform></sensor>";

/// Every kind of material, and of light, on both sides of a gathering.
#[test]
fn every_material_and_light() {
    let matte = "<bsdf type='diffuse'><rgb name='reflectance' value='0.3, 0.5, 0.7'/></bsdf>";
    let ball_and_sky =
        "<shape type='sphere'><point name='center' x='0' y='2.2' z='0'/><float name='radius' value='0.4'/>
        <emitter type='area'><rgb name='radiance' value='9, 8, 7'/></emitter></shape>
        <emitter type='constant'><rgb name='radiance' value='0.4, 0.5, 0.6'/></emitter>";
    let spot = "<emitter type='spot'><float name='cutoff_angle' value='35'/><rgb name='intensity' value='30, 28, 25'/>
        <transform name='to_world'><lookat origin='1, 3, 2' target='0, 0, 0' up='0, 1, 0'/></transform></emitter>";
    let mut rooms: Vec<(String, String)> = vec![
        (String::from("a ball and the sky"), [&room(matte, matte), ball_and_sky].concat()),
        (String::from("a spot"), [&room(matte, matte), spot].concat()),
    ];
    for (a, b) in material_pairs() {
        rooms.push((format!("{} and {}", a.0, b.0), [&room(a.1, b.1), LAMP].concat()));
    }
    let [rooms_here, by_photon] = if has_time() { [rooms.len(), 4] } else { [4, 2] };
    rooms.truncate(rooms_here);
    with_gpu(|gpu| {
        for (index, (name, elements)) in rooms.into_iter().enumerate() {
            let scene = scene(&[CAMERA, &elements].concat());
            let truth = film(gpu, &scene, "path", 1000, 1024);
            // vcm has all that photon has, and more.
            for technique in if index < by_photon { &["vcm", "photon"][..] } else { &["vcm"] } {
                assert_off(&format!("{name}, {technique}"), &film(gpu, &scene, technique, 1, 256), &truth, 0.02);
            }
        }
    });
}

/// A smooth coat over a diffuse base: where the base is merged, the coat's mirror image is still to be followed.
#[test]
fn a_coat_is_followed() {
    let coated = "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.1, 0.1, 0.1'/></bsdf>";
    let scene = scene(&[CAMERA, &room(coated, coated), LAMP].concat());
    with_gpu(|gpu| {
        let truth = film(gpu, &scene, "path", 1000, 1024);
        for technique in ["vcm:form=ppm", "photon"] {
            assert_off(technique, &film(gpu, &scene, technique, 1, 256), &truth, 0.02);
        }
    });
}
