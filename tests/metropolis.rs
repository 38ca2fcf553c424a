//! Metropolis light transport: its image is that of `path` and `bdpt` whatever its chains are like, however many there are.
//!
//! Samples of a chain are correlated, so a film's own variance says nothing here: seeds are compared.

use crate::common::room::{LAMP, room, scene};
use crate::common::seeds::{agree, small, tiles, tiles_over};
use crate::common::{LargestZ, assert_same_mean, canon, films, has_time, largest_z, render, verify, with_gpu};
use lumbre::render::film::Film;
use lumbre::render::{Renderer, Settings};
use lumbre::scene::Scene;
use lumbre::statistics::{Estimate, sidak, two_sided_p};

/// With as few candidates as what is easy to find needs.
const FORMS: [&str; 3] =
    ["mlt:form=primary:candidates=65536", "mlt:form=multiplexed:candidates=65536", "mlt:form=paths:candidates=65536"];

const MATTE: &str = "<bsdf type='diffuse'><rgb name='reflectance' value='0.3, 0.5, 0.7'/></bsdf>";

/// All forms against an independent technique, tile by tile. Seeds are compared, see `common::seeds`.
fn agrees(what: &str, scene: &Scene, reference: &str, spp: u32, change: impl Fn(&mut Settings)) {
    agree(&FORMS, what, scene, reference, [40, spp], change);
}

#[test]
fn the_canon() {
    for (name, forms, reference, runs) in
        [("cornell.xml", &FORMS[..], "path", [40, 24]), ("bidirectional_room.xml", &FORMS[1..], "bdpt", [40, 24])]
    {
        agree(forms, name, &canon(name, &[]), reference, runs, |_| {});
    }
}

/// Caustics; and light in `door_ajar` that only chance finds, where chains need their million candidates.
#[test]
#[ignore = "eight minutes: `make thorough` runs it"]
fn light_that_is_hard_to_find() {
    agree(&FORMS[..2], "cornell_spheres.xml", &canon("cornell_spheres.xml", &[]), "bdpt", [40, 24], |_| {});
    let scene = canon("door_ajar.xml", &[]);
    agree(&FORMS[..1], "door_ajar.xml", &scene, "bdpt", [40, 48], |_| {});
    agree(&["mlt:form=multiplexed", "mlt:form=paths"], "door_ajar.xml", &scene, "bdpt", [16, 120], |_| {});
}

/// Every scene there is, every form, against the technique whose paths it takes: how far tiles are off in standard deviations of both
/// (Welch 1947), and the whole image. docs/metropolis.md has what is apart, and why. `LUMBRE_TEST_SCENE` asks for those whose name begins so.
#[test]
#[ignore = "half an hour, and some scenes are known to be apart; docs/metropolis.md has its figures"]
fn the_whole_canon() {
    const SCENES: [&str; 14] = [
        "cornell.xml",
        "cornell_spheres.xml",
        "veach_mis.xml",
        "bidirectional_room.xml",
        "door_ajar.xml",
        "small_vcm.xml",
        "many_lights.xml",
        "cube_point_light.xml",
        "furnace_box.xml",
        "furnace_sphere.xml",
        "caustic_small_light.xml",
        "reflected_caustic.xml",
        "ring_caustic.xml",
        "torus_in_glass.xml",
    ];
    let mut apart = Vec::new();
    with_gpu(|gpu| {
        for name in SCENES {
            if std::env::var("LUMBRE_TEST_SCENE").is_ok_and(|one| !name.starts_with(&one)) {
                continue;
            }
            let scene = canon(name, &[]);
            let over_seeds = |technique: &str, first: u32| {
                let settings = Settings { width: 32, height: 32, seed: first, ..small(&scene, technique) };
                tiles_over(&films(gpu, &scene, &settings, 40, 256))
            };
            let (path, bdpt) = (over_seeds("path", 1000), over_seeds("bdpt", 1000));
            for (form, truth) in ["primary", "multiplexed", "paths"].into_iter().zip([&path, &bdpt, &bdpt]) {
                let technique = &format!("mlt:form={form}");
                let found = over_seeds(technique, 0);
                let LargestZ { z, place, count } = largest_z(&found, truth, 1);
                let [_, a, _] = crate::common::average(&found);
                let [_, b, _] = crate::common::average(truth);
                let spread = 100.0 * (a.variance + b.variance).sqrt() / b.mean;
                println!(
                    "{name} {technique}: largest z {z:.2} ({place}); whole image {:+.2} % +- {spread:.2} %, z {:.2}",
                    100.0 * (a.mean / b.mean - 1.0),
                    a.z(&b)
                );
                if two_sided_p(z) < sidak(0.01, count) {
                    apart.push(format!("{name} {technique}: z {z:.2}"));
                }
            }
        }
    });
    assert!(apart.is_empty(), "{apart:#?}");
}

/// The brightness that an image is scaled by comes with its error: seeds differ by as much.
#[test]
fn brightness_states_its_error() {
    const SEEDS: u32 = 96;
    let scene = canon("cornell.xml", &[("size", "16")]);
    with_gpu(|gpu| {
        for form in FORMS {
            let technique = form.replace("candidates=65536", "chains=128:candidates=4096");
            let films = films(gpu, &scene, &small(&scene, &technique), SEEDS, 16);
            let stated: Vec<_> = films.iter().map(|film| film.brightness.unwrap()).collect();
            let of_mean = Estimate::of(&stated.iter().map(|found| found.mean).collect::<Vec<_>>());
            let found = of_mean.variance * f64::from(SEEDS);
            let expected = stated.iter().map(|found| found.variance).sum::<f64>() / f64::from(SEEDS);
            let ratio = (found / expected).sqrt();
            println!("{technique}: {:.5}, stated error {:.2e}, ratio {ratio:.2}", of_mean.mean, expected.sqrt());
            // Of a variance over 96 seeds, four standard deviations of its root are 0.29.
            assert!((0.71..1.29).contains(&ratio), "{technique}: {ratio}");
            assert!(films[0].error_estimate().is_none(), "correlated samples tell no error");
        }
    });
}

/// Every kind of light, and a background.
#[test]
fn every_light() {
    const CAMERA: &str = "<sensor type='perspective'><float name='fov' value='40'/>
        <transform name='to_world'><lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/></transform>
        <film type='hdrfilm'><integer name='width' value='48'/><integer name='height' value='48'/><rfilter type='box'/></film></sensor>";
    let point = "<emitter type='point'><point name='position' x='0.3' y='2.2' z='1'/><rgb name='intensity' value='9, 8, 7'/></emitter>";
    let sun = "<emitter type='directional'><vector name='direction' x='-0.4' y='-1' z='-0.6'/><rgb name='irradiance' value='3, 2.8, 2.5'/></emitter>";
    let sky = "<emitter type='constant'><rgb name='radiance' value='0.8, 0.9, 1'/></emitter>";
    agrees("all lights", &scene(&[CAMERA, &room(MATTE, MATTE), point, sun, sky, LAMP].concat()), "bdpt", 24, |_| {});
}

/// A low bound makes chains visit all paths nearly alike, and each visit count for the contribution of its path: what they are scaled by must be right. Under
/// a lamp as large as the ceiling of a bright room, half of the light has been scattered three times; between mirrors, only paths that run into
/// the lamp find it.
#[test]
#[ignore = "two minutes, most of which the driver spends on kernels: `make thorough` runs it"]
fn every_bound() {
    let room = |walls: &str, side: f64| {
        scene(&format!(
            "<sensor type='perspective'><float name='fov' value='80'/>
             <transform name='to_world'><lookat origin='0.3, -0.2, 0.9' target='-0.2, 0.1, -1' up='0, 1, 0'/></transform>
             <film type='hdrfilm'><integer name='width' value='48'/><integer name='height' value='48'/><rfilter type='box'/></film></sensor>
             <shape type='cube'><bsdf type='twosided'>{walls}</bsdf></shape>
             <shape type='rectangle'><transform name='to_world'><scale value='{side}'/><rotate x='1' angle='90'/><translate y='0.97'/></transform>
             <bsdf type='diffuse'/><emitter type='area'><rgb name='radiance' value='1, 2, 3'/></emitter></shape>"
        ))
    };
    let matte = "<bsdf type='diffuse'><rgb name='reflectance' value='0.8, 0.75, 0.7'/></bsdf>";
    let mirrors = "<bsdf type='conductor'><string name='material' value='none'/><rgb name='specular_reflectance' value='0.9, 0.8, 0.7'/></bsdf>";
    let forms = FORMS.map(|form| format!("{form}:bound=1.5:large-step=0.8"));
    let forms: Vec<&str> = forms.iter().map(String::as_str).collect();
    agree(&forms, "under a lamp", &room(matte, 0.98), "path", [16, 96], |_| {});
    // Longer paths are few and bright in form paths: so many seeds tell nothing of them.
    agree(&forms, "between mirrors", &room(mirrors, 0.4), "path", [16, 96], |settings| settings.max_depth = Some(8));
}

/// Paths that end early, and those that are longer than any that have vertices from both sides.
#[test]
fn every_length() {
    let scene = canon("cornell.xml", &[]);
    // Those between are layers of `layers_add_up`.
    let all = [Some(1), Some(18), Some(2), Some(4)];
    for max_depth in all.into_iter().take(if has_time() { 4 } else { 2 }) {
        agrees(&format!("{max_depth:?} segments"), &scene, "path", 12, |settings| settings.max_depth = max_depth);
    }
}

/// Lenses, parallel rays, and filters that reach beyond a pixel and below nothing.
#[test]
#[ignore = "two minutes, most of which the driver spends on kernels: `make thorough` runs it"]
fn every_camera_and_filter() {
    for (kind, parameters, filter) in [
        (
            "thinlens",
            "<float name='fov' value='40'/><float name='aperture_radius' value='0.3'/><float name='focus_distance' value='5'/>",
            "gaussian",
        ),
        ("orthographic", "", "mitchell"),
    ] {
        let scale = if kind == "orthographic" { "<scale x='1.6' y='1.6' z='1'/>" } else { "" };
        let sensor = format!(
            "<sensor type='{kind}'>{parameters}<transform name='to_world'>{scale}<lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/>
             </transform><film type='hdrfilm'><integer name='width' value='48'/><integer name='height' value='48'/>
             <rfilter type='{filter}'/></film></sensor>"
        );
        agrees(kind, &scene(&[&sensor, &room(MATTE, MATTE), LAMP].concat()), "bdpt", 24, |_| {});
    }
}

/// However many chains share the same number of mutations, the mean is right.
#[test]
#[ignore = "three minutes: `make thorough` runs it, and every `make test` its short form"]
fn starting_up_leaves_no_bias() {
    verify(&["mlt-start"]);
}

/// Where there is no time for all candidates, chains begin with those that there are, and the mean is right.
#[test]
fn a_start_cut_short() {
    let scene = canon("cornell.xml", &[]);
    with_gpu(|gpu| {
        let truth = tiles(&render(gpu, &scene, &Settings { seed: 1, ..small(&scene, "path") }, 512));
        for form in FORMS {
            let form = form.replace("65536", "10000000");
            let mut renderer = Renderer::new(gpu, &scene, &small(&scene, &form)).unwrap();
            renderer.set_time_budget(0.0);
            let films: Vec<Film> = (1000..1020)
                .map(|seed| {
                    renderer.restart(seed).unwrap();
                    let frames = (0..8).take_while(|_| renderer.advance(12).unwrap() && renderer.progress() == 0.0);
                    assert_eq!(frames.count(), 1, "{form}");
                    while renderer.advance(12).unwrap() {}
                    renderer.film().unwrap()
                })
                .collect();
            assert_same_mean(&form, &tiles_over(&films), &truth, 1);
        }
    });
}

/// Layers by path length add up to the image, and are those of `path`.
#[test]
fn layers_add_up() {
    let scene = canon("cornell.xml", &[]);
    let total =
        |film: &Film, layer: usize| -> f64 { film.length(layer).pixels.iter().map(|pixel| f64::from(pixel[1])).sum() };
    with_gpu(|gpu| {
        let layered = |technique: &str| Settings { lengths: 8, ..small(&scene, technique) };
        let truths = films(gpu, &scene, &layered("path"), 8, 128);
        for technique in FORMS {
            let all = films(gpu, &scene, &layered(technique), 48, 24);
            let plain = render(gpu, &scene, &small(&scene, technique), 24);
            let sum: f64 = (0..8).map(|layer| total(&all[0], layer)).sum();
            let whole: f64 = plain.mean().pixels.iter().map(|pixel| f64::from(pixel[1])).sum();
            assert!((sum / whole - 1.0).abs() < 1e-5, "{technique}: {sum} against {whole}");
            for layer in 0..8 {
                let over =
                    |films: &[Film]| Estimate::of(&films.iter().map(|film| total(film, layer)).collect::<Vec<f64>>());
                let (found, truth) = (over(&all), over(&truths));
                let z = found.z(&truth);
                println!("{technique}, {} segments: {:.2} against {:.2}, z {z:.2}", layer + 1, found.mean, truth.mean);
                assert!(z.abs() < 3.5, "{technique}, {} segments: z = {z}", layer + 1);
            }
        }
    });
}

/// A scene without light has nothing to mutate, and says so.
#[test]
fn darkness_is_an_error() {
    let dark = scene(
        "<sensor type='perspective'><transform name='to_world'><lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/></transform></sensor>
         <emitter type='point'><point name='position' x='0' y='-50' z='0'/><rgb name='intensity' value='1'/></emitter>
         <shape type='rectangle'><transform name='to_world'><scale value='3'/><rotate x='1' angle='-90'/></transform></shape>",
    );
    with_gpu(|gpu| {
        for technique in FORMS {
            let mut renderer = Renderer::new(gpu, &dark, &small(&dark, technique)).unwrap();
            let error = loop {
                match renderer.advance(4) {
                    Ok(true) => {}
                    Ok(false) => panic!("{technique} has rendered darkness"),
                    Err(error) => break error,
                }
            };
            assert!(error.to_string().starts_with("no light in 65536 paths"), "{error}");
            assert_eq!(error.exit_status(), 1);
        }
    });
}
