//! What glTF files hold beyond still, opaque meshes of one place each: vertex alpha, light on both sides, instances, poses, compression.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::common::gltf::{
    F32, FOUR, FOUR_LINEAR, Gltf, SQUARE_UVS, U8, U16, floats, matte, merge, sun, textured, with,
};
use crate::common::{assert_mean, assert_same_mean, average, backends, render, settings, tile_average, with_gpu};
use base64::Engine;
use glam::Vec3;
use lumbre::render::film::Film;
use lumbre::scene::{LightSelection, LoadOptions, Scene};
use serde_json::{Value, json};

fn film(scene: &Scene, technique: &str, spp: u32) -> Film {
    with_gpu(|gpu| render(gpu, scene, &settings(scene, technique, backends(gpu)[0]), spp))
}

fn mean(what: &str, scene: &Scene, spp: u32, expected: f64) {
    let measured = average(&film(scene, "path", spp))[0];
    if expected == 0.0 {
        assert_eq!(measured.mean, 0.0, "{what}");
    } else {
        assert_mean(what, measured, expected);
    }
}

/// The corners of all triangles in the world.
fn corners(scene: &Scene) -> Vec<Vec3> {
    let place = |instance: &lumbre::scene::Instance| {
        let group = scene.groups[instance.group].primitives();
        let corners = scene.primitives[group].iter().flat_map(|p| [p.v0, p.v1, p.v2]).map(Vec3::from);
        let map = instance.to_world;
        corners.map(|corner| (map.transform_point3(corner.as_dvec3()) + scene.origin).as_vec3()).collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(place).collect()
}

fn has_corner(scene: &Scene, corner: [f32; 3]) {
    let corners = corners(scene);
    assert!(corners.iter().any(|found| found.distance(Vec3::from(corner)) < 1e-5), "{corner:?} is not in {corners:?}");
}

/// An unlit file with a square of this material and this alpha of the colours of all its vertices.
fn coloured(material: Value, alpha: f32) -> Gltf {
    with_alphas(material, [alpha; 4])
}

/// An unlit file with a square of this material and these alphas of the colours of its vertices.
fn with_alphas(material: Value, alphas: [f32; 4]) -> Gltf {
    let mut file = Gltf::new();
    let colours: Vec<f32> = alphas.into_iter().flat_map(|alpha| [1.0, 1.0, 1.0, alpha]).collect();
    let colours = file.accessor(&floats(&colours), F32, "VEC4", 4, json!({}));
    let mesh = file.square(with(matte([0.0; 3]), material), json!({"attributes": {"COLOR_0": colours}}));
    file.node(json!({"mesh": mesh}));
    file
}

/// `COLOR_0` multiplies the base colour's alpha, for paths and for shadow rays.
#[test]
fn vertices_have_an_alpha() {
    for (what, material, expected) in [
        ("blend", json!({"alphaMode": "BLEND", "doubleSided": true}), 0.75),
        (
            "blend with a factor of 1/2",
            json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 0.5]}}),
            0.875,
        ),
        ("mask", json!({"alphaMode": "MASK", "alphaCutoff": 0.3}), 1.0),
        ("mask at less", json!({"alphaMode": "MASK", "alphaCutoff": 0.2}), 0.0),
        ("opaque", json!({}), 0.0),
    ] {
        // Before a wall of albedo 1/2 that only the sun behind the camera lights, through the square.
        let mut file = coloured(material, 0.25);
        let wall = file.square(matte([0.5; 3]), json!({}));
        file.node(json!({"mesh": wall, "translation": [0, 0, -2], "scale": [9, 9, 1]}));
        sun(&mut file, 2.0 * PI);
        // The sun's light falls on the wall by the square alone, as that lies before all that is seen.
        mean(what, &file.load(), 4096, expected * expected);
    }
    // A light emits no more than it stops: its next-event estimation must agree with its emission.
    let lamp = json!({"alphaMode": "BLEND", "emissiveFactor": [1, 1, 1], "doubleSided": true});
    let mut file = with_alphas(lamp, [0.9, 0.1, 0.3, 0.7]);
    file.json["nodes"][1]["translation"] = json!([0, 0, 7]);
    let wall = file.square(matte([0.8; 3]), json!({}));
    file.node(json!({"mesh": wall, "scale": [1.5, 1.5, 1]}));
    let scene = file.load();
    let (path, implicit) = (film(&scene, "path", 256), film(&scene, "path-implicit", 4096));
    assert!(scene.uvs.iter().all(|uv| *uv == [0.0; 2]), "no texture asks for coordinates");
    assert_same_mean("light of an opacity at its vertices", &path, &implicit, 16);
}

/// A double-sided material emits from both sides; from behind a single-sided one is black.
#[test]
fn double_sided_materials_emit_on_both_sides() {
    let lamp = |double: bool, half_turn: bool| {
        let mut file = Gltf::new();
        let mesh =
            file.square(with(matte([0.0; 3]), json!({"emissiveFactor": [1, 1, 1], "doubleSided": double})), json!({}));
        file.node(
            json!({"mesh": mesh, "rotation": [0, if half_turn { 1 } else { 0 }, 0, if half_turn { 0 } else { 1 }]}),
        );
        file
    };
    for (double, half_turn, expected) in
        [(true, true, 1.0), (true, false, 1.0), (false, true, 0.0), (false, false, 1.0)]
    {
        mean("seen", &lamp(double, half_turn).load(), 4, expected);
    }
    // The light behind it on a wall, as that of a lamp that faces the wall; the camera looks from between them.
    let lit = |double: bool| {
        let mut file = lamp(double, !double);
        file.json["nodes"][1]["translation"] = json!([0, 0, 6]);
        let wall = file.square(matte([0.8; 3]), json!({}));
        file.node(json!({"mesh": wall, "scale": [1.5, 1.5, 1]}));
        file
    };
    for (technique, lights) in
        [("path", LightSelection::Power), ("path", LightSelection::Tree), ("bdpt", LightSelection::Power)]
    {
        let [double, single] = [true, false].map(|double| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("scene.gltf");
            std::fs::write(&path, lit(double).text()).unwrap();
            let mut scene = lumbre::scene::load(&path, &LoadOptions { lights, ..LoadOptions::default() }).unwrap();
            (scene.film.width, scene.film.height) = (16, 16);
            film(&scene, technique, 256)
        });
        // Of a wall that is lit evenly: a thousandth of it is noise.
        let [double, single] = [double, single].map(|film| average(&film)[0].mean);
        let what = format!("{technique} by {lights:?}: {double} against {single}");
        assert!(single > 0.01 && (double / single - 1.0).abs() < 5e-3, "{what}");
    }
    let scene = lit(true).load();
    assert_eq!((scene.lights.len(), scene.primitives.len()), (4, 4), "a light for each side of each triangle");
}

/// Angles that differ by less than single precision are valid, and a hard edge.
#[test]
fn cones_may_have_a_hard_edge() {
    let spot = |inner: f64, outer: f64| {
        let mut file = Gltf::new();
        let mesh = file.square(matte([1.0; 3]), json!({}));
        file.node(json!({"mesh": mesh}));
        let cones = json!({"innerConeAngle": inner, "outerConeAngle": outer});
        file.light(json!({"type": "spot", "intensity": PI, "spot": cones}), json!({"translation": [0, 0, 10]}));
        file
    };
    // A disk of radius 10 tan 0.05 on a square of side 2, at a distance of 10.
    let angle = 0.05f64;
    let scene = spot(angle, f64::from_bits(angle.to_bits() + 1)).load();
    let area = |angle: f64| PI * (10.0 * angle.tan()).powi(2) / 4.0;
    assert_mean(
        "the disk",
        average(&film(&scene, "path", 1024))[0],
        area(angle) / 100.0 * (1.0 - 0.75 * angle * angle),
    );
    let message = spot(0.05, 0.05).try_load(&[]).unwrap_err().to_string();
    assert!(message.contains("lights[0]") && message.contains("cone angles"), "{message}");
}

#[test]
fn nodes_may_place_a_mesh_many_times() {
    let mut file = Gltf::new();
    let mesh = file.square(matte([0.5; 3]), json!({}));
    let translations =
        file.accessor(&floats(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 7.0, 0.0]), F32, "VEC3", 3, json!({}));
    let s = FRAC_1_SQRT_2 as f32;
    let rotations = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, s, s], [0.0, 0.0, 0.0, 1.0]];
    let rotations = file.accessor(&floats(rotations.as_flattened()), F32, "VEC4", 3, json!({}));
    let scales = file.accessor(&floats(&[1.0, 1.0, 1.0, 2.0, 1.0, 1.0, -1.0, 1.0, 1.0]), F32, "VEC3", 3, json!({}));
    let attributes = json!({"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales, "_ID": 99});
    file.node(json!({
        "mesh": mesh, "translation": [0, 0, 1],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    }));
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    sun(&mut file, 1.0);
    let scene = file.load();
    assert_eq!((scene.primitives.len(), scene.instances.len()), (2, 3), "stored once");
    // Twice as wide, then turned by a quarter, then moved.
    for corner in [[1.0, 1.0, 1.0], [6.0, 2.0, 1.0], [4.0, -2.0, 1.0], [-1.0, 8.0, 1.0]] {
        has_corner(&scene, corner);
    }
    file.json["accessors"][scales]["count"] = json!(2);
    let message = file.try_load(&[]).unwrap_err().to_string();
    assert!(message.contains("EXT_mesh_gpu_instancing have different numbers"), "{message}");
    // Lights have places of their own.
    let mut file = Gltf::new();
    let mesh = file.square(json!({"emissiveFactor": [1, 1, 1]}), json!({}));
    let translations = file.accessor(&floats(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]), F32, "VEC3", 2, json!({}));
    let attributes = json!({"TRANSLATION": translations});
    file.node(json!({"mesh": mesh, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}}));
    let scene = file.load();
    assert_eq!((scene.primitives.len(), scene.lights.len(), scene.instances.len()), (4, 4, 1));
}

#[test]
fn meshes_morph_by_their_default_weights() {
    let mut file = Gltf::new();
    let moves = [[0.0f32, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0]];
    let first = file.accessor(&floats(moves.as_flattened()), F32, "VEC3", 4, json!({}));
    let second = file.accessor(&floats(&[4.0, 0.0, 0.0].repeat(4)), F32, "VEC3", 4, json!({}));
    let targets = json!({"targets": [{"POSITION": first}, {"POSITION": second}]});
    let mesh = file.square(matte([0.5; 3]), targets);
    merge(&mut file.json["meshes"][mesh], json!({"weights": [0.5, 0]}));
    file.node(json!({"mesh": mesh}));
    file.node(json!({"mesh": mesh, "weights": [0, 0.25], "translation": [0, 10, 0]}));
    sun(&mut file, 1.0);
    let scene = file.load();
    // The mesh's weights, and those of a node in their place.
    for corner in [[1.0, 1.0, 1.0], [-1.0, 1.0, 0.0], [2.0, 11.0, 0.0], [0.0, 9.0, 0.0]] {
        has_corner(&scene, corner);
    }
    assert_eq!(corners(&scene).len(), 12);
    assert!(!scene.warnings.iter().any(|warning| warning.contains("morph")), "{:?}", scene.warnings);
    merge(&mut file.json["accessors"][first], json!({"count": 3}));
    let message = file.try_load(&[]).unwrap_err().to_string();
    assert!(
        message.contains("meshes[0].primitives[0].targets[0].POSITION") && message.contains("3 elements"),
        "{message}"
    );
}

#[test]
fn skins_stand_where_their_joints_do() {
    let mut file = Gltf::new();
    let joints = file.accessor(&[0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0], U8, "VEC4", 4, json!({}));
    // The third corner between both joints, the fourth with the second.
    let weights = [[1.0f32, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];
    let weights = file.accessor(&floats(weights.as_flattened()), F32, "VEC4", 4, json!({}));
    let normals = file.accessor(&floats(&[0.0, 0.0, 1.0].repeat(4)), F32, "VEC3", 4, json!({}));
    let attributes = json!({"attributes": {"JOINTS_0": joints, "WEIGHTS_0": weights, "NORMAL": normals}});
    let mesh = file.square(matte([0.5; 3]), attributes);
    let identity = [1.0f32, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let mut moved = identity;
    moved[14] = -1.0;
    let inverse = file.accessor(&floats(&[identity, moved].concat()), F32, "MAT4", 2, json!({}));
    let tip = file.add("nodes", json!({"translation": [0, 0, 4]}));
    let root = file.node(json!({"children": [tip], "translation": [0, 3, 0]}));
    let skin = file.add("skins", json!({"joints": [root, tip], "inverseBindMatrices": inverse}));
    // Its own place is of no account.
    file.node(json!({"mesh": mesh, "skin": skin, "translation": [100, 0, 0]}));
    sun(&mut file, 1.0);
    let scene = file.load();
    // The first joint moves by (0, 3, 0), the second by (0, 3, 3).
    for corner in [[-1.0, 2.0, 0.0], [1.0, 2.0, 0.0], [1.0, 4.0, 1.5], [-1.0, 4.0, 3.0]] {
        has_corner(&scene, corner);
    }
    for (change, expected) in [
        (json!({"joints": [root]}), ["JOINTS_0", "joint 1"]),
        (json!({"joints": [root, tip, root]}), ["skins[0]", "inverseBindMatrices"]),
        (json!({"joints": [root, 77]}), ["skins[0]", "nodes[77]"]),
    ] {
        let mut broken = file.clone();
        merge(&mut broken.json["skins"][0], change);
        let message = broken.try_load(&[]).unwrap_err().to_string();
        assert!(expected.iter().all(|part| message.contains(part)), "{expected:?}: {message}");
    }
}

#[test]
fn webp_images_are_textures() {
    let webp = image::RgbaImage::from_raw(2, 2, FOUR.concat()).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    webp.write_to(&mut bytes, image::ImageFormat::WebP).unwrap();
    let mut file = textured(&FOUR, json!({}));
    let expected = file.load();
    let view = file.view(&bytes.into_inner(), json!({}));
    let image = file.add("images", json!({"bufferView": view, "mimeType": "image/webp"}));
    file.json["textures"][0] = json!({"sampler": 0, "extensions": {"EXT_texture_webp": {"source": image}}});
    file.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let found = file.load();
    assert_eq!(found.images[0].bytes(), expected.images[0].bytes());
}

#[test]
fn compressed_views_are_read() {
    let encoded: Value = serde_json::from_str(include_str!("inputs/meshopt.json")).unwrap();
    let bytes = |name: &str| base64::engine::general_purpose::STANDARD.decode(encoded[name].as_str().unwrap()).unwrap();
    let mut file = Gltf::new();
    let (positions, indices) = (bytes("positions"), bytes("triangles"));
    let starts = [file.bytes.len(), file.bytes.len() + positions.len()];
    file.bytes.extend([&positions[..], &indices].concat());
    let view = |index: usize, length: usize, stride: usize, count: usize, mode: &str| {
        json!({"buffer": 1, "byteLength": stride * count, "extensions": {"EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": starts[index], "byteLength": length, "byteStride": stride, "count": count, "mode": mode
        }}})
    };
    let first = file.add("bufferViews", view(0, positions.len(), 12, 289, "ATTRIBUTES"));
    let second = file.add("bufferViews", view(1, indices.len(), 2, 1545, "TRIANGLES"));
    let position =
        file.add("accessors", json!({"bufferView": first, "componentType": F32, "type": "VEC3", "count": 289}));
    let index =
        file.add("accessors", json!({"bufferView": second, "componentType": U16, "type": "SCALAR", "count": 1545}));
    let mesh = file.add("meshes", json!({"primitives": [{"attributes": {"POSITION": position}, "indices": index}]}));
    file.node(json!({"mesh": mesh}));
    let data = base64::engine::general_purpose::STANDARD.encode(&file.bytes);
    file.json["buffers"] = json!([
        {"byteLength": file.bytes.len(), "uri": format!("data:;base64,{data}")},
        {"byteLength": 9999, "extensions": {"EXT_meshopt_compression": {"fallback": true}}}
    ]);
    file.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    let scene = file.load();
    assert_eq!(scene.primitives.len(), 515);
    has_corner(&scene, [4.0, 4.0, ((16 * 7 + 16 * 13) % 11) as f32 / 16.0]);
    for (change, expected) in [
        (json!({"count": 288}), "3456 bytes decompressed"),
        (json!({"mode": "OTHER"}), "mode is unknown"),
        (json!({"byteLength": 99}), "end too early"),
        (json!({"byteStride": 10}), "multiple of 4"),
        (json!({"filter": "QUATERNION"}), "byteStride of 12"),
    ] {
        let mut broken = file.clone();
        merge(&mut broken.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"], change);
        let message = broken.try_load(&[]).unwrap_err().to_string();
        assert!(message.contains("bufferViews[0]") && message.contains(expected), "{expected}: {message}");
    }
}

/// What the Khronos validator calls valid: integers written as fractions, buffers that nothing refers to and that have no data.
#[test]
fn odd_but_valid_files_load() {
    let mut file = textured(&FOUR, json!({}));
    let expected = file.load();
    for pointer in ["/accessors/0/count", "/bufferViews/0/byteLength", "/meshes/0/primitives/0/material", "/scene"] {
        let value = file.json.pointer_mut(pointer).unwrap();
        *value = json!(value.as_f64().unwrap());
    }
    assert!(file.text().contains("4.0"), "{}", file.text());
    let found = file.load();
    assert_eq!((found.primitives, found.uvs), (expected.primitives, expected.uvs));

    let data = base64::engine::general_purpose::STANDARD.encode(&file.bytes);
    let uri = format!("data:;base64,{data}");
    file.json["buffers"] = json!([{"byteLength": file.bytes.len(), "uri": uri}, {"byteLength": 7}]);
    file.load();
    file.json["bufferViews"][0]["buffer"] = json!(1);
    let message = file.try_load(&[]).unwrap_err().to_string();
    assert!(message.contains("buffers[1]: has no uri"), "{message}");
}

/// What is compressed in ways that are not read says so, whether the file requires it or only gives nothing else.
#[test]
fn what_cannot_be_decompressed_says_so() {
    let mut file = textured(&FOUR, json!({}));
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let message = file.try_load(&[]).unwrap_err().to_string();
    assert!(message.contains("compressed by Draco, and must be decompressed before"), "{message}");
    file.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    let message = file.try_load(&[]).unwrap_err().to_string();
    assert!(message.contains("KTX2, and must be PNG, JPEG or WebP"), "{message}");
    file.json["extensionsRequired"] = json!([]);
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    merge(primitive, json!({"extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}}));
    let position = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
    file.load();
    file.json["accessors"][position].as_object_mut().unwrap().remove("bufferView");
    let message = file.try_load(&[]).unwrap_err().to_string();
    assert!(message.contains("meshes[0].primitives[0]: its data are in KHR_draco_mesh_compression"), "{message}");
}

/// A square of one colour everywhere under a sun that comes from an angle off the camera's axis, towards x or y: its radiance.
fn shine(material: Value, tilt: f64, towards_y: bool) -> f64 {
    let mut file = Gltf::new();
    let normals = file.accessor(&floats(&[0.0, 0.0, 1.0].repeat(4)), F32, "VEC3", 4, json!({}));
    let mesh = file.square(material, json!({"attributes": {"NORMAL": normals}}));
    file.node(json!({"mesh": mesh}));
    let (sin, cos) = (0.5 * tilt).sin_cos();
    // Turned so that it comes from +x or +y.
    let turn = if towards_y { json!([-sin, 0, 0, cos]) } else { json!([0, sin, 0, cos]) };
    file.light(json!({"type": "directional", "intensity": 1}), json!({"rotation": turn}));
    average(&film(&file.load(), "path", 4))[0].mean
}

/// A highlight is wider along the tangent, or along what the rotation makes of it (KHR_materials_anisotropy).
#[test]
fn anisotropy_widens_the_highlight_along_its_direction() {
    let (roughness, strength, tilt) = (0.5f64, 0.8f64, 0.6f64);
    let metal = |rotation: f64| {
        json!({
            "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": roughness},
            "extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": strength, "anisotropyRotation": rotation}}
        })
    };
    // D G2 / (4 cos): GGX with a slope of tan(tilt / 2) along one axis, seen along the normal, with alpha (a + (1 - a) s^2, a).
    let alpha = roughness * roughness;
    let wide = alpha + (1.0 - alpha) * strength * strength;
    let expected = |along: f64| {
        let (sin, cos) = (0.5 * tilt).sin_cos();
        let e = (sin / along).powi(2) + cos * cos;
        let d = 1.0 / (PI * wide * alpha * e * e);
        let lambda = 0.5 * ((1.0 + (along * tilt.tan()).powi(2)).sqrt() - 1.0);
        d / (1.0 + lambda) / 4.0
    };
    for (rotation, towards_y, along) in
        [(0.0, false, wide), (0.0, true, alpha), (0.5 * PI, false, alpha), (0.5 * PI, true, wide), (PI, false, wide)]
    {
        let found = shine(metal(rotation), tilt, towards_y);
        let expected = expected(along);
        assert!((found / expected - 1.0).abs() < 1e-3, "{rotation} {towards_y}: {found} against {expected}");
    }
    // Halfway between the axes it does matter which way round the rotation goes.
    let [one, other] = [0.25 * PI, -0.25 * PI].map(|rotation| shine(metal(rotation), tilt, true));
    assert!((one / other - 1.0).abs() < 1e-3, "{one} {other}");
}

/// Of a film without thickness nothing is seen; of another one colours, which turn with the angle.
#[test]
fn thin_films_have_colours() {
    let film = |thickness: f64| {
        json!({
            "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0.3, "baseColorFactor": [0.5, 0.5, 0.5, 1]},
            "extensions": {"KHR_materials_iridescence":
                {"iridescenceFactor": 1, "iridescenceIor": 1.8, "iridescenceThicknessMaximum": thickness}}
        })
    };
    let mut plain = film(0.0);
    let vanished = shine(film(0.0), 0.3, false);
    plain["extensions"] = json!({});
    let bare = shine(plain, 0.3, false);
    assert!((vanished / bare - 1.0).abs() < 1e-2, "{vanished} {bare}");
    let red = [200.0, 280.0, 360.0].map(|thickness| shine(film(thickness), 0.3, false));
    assert!(red.iter().any(|red| (red / bare - 1.0).abs() > 0.2), "{red:?} {bare}");
}

/// What is scattered to the other side (KHR_materials_diffuse_transmission), of a leaf that reflects nothing at its surface.
#[test]
fn leaves_let_diffuse_light_through() {
    let leaf = json!({"extensions": {"KHR_materials_diffuse_transmission":
        {"diffuseTransmissionFactor": 0.25, "diffuseTransmissionColorFactor": [0.5, 0.5, 0.5]}}});
    for (what, half_turn, expected) in
        [("lit from the front", false, 0.75 * 0.8), ("lit from behind", true, 0.25 * 0.5)]
    {
        let mut file = Gltf::new();
        let mesh = file.square(with(matte([0.8; 3]), leaf.clone()), json!({}));
        file.node(json!({"mesh": mesh}));
        let turn = if half_turn { json!([0, 1, 0, 0]) } else { json!([0, 0, 0, 1]) };
        file.light(json!({"type": "directional", "intensity": PI}), json!({"rotation": turn}));
        mean(what, &file.load(), 4, expected);
    }
}

/// A clear coat follows its own map of normals, and not that of what it covers.
#[test]
fn clear_coats_have_normals_of_their_own() {
    let tilted = [[204u8, 128, 230, 255]; 4]; // (0.6, 0, 0.8)
    let shine = |base_map: bool, coat_map: bool| {
        let mut file = textured(&tilted, json!({}));
        let map = json!({"index": 0});
        let coat = json!({"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.3});
        let mut material = with(matte([0.0; 3]), json!({"extensions": {"KHR_materials_clearcoat": coat}}));
        if base_map {
            merge(&mut material, json!({"normalTexture": map}));
        }
        if coat_map {
            merge(&mut material, json!({"extensions": {"KHR_materials_clearcoat": {"clearcoatNormalTexture": map}}}));
        }
        file.json["materials"][0] = material;
        // From where a mirror with that normal sends its light to the camera: 2 atan(3/4) off the axis, towards x.
        let (sin, cos) = 0.75f64.atan().sin_cos();
        file.json["nodes"].as_array_mut().unwrap().last_mut().unwrap()["rotation"] = json!([0, sin, 0, cos]);
        average(&film(&file.load(), "path", 16))[0].mean
    };
    let (plain, base, coat) = (shine(false, false), shine(true, false), shine(false, true));
    assert!((plain / base - 1.0).abs() < 1e-3, "{plain} {base}");
    assert!(coat > 50.0 * plain, "{coat} {plain}");
}

/// Two textures of a material by two sets of texture coordinates, for paths that meet a light and for those that sample it.
#[test]
fn materials_have_two_sets_of_texture_coordinates() {
    let mut file = textured(&FOUR, json!({}));
    // The second set turns the image by half a turn.
    let turned: Vec<f32> = SQUARE_UVS.iter().map(|value| 1.0 - value).collect();
    let turned = file.accessor(&floats(&turned), F32, "VEC2", 4, json!({}));
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(turned);
    let emission = json!({"emissiveFactor": [0.5, 0.5, 0.5], "emissiveTexture": {"index": 0, "texCoord": 1}});
    merge(&mut file.json["materials"][0], emission);
    let scene = file.load();
    let seen = film(&scene, "path", 256);
    for (quarter, (x, y)) in [(0, 0), (8, 0), (0, 8), (8, 8)].into_iter().enumerate() {
        let found = tile_average(&seen, x..x + 8, y..y + 8);
        for (channel, found) in found.into_iter().enumerate() {
            let expected = FOUR_LINEAR[quarter][channel] + 0.5 * FOUR_LINEAR[3 - quarter][channel];
            let what = format!("quarter {quarter}, channel {channel}");
            if expected == 0.0 {
                assert_eq!(found.mean, 0.0, "{what}");
            } else {
                assert_mean(&what, found, expected);
            }
        }
    }
    // As a lamp before a wall: next-event estimation sees the image that paths run into.
    file.json["materials"][0]["doubleSided"] = json!(true);
    file.json["nodes"][1]["translation"] = json!([0, 0, 5.5]);
    file.json["scenes"][0]["nodes"] = json!([0, 1]);
    let wall = file.square(matte([0.8; 3]), json!({}));
    file.node(json!({"mesh": wall, "translation": [0, 0, 4]}));
    let scene = file.load();
    let (path, implicit) = (film(&scene, "path", 64), film(&scene, "path-implicit", 1024));
    assert_same_mean("light by the second set", &path, &implicit, 8);
}

/// What textures say of the later optics.
#[test]
fn textures_change_the_later_optics() {
    let texel = |texel: [u8; 4]| {
        let mut file = textured(&[texel; 4], json!({}));
        file.json["scenes"][0]["nodes"] = json!([0, 1]);
        file
    };
    let shine = |file: &mut Gltf, material: Value, turn: Value| {
        file.json["materials"][0] = material;
        file.light(json!({"type": "directional", "intensity": 1}), json!({"rotation": turn}));
        average(&film(&file.load(), "path", 4))[0].mean
    };
    // A direction of (0, 1) in the texture is a rotation by a quarter; blue halves the strength.
    let (sin, cos) = 0.3f64.sin_cos();
    let metal = |strength: f64, rotation: f64, more: Value| {
        let anisotropy = with(json!({"anisotropyStrength": strength, "anisotropyRotation": rotation}), more);
        json!({"pbrMetallicRoughness": {"roughnessFactor": 0.5}, "extensions": {"KHR_materials_anisotropy": anisotropy}})
    };
    for turn in [json!([0, sin, 0, cos]), json!([-sin, 0, 0, cos])] {
        let textured = metal(0.8, 0.0, json!({"anisotropyTexture": {"index": 0}}));
        let found = shine(&mut texel([128, 255, 128, 255]), textured, turn.clone());
        let expected = shine(&mut texel([0; 4]), metal(0.8 * 128.0 / 255.0, 0.5 * PI, json!({})), turn);
        assert!((found / expected - 1.0).abs() < 2e-2, "{found} {expected}");
    }
    // Half of the share, of another colour; half way between two thicknesses.
    let behind = json!([0, 1, 0, 0]);
    let leaf = json!({"extensions": {"KHR_materials_diffuse_transmission":
        {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": {"index": 0}, "diffuseTransmissionColorTexture": {"index": 0}}}});
    let found = shine(&mut texel([255, 0, 0, 128]), with(matte([0.8; 3]), leaf), behind);
    assert!((found * PI / (0.5 * 128.0 / 255.0) - 1.0).abs() < 1e-3, "{found}");
    let film_of = |more: Value| {
        let film = with(
            json!({"iridescenceFactor": 1, "iridescenceThicknessMinimum": 200, "iridescenceThicknessMaximum": 300}),
            more,
        );
        json!({"pbrMetallicRoughness": {"roughnessFactor": 0.3, "baseColorFactor": [0.5, 0.5, 0.5, 1]}, "extensions": {"KHR_materials_iridescence": film}})
    };
    let straight = json!([0, 0, 0, 1]);
    let textured = film_of(json!({"iridescenceThicknessTexture": {"index": 0}}));
    let found = shine(&mut texel([255, 128, 0, 255]), textured, straight.clone());
    let thickness = 200.0 + 100.0 * 128.0 / 255.0;
    let expected = shine(&mut texel([0; 4]), film_of(json!({"iridescenceThicknessMaximum": thickness})), straight);
    assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
}
