//! What glTF files mean: each test states the picture that a small file must give.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

use crate::common::gltf::{
    F32, FOUR, FOUR_LINEAR, Gltf, I8, I16, SQUARE, SQUARE_UVS, U8, U16, U32, floats, load, matte, merge, png, shorts,
    sun, textured, with,
};
use crate::common::{assert_mean, backends, render, settings, tile_average, with_gpu};
use lumbre::layout::{
    PROPERTY_CLEARCOAT, PROPERTY_CLEARCOAT_ROUGHNESS, PROPERTY_METALLIC, PROPERTY_ROUGHNESS, PROPERTY_SPECULAR,
    PROPERTY_TRANSMISSION, SECOND_UVS_BIT,
};
use lumbre::render::film::Film;
use lumbre::scene::Scene;
use lumbre::statistics::Estimate;
use serde_json::{Value, json};

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
    for (channel, (measured, expected)) in crate::common::average(&film).into_iter().zip(expected).enumerate() {
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
    // The camera sees a thousandth of the square, where the light is at one metre and falls at right angles.
    let lit = |light: Value| {
        let mut file = Gltf::new();
        file.json["cameras"][0]["orthographic"]["xmag"] = json!(0.001);
        file.json["cameras"][0]["orthographic"]["ymag"] = json!(0.001);
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
    let strength = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 2}});
    let light = with(matte([0.0; 3]), json!({"emissiveFactor": [1, 1, 1], "extensions": strength}));
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
    // From inside, 0.15 before the far face: A' = c^0.3 on the way there, one factor T, and radiance is eta^2 as large in glass.
    let camera = file.json["nodes"][0].clone();
    file.json["nodes"][0]["translation"] = json!([0, 0, -0.1]);
    let within = [0.81f64, 0.25, 1.0].map(|c| {
        let a = c.sqrt();
        1.5f64.powi(2) * c.powf(0.3) * (1.0 - r) / (1.0 - r * r * a * a)
    });
    expect("within the slab", &file.load(), 1024, within);
    file.json["nodes"][0] = camera;
    // A thin wall of the same material neither refracts nor absorbs: one factor T.
    file.json["materials"][0]["extensions"]["KHR_materials_volume"]["thicknessFactor"] = json!(0);
    file.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    expect("thin wall", &file.load(), 1024, [1.0 - r; 3]);
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
        quarters(&film(&file.load(), 8192)).map(|quarter| quarter[0])
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
    expect("plain blend", &plain("BLEND", 0.25), 4096, [0.75; 3]);
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
    for (component, normalised) in [(I8, false), (I8, true), (I16, true)] {
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
    // The map says n = (sin 30, 0, cos 30) or (0, sin 30, cos 30), +y up in the image; light comes at 60 degrees from +x or
    // +y, 30 degrees from the normal, or at 70 degrees from the other side, below its horizon.
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
            // A light that travels along -z, turned so that it comes from the side.
            let angle: f64 = if sign > 0.0 { PI / 3.0 } else { PI / 18.0 * 7.0 };
            let (sin, cos) = (angle / 2.0).sin_cos();
            let rotation = if axis == 0 { [0.0, sign * sin, 0.0, cos] } else { [-sign * sin, 0.0, 0.0, cos] };
            file.light(json!({"type": "directional", "intensity": 1}), json!({"rotation": rotation}));
            let mut light = glam::DVec3::new(0.0, 0.0, angle.cos());
            light[axis] = sign * angle.sin();
            let cosine = light.dot(normal).max(0.0);
            assert!(if sign > 0.0 { (cosine - 0.866).abs() < 0.01 } else { cosine == 0.0 }, "{cosine}");
            let what = format!("normal map, axis {axis}, from {sign}, given: {given_tangents}");
            expect(&what, &file.load(), 4, [0.5 / PI * cosine; 3]);
        }
    }
}

#[test]
fn mirrored_normal_maps_keep_their_handedness() {
    // A map tilted to the right and up, n = (a, b, c), on a square that its node mirrors in x: seen from outside it is
    // (-a, b, c). Light at 45 degrees from +x has the cosine (c - a) / sqrt 2, from +y (c + b) / sqrt 2.
    let n = (glam::DVec3::new(160.0, 191.0, 230.0) / 127.5 - 1.0).normalize();
    let normals: Vec<f32> = [0.0, 0.0, 1.0].repeat(4);
    let tangents: Vec<f32> = [1.0, 0.0, 0.0, 1.0].repeat(4);
    let (sin, cos) = (PI / 8.0).sin_cos();
    for (what, rotation, cosine) in [("+x", [0.0, sin, 0.0, cos], n.z - n.x), ("+y", [-sin, 0.0, 0.0, cos], n.z + n.y)]
    {
        for (twice, given) in [(false, false), (true, false), (false, true), (true, true)] {
            let mut file = Gltf::new();
            let texture = file.texture(&png(2, 2, &[[160, 191, 230, 255]; 4]));
            let normals = file.accessor(&floats(&normals), F32, "VEC3", 4, json!({}));
            let tangents = file.accessor(&floats(&tangents), F32, "VEC4", 4, json!({}));
            let more = match given {
                true => json!({"attributes": {"NORMAL": normals, "TANGENT": tangents}}),
                false => json!({"attributes": {"NORMAL": normals}}),
            };
            let material = with(matte([0.5; 3]), json!({"normalTexture": {"index": texture}}));
            let mesh = file.square(material, more);
            file.node(json!({"mesh": mesh, "scale": [-1, 1, 1]}));
            if twice {
                file.node(json!({"mesh": mesh, "translation": [50, 0, 0]}));
            }
            file.light(json!({"type": "directional", "intensity": 1}), json!({"rotation": rotation}));
            let what = format!("light from {what}, used twice: {twice}, tangents given: {given}");
            expect(&what, &file.load(), 4, [0.5 / PI * cosine * FRAC_1_SQRT_2; 3]);
        }
    }
}

#[test]
fn environments_come_from_extras() {
    // Eight columns: the image's left edge is -z, a quarter +x, its middle +z; a camera that looks along -z sees the first
    // and the last column. Turned by a quarter counter-clockwise, +x of the image, columns 1 and 2, comes to -z.
    let mut texels = vec![[0, 0, 0, 255]; 32];
    for row in 0..4 {
        for (column, value) in [(0, 255), (7, 255), (1, 188), (2, 188)] {
            texels[8 * row + column] = [value, value, value, 255];
        }
    }
    let sky = png(8, 4, &texels);
    let seen = |degrees: f64| {
        let mut file = Gltf::default();
        let view = json!({"yfov": 0.1, "aspectRatio": 2, "znear": 0.1});
        let camera = file.add("cameras", json!({"type": "perspective", "perspective": view}));
        file.node(json!({"camera": camera}));
        let environment = json!({"uri": "sky.png", "intensity": 3, "rotation_degrees": degrees});
        file.json["scenes"][0]["extras"] = json!({"lumbre": {"environment": environment}, "other": 1});
        let mut scene = file.try_load(&[("sky.png", &sky)]).unwrap();
        assert_eq!((scene.film.width, scene.film.height), (1024, 512), "by the camera's aspect ratio");
        (scene.film.width, scene.film.height) = (16, 8);
        scene
    };
    expect("as it is", &seen(0.0), 4, [3.0; 3]);
    expect("turned", &seen(90.0), 4, [3.0 * 0.502_886; 3]);
    let mut file = Gltf::default();
    file.json["scenes"][0]["extras"] = json!({"lumbre": {"environment": {"uri": "../sky.png"}}});
    let error = file.try_load(&[]).unwrap_err().to_string();
    assert!(error.contains("scenes[0].extras.lumbre.environment") && error.contains("leaves"), "{error}");
    file.json["scenes"][0]["extras"] = json!({"lumbre": {"enviroment": {}}});
    let error = file.try_load(&[]).unwrap_err().to_string();
    assert!(error.contains("enviroment") && error.contains("`environment`"), "{error}");
}

#[test]
fn perspective_cameras_see_by_their_vertical_angle() {
    // At distance 2 the camera sees 2 up and 4 to the right; an emitter from 2 to 4 on the right, and from 0 to 2 up, fills
    // the last quarter of the columns in the upper half of the rows.
    let mut file = Gltf::default();
    let view = json!({"yfov": PI / 2.0, "aspectRatio": 2, "znear": 0.1});
    let camera = file.add("cameras", json!({"type": "perspective", "perspective": view, "name": "wide"}));
    file.node(json!({"camera": camera, "translation": [3, 0, 0], "rotation": [0, FRAC_1_SQRT_2, 0, FRAC_1_SQRT_2]}));
    let mesh = file.square(with(matte([0.0; 3]), json!({"emissiveFactor": [1, 1, 1]})), json!({}));
    // The camera looks along -x: what is to its right is at -z.
    let turn = [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2];
    file.node(json!({"mesh": mesh, "translation": [1, 1, -3], "rotation": turn}));
    let mut scene = file.load();
    assert_eq!(scene.cameras[0].name, "wide");
    (scene.film.width, scene.film.height) = (16, 8);
    let film = film(&scene, 16);
    for (column, row, expected) in [(12, 0, 1.0), (8, 0, 0.0), (12, 4, 0.0), (0, 0, 0.0)] {
        let found = tile_average(&film, column..column + 4, row..row + 4)[0].mean;
        assert!((found - expected).abs() < 1e-6, "from ({column}, {row}): {found} against {expected}");
    }
}

#[test]
fn layers_reach_the_material() {
    let mut file = Gltf::new();
    let one = file.texture(&png(1, 1, &[[255, 255, 255, 128]]));
    let other = json!({"index": one, "texCoord": 1});
    let info = json!({"index": one});
    let material = json!({
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "metallicFactor": 0.25, "roughnessFactor": 0.5, "baseColorFactor": [0.1, 0.2, 0.3, 0.4],
            "metallicRoughnessTexture": info
        },
        "normalTexture": {"index": one, "scale": 0.5, "extensions": {"KHR_texture_transform": {"scale": [2, 3]}}},
        "occlusionTexture": other,
        "emissiveTexture": info,
        "emissiveFactor": [1, 2, 3],
        "extensions": {
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.6, "clearcoatRoughnessFactor": 0.7, "clearcoatTexture": other,
                "clearcoatRoughnessTexture": info
            },
            "KHR_materials_emissive_strength": {"emissiveStrength": 10},
            "KHR_materials_ior": {"ior": 1.25},
            "KHR_materials_sheen": {"sheenColorFactor": [0.1, 0.2, 0.3], "sheenRoughnessFactor": 0.8},
            "KHR_materials_specular": {"specularFactor": 0.9, "specularColorFactor": [1, 2, 3], "specularTexture": info},
            "KHR_materials_transmission": {"transmissionFactor": 0.45, "transmissionTexture": info},
            "KHR_materials_volume":
                {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 1, 0]},
            "KHR_materials_anisotropy": {"anisotropyStrength": 0.3, "anisotropyRotation": FRAC_PI_2},
            "KHR_materials_diffuse_transmission":
                {"diffuseTransmissionFactor": 0.2, "diffuseTransmissionColorFactor": [0.5, 1, 0]},
            "KHR_materials_dispersion": {"dispersion": 0.7},
            "KHR_materials_iridescence": {"iridescenceFactor": 0.9, "iridescenceIor": 1.7, "iridescenceThicknessMaximum": 250},
            "KHR_materials_unknown": {}
        }
    });
    let mesh = file.square(material, json!({}));
    file.node(json!({"mesh": mesh}));
    file.json["extensionsUsed"] = json!(["KHR_materials_unknown", "KHR_materials_ior"]);
    let scene = file.load();
    let (record, layers) = (scene.materials[0], scene.layereds[0]);
    assert_eq!((record.reflectance, record.alpha_u, record.eta), ([0.1, 0.2, 0.3], 0.5, 1.25));
    assert_eq!((layers.metallic, layers.specular, layers.specular_colour), (0.25, 0.9, [1.0, 2.0, 3.0]));
    assert_eq!((layers.clearcoat, layers.clearcoat_roughness), (0.6, 0.7));
    assert_eq!((layers.sheen_colour, layers.sheen_roughness), ([0.1, 0.2, 0.3], 0.8));
    assert_eq!((layers.transmission, layers.is_volume), (0.45, 1));
    let [along, across] = layers.anisotropy_direction;
    assert!(layers.anisotropy == 0.3 && along.abs() < 1e-6 && across == 1.0, "{layers:?}");
    assert_eq!((layers.iridescence, layers.iridescence_eta, layers.iridescence_thickness), (0.9, 1.7, 250.0));
    assert_eq!((layers.diffuse_transmission, layers.diffuse_transmission_colour), (0.2, [0.5, 1.0, 0.0]));
    assert_eq!(layers.dispersion, 0.7);
    // -ln(0.5) / 2, nothing, and as good as black.
    assert!((layers.absorption[0] - 0.346_574).abs() < 1e-5 && layers.absorption[1] == 0.0, "{:?}", layers.absorption);
    assert_eq!(layers.absorption[2], 35.0);
    assert_eq!(scene.surfaces[0].emission, [10.0, 20.0, 30.0]);
    assert_eq!((scene.surfaces[0].front, scene.surfaces[0].back), (0, 0));
    let textures = scene.material_textures[0];
    let channel = |property: u32| {
        let own = scene.textures_of(&record).iter().find(|own| own.property == property);
        own.map(|own| scene.textures[own.texture as usize].channel)
    };
    assert_eq!((channel(PROPERTY_ROUGHNESS), channel(PROPERTY_METALLIC)), (Some(1), Some(2)));
    assert_eq!((channel(PROPERTY_SPECULAR), channel(PROPERTY_TRANSMISSION)), (Some(3), Some(0)));
    assert_eq!(channel(PROPERTY_CLEARCOAT_ROUGHNESS), Some(1));
    assert_eq!(textures.normal_scale, 0.5);
    assert_eq!(scene.textures[textures.normal as usize].row_u, [2.0, 0.0, 0.0]);
    assert_eq!(channel(PROPERTY_CLEARCOAT), Some(0));
    assert!(scene.textures.iter().any(|texture| texture.sampling & SECOND_UVS_BIT != 0), "another set of coordinates");
    assert_eq!(scene.images.len(), 2, "one image as colours, one as numbers");
    for expected in ["'KHR_materials_unknown' is not read", "it has no TEXCOORD_1"] {
        assert!(scene.warnings.iter().any(|warning| warning.contains(expected)), "{expected}: {:?}", scene.warnings);
    }
}

#[test]
fn the_room_loads_without_warnings_and_renders() {
    let scene = lumbre::scene::load(&crate::common::scene_path("gltf_room/room.gltf"), &Default::default()).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert!(scene.environment.is_some() && scene.cameras[0].name == "front");
    with_gpu(|gpu| {
        for backend in backends(gpu) {
            let mut settings = settings(&scene, "path", backend);
            (settings.width, settings.height) = (32, 24);
            let [r, g, b] = render(gpu, &scene, &settings, 8).average();
            assert!(r.min(g).min(b) > 0.05, "{}: {r}, {g}, {b}", backend.name());
        }
    });
}

#[test]
fn unlit_materials_emit_their_base_colour() {
    let mut file = textured(&FOUR, json!({}));
    merge(&mut file.json["materials"][0], json!({"extensions": {"KHR_materials_unlit": {}}}));
    let scene = file.load();
    assert!(scene.warnings.iter().any(|warning| warning.contains("unlit")), "{:?}", scene.warnings);
    expect_quarters("unlit", &scene, [0, 1, 2, 3]);
}
