//! AOVs against what a scene of known shapes must show, on every backend and through every way to ask for them.

use std::collections::BTreeSet;

use crate::common::program::{render, works};
use crate::common::{backends, canon, has_time, settings, with_gpu};
use exr::prelude::{ReadChannels, ReadLayers};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::render::aovs::{AOVS, AovFilm, find};
use lumbre::render::{Prediction, Renderer, Settings};
use lumbre::scene::material::MaterialDescription;
use lumbre::scene::{Camera, Filter, Mask, Mesh, Scene, SceneBuilder, SurfaceDescription, material};
use lumbre::techniques::AovSettings;

const SIZE: u32 = 24;

/// Renders with one technique, then takes the AOVs.
fn aovs(gpu: &Gpu, scene: &Scene, own: &Settings, spp: u32) -> AovFilm {
    let mut renderer = Renderer::new(gpu, scene, own).unwrap();
    while renderer.advance(spp).unwrap() {}
    renderer.aovs().unwrap().unwrap()
}

fn of(film: &AovFilm, name: &str) -> Vec<DVec3> {
    film.values(find(name).unwrap()).into_iter().map(|value| Vec3::from(value).as_dvec3()).collect()
}

fn with_aovs(scene: &Scene, backend: Backend, through_specular: bool) -> Settings {
    Settings { aovs: Some(AovSettings { through_specular }), ..settings(scene, "path", backend) }
}

/// A wall at z = 0, seen along -z from z = 4, with texture coordinates; before it a ball that glows, and two placements of a group of two
/// squares, one of which is masked away. Far from the world's origin.
const MIDDLE: DVec3 = DVec3::new(1000.0, -500.0, 250.0);
const BALL: (DVec3, f64) = (DVec3::new(-0.5, 0.5, 0.5), 0.4);
const GLOW: [f64; 3] = [0.25, 0.5, 2.0];

fn shapes() -> Scene {
    let mut builder = SceneBuilder::new("shapes");
    (builder.film.width, builder.film.height, builder.film.filter) = (SIZE, SIZE, Filter::Box);
    let matte = |builder: &mut SceneBuilder, colour: [f32; 3]| builder.matte(colour);
    let wall = matte(&mut builder, [0.2, 0.4, 0.6]);
    let square = matte(&mut builder, [0.9, 0.1, 0.1]);
    let ghost = builder.material(material::diffuse([0.5; 3]));
    let ghost = builder.surface(SurfaceDescription {
        front: Some(ghost),
        mask: Some(Mask { opacity: 0.0, texture: None, cutoff: 0.0 }),
        ..Default::default()
    });
    let white = builder.material(material::diffuse([0.8; 3]));
    let ball = builder.surface(SurfaceDescription { front: Some(white), emission: GLOW, ..Default::default() });
    let at = |scale: f64, shift: DVec3| DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::splat(scale)),
        translation: MIDDLE + shift,
    };
    builder.mesh(0, "wall", Mesh::rectangle(), at(8.0, DVec3::ZERO), wall);
    builder.sphere(0, "ball", MIDDLE + BALL.0, BALL.1, ball);
    let group = builder.group("pair");
    builder.mesh(group, "ghost", Mesh::rectangle(), DAffine3::from_translation(DVec3::Z), ghost);
    builder.mesh(group, "square", Mesh::rectangle(), DAffine3::IDENTITY, square);
    builder.instance(group, at(0.25, DVec3::new(0.6, 0.6, 1.0)));
    builder.instance(group, at(0.25, DVec3::new(0.6, -0.6, 1.0)));
    let from = MIDDLE + 4.0 * DVec3::Z;
    builder.cameras.push(Camera::look_at(from, MIDDLE, DVec3::Y, 40.0).unwrap());
    builder.finish().unwrap()
}

/// The object that a ray from the camera meets.
fn met(direction: DVec3) -> u32 {
    let from = 4.0 * DVec3::Z;
    let to_ball = BALL.0 - from;
    let along = to_ball.dot(direction) / direction.length();
    if to_ball.length_squared() - along * along < BALL.1 * BALL.1 {
        return 2;
    }
    let at = from - direction * (3.0 / direction.z);
    let is_square = |y: f64| (at.x - 0.6).abs() < 0.25 && (at.y - y).abs() < 0.25;
    if is_square(0.6) {
        4
    } else if is_square(-0.6) {
        6
    } else {
        1
    }
}

#[test]
fn known_shapes_have_known_values() {
    let scene = shapes();
    let names: Vec<&str> = scene.object_names();
    assert_eq!(names, ["wall", "ball", "ghost", "square", "ghost", "square"]);
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            let own = with_aovs(&scene, backend, false);
            let film = aovs(gpu, &scene, &own, 64);
            let [albedo, normal, geometric, position] =
                ["albedo", "normal", "geometric_normal", "position"].map(|name| of(&film, name));
            let [depth, uv, material, object, emission] =
                ["depth", "uv", "material_id", "object_id", "emission"].map(|name| of(&film, name));
            let near = |what: &str, pixel: usize, found: DVec3, expected: DVec3| {
                let off = (found - expected).length();
                assert!(off < 2e-3 * expected.length().max(1.0), "{what} of pixel {pixel}: {found}, not {expected}");
            };
            let mut seen = BTreeSet::new();
            let plane = scene.cameras[0].image_plane(SIZE, SIZE);
            let mut other = 0;
            for pixel in 0..(SIZE * SIZE) as usize {
                let id = object[pixel].x as u32;
                seen.insert(id);
                let (x, y) = (f64::from(pixel as u32 % SIZE) + 0.5, f64::from(pixel as u32 / SIZE) + 0.5);
                other += usize::from(met(plane.corner + x * plane.dx + y * plane.dy) != id);
                let local = position[pixel] - MIDDLE;
                // What is linear in the position holds for means as well; pixels that show more than one shape are told by their colour.
                let is = |colour: [f64; 3]| (albedo[pixel] - DVec3::from(colour)).length() < 1e-3;
                if is([0.2, 0.4, 0.6]) {
                    assert!(id == 1 && emission[pixel] == DVec3::ZERO);
                    near("normal", pixel, normal[pixel], DVec3::Z);
                    near("geometric normal", pixel, geometric[pixel], DVec3::Z);
                    near("depth", pixel, DVec3::X * local.z, DVec3::ZERO);
                    near("uv", pixel, uv[pixel], DVec3::new(local.x / 16.0 + 0.5, local.y / 16.0 + 0.5, 0.0));
                    assert!(depth[pixel].x >= 3.99 && depth[pixel].x < 4.6, "{}", depth[pixel].x);
                } else if is([0.8; 3]) {
                    assert_eq!(id, 2);
                    near("normal", pixel, normal[pixel], (local - BALL.0) / BALL.1);
                    near("emission", pixel, emission[pixel], DVec3::from(GLOW));
                } else if is([0.9, 0.1, 0.1]) {
                    assert_eq!(id, if local.y > 0.0 { 4 } else { 6 });
                    near("height", pixel, DVec3::X * local.z, DVec3::X);
                    near("normal", pixel, normal[pixel], DVec3::Z);
                }
                let surface = match id {
                    1 => 0,
                    2 => 3,
                    _ => 1,
                };
                assert_eq!(material[pixel].x as usize, scene.surfaces[surface].front as usize + 1, "object {id}");
            }
            assert_eq!(seen, BTreeSet::from([1, 2, 4, 6]), "the masked squares are not there");
            // Of some 90 pixels that an outline runs through: the nearest sample is a sixteenth of a pixel off the centre.
            assert!(other <= 8, "{other} pixels show another object than their centre");
        }
    });
}

/// The samples are those of the image: emission is what paths of one segment find, to the rounding of its sum.
#[test]
fn emission_is_the_image_of_one_segment() {
    let scene = shapes();
    with_gpu(|gpu| {
        let own = Settings { max_depth: Some(1), ..with_aovs(&scene, Backend::Bvh, false) };
        let mut renderer = Renderer::new(gpu, &scene, &own).unwrap();
        while renderer.advance(4).unwrap() {}
        let (image, aovs) = (renderer.film().unwrap().mean(), renderer.aovs().unwrap().unwrap());
        assert_eq!(aovs.samples, 4);
        for (found, expected) in of(&aovs, "emission").iter().zip(&image.pixels) {
            assert!((*found - Vec3::from(*expected).as_dvec3()).abs().max_element() < 1e-6, "{found} {expected:?}");
        }
    });
}

/// A mirror at half a right angle behind a pane of glass that turns nothing; in it the camera sees a wall that it does not face.
fn mirrored(mirror: MaterialDescription) -> Scene {
    let mut builder = SceneBuilder::new("mirror");
    (builder.film.width, builder.film.height) = (8, 8);
    let mirror = builder.material(mirror);
    let mirror = builder.surface(SurfaceDescription { front: Some(mirror), back: Some(mirror), ..Default::default() });
    let pane = builder.material(material::thin_dielectric(1.0 + 1e-7, [1.0; 3], [1.0; 3]));
    let pane = builder.surface(SurfaceDescription { front: Some(pane), ..Default::default() });
    let wall = builder.matte([0.4, 0.4, 0.8]);
    // The camera looks along -z; the mirror at the origin turns that to -x, where the wall stands at x = -3.
    builder.parallelogram(DVec3::new(-1.0, -2.0, -1.0), DVec3::new(2.0, 0.0, 2.0), DVec3::Y * 4.0, mirror);
    builder.parallelogram(DVec3::new(-3.0, -4.0, -4.0), DVec3::Y * 8.0, DVec3::Z * 8.0, wall);
    builder.parallelogram(DVec3::new(-2.0, -2.0, 2.0), DVec3::X * 4.0, DVec3::Y * 4.0, pane);
    builder.cameras.push(Camera::look_at(DVec3::Z * 4.0, DVec3::ZERO, DVec3::Y, 5.0).unwrap());
    builder.finish().unwrap()
}

/// The one object that all pixels show, its mean albedo and its mean depth.
fn shown(gpu: &Gpu, scene: &Scene, through: bool) -> (f64, DVec3, f64) {
    let film = aovs(gpu, scene, &with_aovs(scene, Backend::Bvh, through), 16);
    let objects = of(&film, "object_id");
    assert!(objects.iter().all(|object| *object == objects[0]), "{objects:?}");
    let mean = |name: &str| of(&film, name).into_iter().sum::<DVec3>() / objects.len() as f64;
    (objects[0].x, mean("albedo"), mean("depth").x)
}

/// Mirrors of all kinds, smooth or nearly so; not a rough one, and not a smooth coat on a diffuse base.
#[test]
fn mirrors_and_glass_are_looked_through() {
    let tint = [0.5, 1.0, 1.0];
    let metal =
        |alpha: Option<[f32; 2]>| MaterialDescription::from(material::conductor([0.0; 3], [1.0; 3], tint, alpha));
    let gltf =
        |metallic: f32, roughness: f32| material::layered(tint, roughness, 1.5, material::plain_layers(metallic));
    with_gpu(|gpu| {
        for mirror in [metal(None), metal(Some([1e-3; 2])), gltf(1.0, 0.0)] {
            let (object, albedo, depth) = shown(gpu, &mirrored(mirror), true);
            assert_eq!(object, 2.0, "the wall");
            assert!((albedo - DVec3::new(0.2, 0.4, 0.8)).length() < 0.01, "tinted by the mirror: {albedo}");
            assert!((depth - 7.0).abs() < 0.05, "4 to the mirror and 3 on: {depth}");
        }
        for mirror in [metal(Some([0.2; 2])), gltf(1.0, 0.5), gltf(0.0, 0.0)] {
            let (object, albedo, depth) = shown(gpu, &mirrored(mirror), true);
            assert_eq!(object, 1.0, "the mirror");
            let off = (albedo - DVec3::new(0.5, 1.0, 1.0)).length();
            assert!(off < 0.01 && (depth - 4.0).abs() < 0.05, "{albedo} {depth}");
        }
        let (object, albedo, depth) = shown(gpu, &mirrored(metal(None)), false);
        assert_eq!((object, albedo), (3.0, DVec3::ONE), "the pane");
        assert!((depth - 2.0).abs() < 0.01, "{depth}");
    });
}

/// What they take on the device is predicted to the byte.
#[test]
fn memory_is_predicted() {
    let scene = shapes();
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            let taken = |own: &Settings| {
                let before = gpu.bytes_in_use();
                let renderer = Renderer::new(gpu, &scene, own).unwrap();
                let taken = gpu.bytes_in_use() - before;
                drop(renderer);
                (taken, Prediction::of(&scene, own, Some(gpu)).unwrap().total)
            };
            let with = taken(&with_aovs(&scene, backend, false));
            let without = taken(&settings(&scene, "path", backend));
            assert_eq!(with.0 - without.0, with.1 - without.1);
        }
    });
}

/// The channels of an EXR file.
fn channels(path: &std::path::Path) -> BTreeSet<String> {
    let meta = exr::meta::MetaData::read_from_file(path, false).unwrap();
    meta.headers[0].channels.list.iter().map(|channel| channel.name.to_string()).collect()
}

#[test]
fn the_program_writes_the_layers_that_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    works(render(folder.path(), "cornell.xml", "-n 1 --size 8x8 --aov all -o all.exr"));
    let mut expected: BTreeSet<String> = ["R", "G", "B"].map(String::from).into();
    for row in AOVS {
        expected.extend(row.channels.iter().map(|channel| format!("{}.{channel}", row.name)));
    }
    assert_eq!(channels(&at("all.exr")), expected);
    let objects = lumbre::image::read_attribute(&at("all.exr"), "lumbre.object_names").unwrap().unwrap();
    let objects: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&objects).unwrap();
    assert_eq!(objects.len(), canon("cornell.xml", &[]).object_names().len());

    // Those of a Mitsuba scene, under its names; and the same after a checkpoint.
    let text = std::fs::read_to_string(crate::common::scene_path("furnace_box.xml")).unwrap();
    let (head, tail) = text.split_once("<integrator").unwrap();
    let integrator = |aovs: &str| {
        format!(
            r#"{head}<integrator type="aov"><string name="aovs" value="{aovs}"/><integrator{}"#,
            tail.replacen("</integrator>", "</integrator></integrator>", 1)
        )
    };
    std::fs::write(at("scene.xml"), integrator("nn:sh_normal, dd.y:depth")).unwrap();
    let own = |args: &str| {
        let mut command = crate::common::program::lumbre();
        command.args(["render", "scene.xml", "--size", "8x8"]).args(args.split_whitespace()).current_dir(folder.path());
        command
    };
    works(own("-n 2 -o own.exr"));
    assert!(channels(&at("own.exr")).is_superset(&["nn.X", "nn.Z", "dd.y.Z"].map(String::from).into()));
    works(own("-n 1 -o first.exr --checkpoint c"));
    works(own("-n 2 -o second.exr --checkpoint c --resume"));
    // All but the figures of time in the header.
    let pixels = |name: &str| {
        let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
        let image = read.all_attributes().from_file(at(name)).unwrap();
        let list = image.layer_data.channel_data.list;
        list.iter()
            .map(|channel| channel.sample_data.values_as_f32().map(f32::to_bits).collect())
            .collect::<Vec<Vec<u32>>>()
    };
    assert_eq!(pixels("own.exr"), pixels("second.exr"));
    for (aovs, message) in [
        ("du:dp_du", "the AOV type 'dp_du' of 'du' is not read: valid are albedo"),
        ("depth", "'depth' is not NAME:TYPE"),
    ] {
        std::fs::write(at("scene.xml"), integrator(aovs)).unwrap();
        assert!(crate::common::program::fails(own("-n 1"), 2).contains(message));
    }
}

/// With every technique: the kernels are compiled by the test of agreement as well, so that here one of each family does.
#[test]
fn every_family_has_them() {
    let scene = shapes();
    let all =
        if has_time() { vec!["light", "bdpt", "vcm", "photon", "mlt", "radiosity", "vpl"] } else { vec!["light"] };
    with_gpu(|gpu| {
        let expected = aovs(gpu, &scene, &with_aovs(&scene, Backend::Bvh, false), 2);
        for technique in all {
            let aovs_of = with_aovs(&scene, Backend::Bvh, false).aovs;
            let own = Settings { aovs: aovs_of, ..settings(&scene, technique, Backend::Bvh) };
            let found = aovs(gpu, &scene, &own, 2);
            for row in &AOVS {
                assert_eq!(found.values(row), expected.values(row), "{technique}: {}", row.name);
            }
        }
    });
}

/// docs/aovs.md says of each what the table says.
#[test]
fn the_page_has_the_table() {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/aovs.md")).unwrap();
    for row in &AOVS {
        let channels = row.channels.iter().enumerate().map(|(index, channel)| {
            let layer = if index == 0 { row.name } else { "" };
            format!("`{layer}.{channel}`")
        });
        let line = format!("| `{}` | {} | {} |", row.name, channels.collect::<Vec<_>>().join(", "), row.about);
        assert!(page.contains(&line), "docs/aovs.md lacks: {line}");
    }
}
