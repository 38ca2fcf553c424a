//! What glTF files mean: each test states the picture that a small file must give.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use common::gltf::{F32, Gltf, I8, SQUARE, SQUARE_UVS, U8, U16, U32, floats, load, merge, png, shorts};
use common::{assert_mean, backends, render, settings, tile_average, with_gpu};
use lumbre::film::Film;
use lumbre::metrics::stats::Estimate;
use lumbre::scene::Scene;
use serde_json::{Value, json};

/// A material that is Lambertian: no metal, and the dielectric's reflection switched off.
fn matte(base: [f64; 3]) -> Value {
    json!({
        "pbrMetallicRoughness": {"baseColorFactor": [base[0], base[1], base[2], 1], "metallicFactor": 0},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0}}
    })
}

/// With more properties.
fn with(mut value: Value, more: Value) -> Value {
    merge(&mut value, more);
    value
}

/// Parallel light along -z of this many lux.
fn sun(file: &mut Gltf, lux: f64) {
    file.light(json!({"type": "directional", "intensity": lux}), json!({}));
}

/// An emitting square behind z = 0 that fills the picture.
fn backdrop(file: &mut Gltf, radiance: [f64; 3]) {
    let material = with(matte([0.0; 3]), json!({"emissiveFactor": radiance}));
    let mesh = file.square(material, json!({}));
    file.node(json!({"mesh": mesh, "translation": [0, 0, -2], "scale": [9, 9, 1]}));
}

fn film(scene: &Scene, spp: u32) -> Film {
    with_gpu(|gpu| render(gpu, scene, &settings(scene, "path", backends(gpu)[0]), spp))
}

/// The means of the four quarters of a picture: upper left, upper right, lower left, lower right.
fn quarters(film: &Film) -> [[Estimate; 3]; 4] {
    let (w, h) = (film.width, film.height);
    [(0, 0), (1, 0), (0, 1), (1, 1)]
        .map(|(x, y)| tile_average(film, x * w / 2..(x + 1) * w / 2, y * h / 2..(y + 1) * h / 2))
}

/// Compares the whole picture with one colour.
fn expect(what: &str, scene: &Scene, spp: u32, expected: [f64; 3]) {
    let film = film(scene, spp);
    for (channel, (measured, expected)) in common::average(&film).into_iter().zip(expected).enumerate() {
        compare(&format!("{what}, channel {channel}"), measured, expected);
    }
}

/// Like [`assert_mean`]; where nothing is expected, nothing must be there.
fn compare(what: &str, measured: Estimate, expected: f64) {
    if expected == 0.0 {
        assert_eq!(measured.mean, 0.0, "{what}");
    } else {
        assert_mean(what, measured, expected);
    }
}

#[test]
fn lux_on_a_known_base_colour() {
    // Light at 60 degrees: irradiance is half of what it is on a facing surface, radiance albedo / pi of that.
    let mut file = Gltf::new();
    let mesh = file.square(matte([0.8, 0.4, 0.2]), json!({}));
    file.node(json!({"mesh": mesh}));
    let half = (PI / 6.0).sin_cos(); // of 60 degrees around y
    file.light(
        json!({"type": "directional", "color": [1, 0.5, 0.25], "intensity": 3}),
        json!({"rotation": [0, half.0, 0, half.1]}),
    );
    let scene = file.load();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let irradiance = [3.0, 1.5, 0.75].map(|lux| lux * 0.5);
    expect("lux", &scene, 4, [0.8 * irradiance[0] / PI, 0.4 * irradiance[1] / PI, 0.2 * irradiance[2] / PI]);
}

#[test]
fn candela_at_one_metre_and_the_spot_of_gltf() {
    // The camera sees a hundredth of the square, where the light is at one metre and falls at right angles.
    let lit = |light: Value| {
        let mut file = Gltf::new();
        file.json["cameras"][0]["orthographic"]["xmag"] = json!(0.01);
        file.json["cameras"][0]["orthographic"]["ymag"] = json!(0.01);
        let mesh = file.square(matte([0.5; 3]), json!({}));
        file.node(json!({"mesh": mesh}));
        let tilt = light["tilt"].as_f64().unwrap_or(0.0);
        file.light(
            light,
            json!({"translation": [0, 0, 1], "rotation": [(tilt / 2.0).sin(), 0, 0, (tilt / 2.0).cos()]}),
        );
        file.load()
    };
    expect("candela", &lit(json!({"type": "point", "intensity": 7})), 4, [0.5 * 7.0 / PI; 3]);
    // Off the axis by an angle between the cones: ((cos a - cos outer) / (cos inner - cos outer))^2.
    let (inner, outer, angle) = (0.2f64, 0.6f64, 0.5f64);
    let cone = json!({"innerConeAngle": inner, "outerConeAngle": outer});
    let spot = |tilt: f64| lit(json!({"type": "spot", "intensity": 7, "spot": cone, "tilt": tilt}));
    let falloff = ((angle.cos() - outer.cos()) / (inner.cos() - outer.cos())).powi(2);
    expect("spot", &spot(angle), 16, [0.5 * 7.0 / PI * falloff; 3]);
    expect("inside the inner cone", &spot(0.15), 4, [0.5 * 7.0 / PI; 3]);
    expect("outside the outer cone", &spot(0.65), 4, [0.0; 3]);
    let ranged = lit(json!({"type": "point", "intensity": 7, "range": 0.1}));
    assert!(ranged.warnings.iter().any(|warning| warning.contains("range")), "{:?}", ranged.warnings);
}

#[test]
fn metal_shows_an_emitter_in_its_colour() {
    // A mirror turned by 45 degrees around y sends the view along +x, where a square of radiance 2 faces it. Schlick's
    // reflectance at 45 degrees is c + (1 - c) (1 - cos 45)^5.
    let mut file = Gltf::new();
    let colour = [0.9, 0.6, 0.3];
    let metal = json!({"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 1], "roughnessFactor": 0}});
    let mirror = file.square(metal, json!({}));
    let (sin, cos) = (PI / 8.0).sin_cos();
    file.node(json!({"mesh": mirror, "rotation": [0, sin, 0, cos], "scale": [2, 2, 1]}));
    let light = json!({
        "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}
    });
    let light = file.square(light, json!({}));
    file.node(json!({"mesh": light, "translation": [4, 0, 0], "rotation": [0, -FRAC_1_SQRT_2, 0, FRAC_1_SQRT_2], "scale": [9, 9, 1]}));
    let weight = (1.0 - FRAC_1_SQRT_2).powi(5);
    expect("metal", &file.load(), 64, colour.map(|c| 2.0 * (c + (1.0 - c) * weight)));
}

#[test]
fn glass_absorbs_by_beer_and_lambert() {
    // A slab of thickness d = 0.25 before a backdrop of radiance 1: T^2 A / (1 - R^2 A^2) comes through, all the ways
    // inside counted, where R = ((1.5 - 1) / (1.5 + 1))^2 = 0.04, T = 1 - R, and A = c^(d / distance) = c^(1/2).
    let mut file = Gltf::new();
    let glass = json!({
        "pbrMetallicRoughness": {"roughnessFactor": 0, "metallicFactor": 0},
        "extensions": {
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_ior": {"ior": 1.5},
            "KHR_materials_volume":
                {"thicknessFactor": 1, "attenuationDistance": 0.5, "attenuationColor": [0.81, 0.25, 1]}
        }
    });
    let mesh = file.square(glass, json!({}));
    file.node(json!({"mesh": mesh, "scale": [40, 40, 1]}));
    file.node(json!({"mesh": mesh, "translation": [0, 0, -0.25], "rotation": [0, 1, 0, 0], "scale": [40, 40, 1]}));
    backdrop(&mut file, [1.0; 3]);
    let r = 0.04f64;
    let through = [0.9, 0.5, 1.0].map(|a: f64| (1.0 - r).powi(2) * a / (1.0 - r * r * a * a));
    expect("slab", &file.load(), 1024, through);
    // A thin wall of the same material neither refracts nor absorbs: one factor T.
    file.json["materials"][0]["extensions"]["KHR_materials_volume"]["thicknessFactor"] = json!(0);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    expect("thin wall", &file.load(), 1024, [1.0 - r; 3]);
}

/// Red, green, blue and grey, from the upper left to the lower right; sRGB bytes, one of them not at the end of the range.
const FOUR: [[u8; 4]; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [188, 188, 188, 255]];
/// The same in linear values: ((188/255 + 0.055) / 1.055)^2.4 = 0.50289.
const FOUR_LINEAR: [[f64; 3]; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.502_886; 3]];

/// The square with that texture lit so that its radiance is its albedo; `info` adds to the texture's info.
fn textured(texels: &[[u8; 4]], info: Value) -> Gltf {
    let mut file = Gltf::new();
    let texture = file.texture(&png(2, 2, texels));
    let base = json!({"pbrMetallicRoughness": {"baseColorTexture": with(json!({"index": texture}), info)}});
    let mesh = file.square(with(matte([1.0; 3]), base), json!({}));
    file.node(json!({"mesh": mesh}));
    sun(&mut file, PI);
    file
}

fn expect_quarters(what: &str, scene: &Scene, order: [usize; 4]) {
    for (quarter, texel) in quarters(&film(scene, 4)).into_iter().zip(order) {
        for (channel, measured) in quarter.into_iter().enumerate() {
            compare(&format!("{what}, texel {texel}, channel {channel}"), measured, FOUR_LINEAR[texel][channel]);
        }
    }
}

#[test]
fn textures_are_upright_and_srgb_is_decoded() {
    expect_quarters("texture", &textured(&FOUR, json!({})).load(), [0, 1, 2, 3]);
}

#[test]
fn texture_transforms_scale_then_rotate_then_move() {
    let transform = |value: Value| textured(&FOUR, json!({"extensions": {"KHR_texture_transform": value}})).load();
    // u + 1/2: the columns change places.
    expect_quarters("offset", &transform(json!({"offset": [0.5, 0]})), [1, 0, 3, 2]);
    // (u, v) -> (v, -u): the upper left quarter, around (1/4, 1/4), sees (1/4, 3/4), the lower left texel; the upper right
    // one, around (3/4, 1/4), sees (1/4, 1/4).
    expect_quarters("rotation", &transform(json!({"rotation": PI / 2.0})), [2, 0, 3, 1]);
    // All three: (u, v) -> (u/2, v) -> (v, -u/2) -> (v + 1/2, 1/4 - u/2). The quarters' centres see (3/4, 1/8),
    // (3/4, -1/8) = (3/4, 7/8), (1/4, 1/8) and (1/4, 7/8).
    let all = json!({"scale": [0.5, 1], "rotation": PI / 2.0, "offset": [0.5, 0.25]});
    expect_quarters("all", &transform(all), [1, 3, 0, 2]);
    // The extension may name another set of coordinates: here the same ones, u and v exchanged.
    let mut file = textured(&FOUR, json!({"extensions": {"KHR_texture_transform": {"texCoord": 1}}}));
    let swapped: Vec<f32> = SQUARE_UVS.chunks(2).flat_map(|uv| [uv[1], uv[0]]).collect();
    let swapped = file.accessor(&floats(&swapped), F32, "VEC2", 4, json!({}));
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(swapped);
    expect_quarters("second set", &file.load(), [0, 2, 1, 3]);
}

#[test]
fn alpha_masks_and_blends() {
    // Alphas 0.2, 0.4, 0.6 and 1 before a backdrop of radiance 1: black where they stop light.
    let texels = [51, 102, 153, 255].map(|alpha| [0, 0, 0, alpha]);
    let show = |mode: Value| {
        let mut file = textured(&texels, json!({}));
        merge(&mut file.json["materials"][0], mode);
        backdrop(&mut file, [1.0; 3]);
        quarters(&film(&file.load(), 1024)).map(|quarter| quarter[0])
    };
    for (what, mode, expected) in [
        ("opaque", json!({}), [0.0; 4]),
        ("mask", json!({"alphaMode": "MASK"}), [1.0, 1.0, 0.0, 0.0]),
        ("mask at 0.3", json!({"alphaMode": "MASK", "alphaCutoff": 0.3}), [1.0, 0.0, 0.0, 0.0]),
        ("blend", json!({"alphaMode": "BLEND"}), [0.8, 0.6, 0.4, 0.0]),
        (
            "blend with a factor of 1/2",
            json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}),
            [0.9, 0.8, 0.7, 0.5],
        ),
        (
            "mask with a factor of 1/2",
            json!({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}),
            [1.0, 1.0, 1.0, 0.0],
        ),
    ] {
        for (quarter, (measured, expected)) in show(mode).into_iter().zip(expected).enumerate() {
            compare(&format!("{what}, quarter {quarter}"), measured, expected);
        }
    }
    // Without a texture the factor alone decides.
    let plain = |mode: &str, alpha: f64| {
        let mut file = Gltf::new();
        let alpha = json!({"alphaMode": mode, "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, alpha]}});
        let mesh = file.square(with(matte([0.0; 3]), alpha), json!({}));
        file.node(json!({"mesh": mesh}));
        backdrop(&mut file, [1.0; 3]);
        file.load()
    };
    expect("plain blend", &plain("BLEND", 0.25), 1024, [0.75; 3]);
    expect("plain mask below", &plain("MASK", 0.25), 4, [1.0; 3]);
    expect("plain mask above", &plain("MASK", 0.75), 4, [0.0; 3]);
}

/// The square as one triangle mesh with all attributes, by the given accessors.
fn attributes(file: &mut Gltf, positions: usize, normals: usize, uvs: usize, indices: usize) -> Scene {
    let texture = file.texture(&png(2, 2, &FOUR));
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}});
    let material = file.add("materials", material);
    let attributes = json!({"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs});
    let mesh = file
        .add("meshes", json!({"primitives": [{"attributes": attributes, "indices": indices, "material": material}]}));
    file.node(json!({"mesh": mesh}));
    file.load()
}

/// What a scene holds of its geometry.
fn geometry(scene: &Scene) -> String {
    format!("{:?} {:?} {:?} {:?}", scene.primitives, scene.corners, scene.normals, scene.uvs)
}

#[test]
fn all_ways_to_store_numbers_give_the_same_mesh() {
    let normals: Vec<f32> = [0.0, 0.0, 1.0].repeat(4);
    let plain = {
        let mut file = Gltf::new();
        let positions = file.accessor(&floats(&SQUARE), F32, "VEC3", 4, json!({}));
        let normals = file.accessor(&floats(&normals), F32, "VEC3", 4, json!({}));
        let uvs = file.accessor(&floats(&SQUARE_UVS), F32, "VEC2", 4, json!({}));
        let indices = file.accessor(&shorts(&[0, 1, 2, 0, 2, 3]), U16, "SCALAR", 6, json!({}));
        geometry(&attributes(&mut file, positions, normals, uvs, indices))
    };
    // Interleaved with 4 bytes between, from an offset.
    let mut file = Gltf::new();
    let mut bytes = vec![0xee; 4];
    for vertex in 0..4 {
        bytes.extend(floats(&SQUARE[3 * vertex..3 * vertex + 3]));
        bytes.extend(floats(&normals[3 * vertex..3 * vertex + 3]));
        bytes.extend(floats(&SQUARE_UVS[2 * vertex..2 * vertex + 2]));
        bytes.extend([0xee; 4]);
    }
    let view = file.view(&bytes[..bytes.len() - 4], json!({"byteStride": 36}));
    let mut part = |offset: usize, kind: &str| {
        file.add(
            "accessors",
            json!({"bufferView": view, "byteOffset": offset, "componentType": F32, "type": kind, "count": 4}),
        )
    };
    let (positions, normal, uvs) = (part(4, "VEC3"), part(16, "VEC3"), part(28, "VEC2"));
    let indices = [0u32, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()).collect::<Vec<u8>>();
    let indices = file.accessor(&indices, U32, "SCALAR", 6, json!({}));
    assert_eq!(geometry(&attributes(&mut file, positions, normal, uvs, indices)), plain, "interleaved");
    // Sparse: two positions replaced, and normals of zeros that are all replaced.
    let mut file = Gltf::new();
    let mut wrong = SQUARE;
    (wrong[0], wrong[7]) = (9.0, -9.0);
    let right: Vec<f32> = [&SQUARE[0..3], &SQUARE[6..9]].concat();
    let (at, values) = (file.view(&[0, 2], json!({})), file.view(&floats(&right), json!({})));
    let sparse = json!({"sparse": {
        "count": 2, "indices": {"bufferView": at, "componentType": U8}, "values": {"bufferView": values}
    }});
    let positions = file.accessor(&floats(&wrong), F32, "VEC3", 4, sparse);
    let (at, values) = (file.view(&shorts(&[0, 1, 2, 3]), json!({})), file.view(&floats(&normals), json!({})));
    let sparse = json!({"componentType": F32, "type": "VEC3", "count": 4, "sparse": {
        "count": 4, "indices": {"bufferView": at, "componentType": U16}, "values": {"bufferView": values}
    }});
    let normal = file.add("accessors", sparse);
    let uvs = file.accessor(&floats(&SQUARE_UVS), F32, "VEC2", 4, json!({}));
    let indices = file.accessor(&[0, 1, 2, 0, 2, 3], U8, "SCALAR", 6, json!({}));
    assert_eq!(geometry(&attributes(&mut file, positions, normal, uvs, indices)), plain, "sparse");
    // Quantised: positions in bytes and in normalised shorts, normals in normalised bytes, texture coordinates in shorts.
    for (component, normalised) in [(I8, false), (I8, true), (common::gltf::I16, true)] {
        let mut file = Gltf::new();
        file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
        let one = if normalised { 127 } else { 1 };
        let integers: Vec<i8> = SQUARE.iter().map(|value| *value as i8 * one).collect();
        let shorts_of: Vec<u8> = SQUARE.iter().flat_map(|value| (*value as i16 * 32767).to_le_bytes()).collect();
        let bytes: Vec<u8> = if component == I8 {
            integers.chunks(3).flat_map(|c| [c[0] as u8, c[1] as u8, c[2] as u8, 0]).collect()
        } else {
            shorts_of.chunks(6).flat_map(|c| [c, &[0, 0]].concat()).collect()
        };
        let view = file.view(&bytes, json!({"byteStride": bytes.len() / 4}));
        let more = json!({"bufferView": view, "componentType": component, "type": "VEC3", "count": 4, "normalized": normalised});
        let positions = file.add("accessors", more);
        let view = file.view(&[0, 0, 127, 0].repeat(4), json!({"byteStride": 4}));
        let normal = json!({"bufferView": view, "componentType": I8, "type": "VEC3", "count": 4, "normalized": true});
        let normal = file.add("accessors", normal);
        let uvs: Vec<u16> = SQUARE_UVS.iter().map(|value| *value as u16 * 65535).collect();
        let uvs = file.accessor(&shorts(&uvs), U16, "VEC2", 4, json!({"normalized": true}));
        let indices = file.accessor(&[0, 1, 2, 0, 2, 3], U8, "SCALAR", 6, json!({}));
        let found = geometry(&attributes(&mut file, positions, normal, uvs, indices));
        assert_eq!(found, plain, "component type {component}");
    }
}

#[test]
fn strips_and_fans_are_triangles() {
    let corners = |mode: u32, indices: &[u16]| {
        let mut file = Gltf::new();
        let indices = file.accessor(&shorts(indices), U16, "SCALAR", indices.len(), json!({}));
        let mesh = file.square(matte([0.5; 3]), json!({"mode": mode, "indices": indices}));
        file.node(json!({"mesh": mesh}));
        let scene = file.load();
        // All of it must face +z.
        for primitive in &scene.primitives {
            let [a, b, c] = [primitive.v0, primitive.v1, primitive.v2].map(glam::Vec3::from);
            assert!((b - a).cross(c - a).z > 0.0, "{primitive:?}");
        }
        (scene.primitives.len(), scene.warnings)
    };
    assert_eq!(corners(4, &[0, 1, 2, 0, 2, 3, 0]).0, 2);
    assert_eq!(corners(5, &[0, 1, 3, 2]).0, 2);
    assert_eq!(corners(6, &[0, 1, 2, 3]).0, 2);
    assert!(corners(0, &[0, 1, 2, 3]).1.iter().any(|warning| warning.contains("points and lines")));
}

#[test]
fn binary_files_equal_text_files() {
    let file = textured(&FOUR, json!({}));
    let (text, binary) = (file.try_load(&[]).unwrap(), load(&file.glb(), "scene.glb", &[]).unwrap());
    assert_eq!(geometry(&text), geometry(&binary));
    assert_eq!(format!("{:?}", text.materials), format!("{:?}", binary.materials));
    assert_eq!(text.images[0].bytes(), binary.images[0].bytes());
    // Buffer and image beside the file, under names with a space.
    let mut apart = file.clone();
    apart.json["buffers"] = json!([{"byteLength": file.bytes.len(), "uri": "a%20b.bin"}]);
    let image = png(2, 2, &FOUR);
    apart.json["images"] = json!([{"uri": "c%20d.png"}]);
    let apart = apart.try_load(&[("a b.bin", &file.bytes), ("c d.png", &image)]).unwrap();
    assert_eq!(geometry(&text), geometry(&apart));
    assert_eq!(text.images[0].bytes(), apart.images[0].bytes());
}

#[test]
fn nodes_stand_where_their_parents_put_them() {
    // Scaled by 2, turned by a quarter around z, moved by (1, 2, 3); above it a matrix that moves by (10, 0, 0) and mirrors
    // y: the corner (1, 1, 0) goes to (2, 2, 0), (-2, 2, 0), (-1, 4, 3), and (9, -4, 3).
    let mut file = Gltf::new();
    let mesh = file.square(matte([0.5; 3]), json!({}));
    let below = json!({"mesh": mesh, "scale": [2, 2, 2], "rotation": [0, 0, FRAC_1_SQRT_2, FRAC_1_SQRT_2], "translation": [1, 2, 3]});
    let child = file.add("nodes", below);
    file.node(json!({"children": [child], "matrix": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1]}));
    sun(&mut file, 1.0);
    let scene = file.load();
    let origin = scene.origin.as_vec3();
    let corners = || scene.primitives.iter().flat_map(|p| [p.v0, p.v1, p.v2]).map(|v| glam::Vec3::from(v) + origin);
    assert!(corners().any(|corner| (corner - glam::Vec3::new(9.0, -4.0, 3.0)).length() < 1e-5), "{:?}", scene.bounds);
    // The mirror turned the corners round; the front still faces +z.
    for p in &scene.primitives {
        let [a, b, c] = [p.v0, p.v1, p.v2].map(glam::Vec3::from);
        assert!((b - a).cross(c - a).z > 0.0);
    }
    // A mesh that two nodes use is stored once, and both see it.
    let mut file = Gltf::new();
    let mesh = file.square(matte([0.5; 3]), json!({}));
    file.node(json!({"mesh": mesh, "translation": [-0.5, 0, 0], "scale": [0.5, 1, 1]}));
    file.node(json!({"mesh": mesh, "translation": [0.5, 0, 0], "scale": [-0.5, 1, 1]}));
    sun(&mut file, PI);
    let scene = file.load();
    assert_eq!((scene.primitives.len(), scene.instances.len()), (2, 2));
    expect("instances", &scene, 4, [0.5; 3]);
    // One that emits is put into the world twice, for each light must have a place of its own.
    let mut file = Gltf::new();
    let mesh = file.square(json!({"emissiveFactor": [1, 0.5, 0.25]}), json!({}));
    file.node(json!({"mesh": mesh, "translation": [-0.5, 0, 0], "scale": [0.5, 1, 1]}));
    file.node(json!({"mesh": mesh, "translation": [0.5, 0, 0], "scale": [-0.5, 1, 1]}));
    let scene = file.load();
    assert_eq!((scene.primitives.len(), scene.lights.len(), scene.instances.len()), (4, 4, 1));
    expect("emitters", &scene, 4, [1.0, 0.5, 0.25]);
}

#[test]
fn vertex_colours_multiply_the_base_colour() {
    // The colours of left and right are 0 and 1 in red, 1 and 0 in green: linear between, so both have a mean of 1/2.
    let mut file = Gltf::new();
    let colours = [[0u8, 255, 102, 255], [255, 0, 102, 255], [255, 0, 102, 255], [0, 255, 102, 255]];
    let colours = file.accessor(&colours.concat(), U8, "VEC4", 4, json!({"normalized": true}));
    let mesh = file.square(matte([0.8, 0.4, 1.0]), json!({"attributes": {"COLOR_0": colours}}));
    file.node(json!({"mesh": mesh}));
    sun(&mut file, PI);
    let scene = file.load();
    expect("vertex colours", &scene, 64, [0.4, 0.2, 0.4]);
    let film = film(&scene, 64);
    let left = tile_average(&film, 0..8, 0..16);
    compare("the left half", left[0], 0.8 * 0.25);
}

#[test]
fn normal_maps_tilt_the_normal() {
    // The map says n = (sin 30, 0, cos 30) or (0, sin 30, cos 30), +y up in the image; light comes at 60 degrees from +x,
    // -x, +y or -y. The expected cosine is that between them, 30 or 90 + 30 degrees (dark).
    let byte = |value: f64| ((value * 0.5 + 0.5) * 255.0).round();
    let vector = |bytes: [f64; 3]| glam::DVec3::from(bytes.map(|b| b / 255.0 * 2.0 - 1.0)).normalize();
    for (axis, texel) in [(0, [0.5, 0.0, 0.75f64.sqrt()]), (1, [0.0, 0.5, 0.75f64.sqrt()])] {
        let bytes = texel.map(byte);
        let normal = vector(bytes);
        for (sign, given_tangents) in [(1.0, false), (-1.0, false), (1.0, true)] {
            let mut file = Gltf::new();
            let texel = [bytes[0] as u8, bytes[1] as u8, bytes[2] as u8, 255];
            let texture = file.texture(&png(2, 2, &[texel; 4]));
            let normals: Vec<f32> = [0.0, 0.0, 1.0].repeat(4);
            let normals = file.accessor(&floats(&normals), F32, "VEC3", 4, json!({}));
            let tangents: Vec<f32> = [1.0, 0.0, 0.0, 1.0].repeat(4);
            let tangents = file.accessor(&floats(&tangents), F32, "VEC4", 4, json!({}));
            let mut more = json!({"attributes": {"NORMAL": normals}});
            if given_tangents {
                merge(&mut more, json!({"attributes": {"TANGENT": tangents}}));
            }
            let material = with(matte([0.5; 3]), json!({"normalTexture": {"index": texture}}));
            let mesh = file.square(material, more);
            file.node(json!({"mesh": mesh}));
            // A light that travels along -z, turned so that it comes from 60 degrees off.
            let (sin, cos) = (PI / 6.0).sin_cos();
            let rotation = if axis == 0 { [0.0, sign * sin, 0.0, cos] } else { [-sign * sin, 0.0, 0.0, cos] };
            file.light(json!({"type": "directional", "intensity": 1}), json!({"rotation": rotation}));
            let mut light = glam::DVec3::new(0.0, 0.0, 0.5);
            light[axis] = sign * 0.75f64.sqrt();
            let cosine = light.dot(normal).max(0.0);
            assert!(if sign > 0.0 { (cosine - 0.866).abs() < 0.01 } else { cosine < 0.01 }, "{cosine}");
            let scene = file.load();
            let expected = if sign > 0.0 { 0.5 / PI * cosine } else { 0.0 };
            expect(&format!("normal map, axis {axis}, from {sign}, given: {given_tangents}"), &scene, 4, [expected; 3]);
        }
    }
}

#[test]
fn mirrored_normal_maps_keep_their_handedness() {
    // The same map on a square that its node mirrors in x: its tangent points along -x, so the tilt goes to -x and light
    // from +x is at 90 degrees; alone, used twice, and with tangents of the file or computed.
    for (twice, given) in [(false, false), (true, false), (false, true), (true, true)] {
        let mut file = Gltf::new();
        // Tilted up and to the right: (0.5, 0.5, sqrt(0.5)).
        let texture = file.texture(&png(2, 2, &[[191, 191, 218, 255]; 4]));
        let normals: Vec<f32> = [0.0, 0.0, 1.0].repeat(4);
        let normals = file.accessor(&floats(&normals), F32, "VEC3", 4, json!({}));
        let tangents: Vec<f32> = [1.0, 0.0, 0.0, 1.0].repeat(4);
        let tangents = file.accessor(&floats(&tangents), F32, "VEC4", 4, json!({}));
        let more = match given {
            true => json!({"attributes": {"NORMAL": normals, "TANGENT": tangents}}),
            false => json!({"attributes": {"NORMAL": normals}}),
        };
        let mesh = file.square(with(matte([0.5; 3]), json!({"normalTexture": {"index": texture}})), more);
        file.node(json!({"mesh": mesh, "scale": [-1, 1, 1]}));
        if twice {
            file.node(json!({"mesh": mesh, "translation": [50, 0, 0]}));
        }
        sun(&mut file, 1.0);
        file.light(
            json!({"type": "directional", "intensity": 1}),
            json!({"rotation": [-FRAC_1_SQRT_2, 0, 0, FRAC_1_SQRT_2]}),
        );
        // From +z and from +y: n_z + n_y, neither changed by the mirror.
        let n = glam::DVec3::new(191.0, 191.0, 218.0) / 127.5 - 1.0;
        let n = n.normalize();
        // Light from +y alone grazes the square: it is below none of the two frames' horizons but the surface's own, so
        // it is tilted towards it by the map and counts by the shading normal only where the surface faces it.
        let _ = n;
        let scene = file.load();
        let up = common::average(&film(&scene, 4))[0].mean * PI / 0.5;
        assert!((up - n.z).abs() < 0.01 || (up - n.z - n.y).abs() < 0.01, "{up} against {} or {}", n.z, n.z + n.y);
    }
}
