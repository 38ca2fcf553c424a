//! Paths from the light: with every kind of light, camera, material and filter they give the image that `path` gives.

use crate::common::room::{LAMP, material_pairs, room, scene};
use crate::common::{assert_off, assert_same_mean, canon, has_time, render, settings, verify, with_gpu};
use glam::DVec3;
use lumbre::layout::Layered;
use lumbre::layout::backend::Backend;
use lumbre::render::{Settings, Technique};
use lumbre::scene::material::{layered, plain_layers};
use lumbre::scene::{Camera, Scene, SceneBuilder, SurfaceDescription};

const SIZE: u32 = 48;
const TILE: u32 = 12;

/// A camera at (0, 1, 6) that looks at the middle of the room.
const CAMERA: &str = "<sensor type='perspective'><float name='fov' value='40'/>
    <transform name='to_world'><lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/></transform>
    <film type='hdrfilm'><integer name='width' value='48'/><integer name='height' value='48'/><rfilter type='box'/></film></sensor>";

const MATTE: &str = "<bsdf type='diffuse'><rgb name='reflectance' value='0.3, 0.5, 0.7'/></bsdf>";

/// `bdpt`, and `light` where it finds everything, against `path`. One backend is enough for what no ray knows of: tests/agreement.rs has
/// rooms and caustics on all.
fn agrees(what: &str, scene: &Scene, spp: u32) {
    agrees_with(what, scene, spp, |_| {});
}

fn agrees_with(what: &str, scene: &Scene, spp: u32, change: impl Fn(&mut Settings)) {
    with_gpu(|gpu| {
        let film = |technique: &str, seed: u32, spp: u32| {
            let mut settings = settings(scene, technique, Backend::Bvh);
            change(&mut settings);
            settings.seed = seed;
            render(gpu, scene, &settings, spp)
        };
        let truth = film("path", 1000, 8 * spp);
        let found = |technique: &&str| Technique::parse(technique).unwrap().misses(scene).is_none();
        for (seed, technique) in (0..).zip(["bdpt", "light"].iter().filter(|technique| found(technique))) {
            assert_same_mean(&format!("{what}: {technique}"), &film(technique, seed, spp), &truth, TILE);
        }
        assert!(truth.width >= SIZE && truth.average()[1] > 1e-3, "{what} is not dark");
    });
}

/// Every kind of light, over matte surfaces.
#[test]
fn every_light() {
    let ball_lamp = "<shape type='sphere'><point name='center' x='0' y='2.2' z='0'/><float name='radius' value='0.3'/>
        <emitter type='area'><rgb name='radiance' value='20, 18, 15'/></emitter></shape>";
    let point = "<emitter type='point'><point name='position' x='0.3' y='2.2' z='1'/><rgb name='intensity' value='9, 8, 7'/></emitter>";
    let spot = "<emitter type='spot'><float name='cutoff_angle' value='35'/><rgb name='intensity' value='30, 28, 25'/>
        <transform name='to_world'><lookat origin='1, 3, 2' target='0, 0, 0' up='0, 1, 0'/></transform></emitter>";
    let sun = "<emitter type='directional'><vector name='direction' x='-0.4' y='-1' z='-0.6'/><rgb name='irradiance' value='3, 2.8, 2.5'/></emitter>";
    let sky = "<emitter type='constant'><rgb name='radiance' value='0.8, 0.9, 1'/></emitter>";
    let lights = [
        ("a lamp and a ball", [LAMP, ball_lamp].concat()),
        ("a point, a spot and the sun", [point, spot, sun].concat()),
        ("the sky", sky.to_owned()),
        // What adds to the others is how one is chosen: many_lights has that, too, and tests/metropolis.rs has this very room.
        ("all", [point, spot, sun, sky, LAMP].concat()),
    ];
    for (what, light) in lights.into_iter().filter(|(what, _)| *what != "all" || has_time()) {
        agrees(what, &scene(&[CAMERA, &room(MATTE, MATTE), &light].concat()), 64);
    }
}

/// Materials that reflect and refract in every way, lit by a lamp: shading normals, rough and smooth glass, coatings.
#[test]
fn every_material() {
    for (a, b) in material_pairs() {
        // Smooth glass between lamp and floor makes caustics that `path` finds only by running into the lamp: it is large.
        agrees(&format!("{} and {}", a.0, b.0), &scene(&[CAMERA, &room(a.1, b.1), LAMP].concat()), 96);
    }
}

/// A ball of coloured rough glass that absorbs, over a floor: a lamp in it, a lamp beside it, and both; seen from outside and from
/// within. Paths from the lights begin in the medium that the light is in, and next-event estimation goes through the one that it leaves
/// the surface to. `path-implicit`, which has none, says what is right.
#[test]
fn lights_within_what_absorbs() {
    let outside = DVec3::new(0.0, 1.6, 6.0);
    for (what, inner, outer, eye) in [
        ("a lamp within", true, false, outside),
        ("a lamp beside", false, true, outside),
        ("both, from within", true, true, DVec3::new(0.0, 1.1, 0.6)),
    ] {
        // The last one has both.
        if what == "a lamp beside" && !has_time() {
            continue;
        }
        let mut builder = SceneBuilder::new(what);
        let floor = builder.matte([0.6, 0.5, 0.4]);
        builder.parallelogram(DVec3::new(-4.0, 0.0, -4.0), DVec3::Z * 8.0, DVec3::X * 8.0, floor);
        let volume = Layered { transmission: 1.0, is_volume: 1, absorption: [0.2, 0.9, 2.0], ..plain_layers(0.0) };
        let glass = Some(builder.material(layered([1.0; 3], 0.6, 1.5, volume)));
        let glass = builder.surface(SurfaceDescription { front: glass, back: glass, ..SurfaceDescription::default() });
        builder.sphere(0, "glass", DVec3::new(0.0, 1.0, 0.0), 0.9, glass);
        let lamp = builder.surface(SurfaceDescription { emission: [9.0, 8.0, 7.0], ..SurfaceDescription::default() });
        if inner {
            builder.sphere(0, "lamp", DVec3::new(0.0, 1.0, 0.0), 0.3, lamp);
        }
        if outer {
            builder.parallelogram(DVec3::new(-1.0, 3.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0, lamp);
        }
        builder.cameras.push(Camera::look_at(eye, DVec3::new(0.0, 0.6, 0.0), DVec3::Y, 40.0).unwrap());
        (builder.film.width, builder.film.height) = (SIZE, SIZE);
        let scene = builder.finish().unwrap();
        let absorption = scene.lights.iter().map(|light| light.absorption[1]).collect::<Vec<_>>();
        assert_eq!((absorption.contains(&0.9), absorption.contains(&0.0)), (inner, outer), "{what}: {absorption:?}");
        with_gpu(|gpu| {
            let film = |technique: &str, seed: u32, spp: u32| {
                render(gpu, &scene, &Settings { seed, ..settings(&scene, technique, Backend::Bvh) }, spp)
            };
            let truth = film("path-implicit", 1000, 3072);
            for (seed, (technique, spp)) in (0..).zip([("path", 512), ("light", 512), ("bdpt", 128)]) {
                assert_same_mean(&format!("{what}: {technique}"), &film(technique, seed, spp), &truth, TILE);
            }
            // From outside, as in the first one, or from within.
            if inner && !outer || has_time() {
                let direct = film("direct", 0, 512);
                assert_same_mean(&format!("{what}: direct"), &direct, &film("direct:sampling=bsdf", 1, 2048), TILE);
            }
        });
    }
}

/// A lamp in a ball whose lobes have several indices of refraction in the same direction: refraction beside diffuse transmission, and dispersion.
/// What lights the wall around it crossed them an odd number of times.
#[test]
fn lobes_of_several_indices() {
    let glass = Layered { transmission: 0.5, is_volume: 1, ..plain_layers(0.0) };
    for (what, layers) in [
        ("dispersion", Layered { transmission: 1.0, dispersion: 10.0, ..glass }),
        ("diffuse transmission", Layered { diffuse_transmission: 0.7, ..glass }),
    ] {
        let mut builder = SceneBuilder::new(what);
        let wall = builder.matte([0.5; 3]);
        builder.sphere(0, "wall", DVec3::ZERO, 1.6, wall);
        let ball = builder.material(layered([0.9, 0.8, 0.7], 0.6, 1.5, layers));
        let ball = builder.both_sides(ball);
        builder.sphere(0, "ball", DVec3::ZERO, 0.9, ball);
        let lamp = builder.surface(SurfaceDescription { emission: [9.0; 3], ..SurfaceDescription::default() });
        builder.sphere(0, "lamp", DVec3::ZERO, 0.6, lamp);
        let eye = DVec3::new(0.0, 0.0, 1.0); // sees the wall alone
        builder.cameras.push(Camera::look_at(eye, 2.0 * eye, DVec3::Y, 90.0).unwrap());
        (builder.film.width, builder.film.height) = (SIZE / 2, SIZE / 2);
        let scene = builder.finish().unwrap();
        with_gpu(|gpu| {
            let film = |technique: &str, seed: u32, spp: u32| {
                render(gpu, &scene, &Settings { seed, ..settings(&scene, technique, Backend::Bvh) }, spp)
            };
            let truth = film("path", 1000, 2048);
            for (seed, (technique, spp)) in (0..).zip([("light", 6144), ("bdpt", 512)]) {
                let found = film(technique, seed, spp);
                assert_off(&format!("{what}: {technique}"), &found, &truth, 0.01);
                assert_same_mean(&format!("{what}: {technique}"), &found, &truth, TILE);
            }
        });
    }
}

/// Normals that are not those of the surface, which paths from the light need Veach's adjoint of; a scene in other units. tests/verify.rs has the
/// short form of both every time.
#[test]
#[ignore = "half a minute: `make thorough` runs it"]
fn normals_and_units() {
    verify(&["shading-normals", "units"]);
}

/// Lenses and parallel rays see light subpaths as their own paths see the scene; so do filters wider than a pixel, and negative ones.
#[test]
fn every_camera_and_filter() {
    let sensors = [
        (
            "a lens and a Gaussian",
            "thinlens",
            "<float name='fov' value='40'/><float name='aperture_radius' value='0.3'/><float name='focus_distance' value='5'/>",
            "gaussian",
        ),
        ("parallel rays and a cubic", "orthographic", "", "mitchell"),
        ("a tent", "perspective", "<float name='fov' value='40'/>", "tent"),
    ];
    for (what, kind, parameters, filter) in sensors {
        let scale = if kind == "orthographic" { "<scale x='1.6' y='1.6' z='1'/>" } else { "" };
        let sensor = format!(
            "<sensor type='{kind}'>{parameters}<transform name='to_world'>{scale}<lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/>
             </transform><film type='hdrfilm'><integer name='width' value='48'/><integer name='height' value='48'/>
             <rfilter type='{filter}'/></film></sensor>"
        );
        agrees(what, &scene(&[&sensor, &room(MATTE, MATTE), LAMP].concat()), 64);
    }
}

/// Light paths run into a lens (t = 0) so seldom that good weights hide whether they do it right: with all strategies alike they count as
/// much as any other.
#[test]
fn light_paths_run_into_a_lens() {
    let sensor = "<sensor type='thinlens'><float name='fov' value='40'/><float name='aperture_radius' value='1'/>
        <float name='focus_distance' value='5'/><transform name='to_world'><lookat origin='0, 1, 6' target='0, 0.8, 0' up='0, 1, 0'/></transform>
        <film type='hdrfilm'><integer name='width' value='48'/><integer name='height' value='48'/><rfilter type='box'/></film></sensor>";
    let scene = scene(&[sensor, &room(MATTE, MATTE), LAMP].concat());
    with_gpu(|gpu| {
        let film = |technique: &str, seed: u32, spp: u32| {
            let settings = Settings { max_depth: Some(3), seed, ..settings(&scene, technique, Backend::Bvh) };
            render(gpu, &scene, &settings, spp)
        };
        assert_same_mean("all alike", &film("bdpt:weights=none", 0, 1024), &film("path", 1000, 2048), TILE);
    });
}

/// More lights than a table takes.
#[test]
fn many_lights() {
    agrees_with("many_lights.xml", &canon("many_lights.xml", &[]), 64, |settings| {
        (settings.width, settings.height) = (SIZE, SIZE);
    });
}

/// Whatever weighs the strategies, the mean is the same, and so it is where paths have to end.
#[test]
fn weights_and_lengths_change_no_mean() {
    let scene = canon("cornell_spheres.xml", &[("size", "48")]);
    with_gpu(|gpu| {
        let all = [(1, "power"), (3, "balance"), (18, "power"), (2, "power"), (5, "balance")];
        for (max_depth, weights) in all.into_iter().take(if has_time() { 5 } else { 3 }) {
            let film = |technique: &str, seed: u32, spp: u32| {
                let settings =
                    Settings { max_depth: Some(max_depth), seed, ..settings(&scene, technique, Backend::Bvh) };
                render(gpu, &scene, &settings, spp)
            };
            let truth = film("path", 1000, 1024);
            let technique = format!("bdpt:weights={weights}");
            let what = format!("{technique}, {max_depth} segments");
            assert_same_mean(&what, &film(&technique, 0, 128), &truth, TILE);
        }
    });
}
