//! glTF files that are broken, or that lie: each is refused with one line that names the element at fault, and nothing panics.

use crate::common::gltf::{F32, FOUR, Gltf, SQUARE, U8, U32, floats, load, merge, textured};
use serde_json::{Value, json};

/// The message of a file that must be refused: one line that names the file.
fn refused(bytes: &[u8], name: &str) -> String {
    let error = load(bytes, name, &[]).expect_err(&format!("should be refused:\n{}", String::from_utf8_lossy(bytes)));
    assert_eq!(error.exit_status(), 2, "{error}");
    let message = error.to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    assert!(message.contains(name), "the message names the file: {message}");
    message
}

/// A file with a textured square, an accessor of each kind and a light.
fn sound() -> Gltf {
    let mut file = textured(&FOUR, json!({}));
    let colours = file.accessor(&floats(&[0.5; 16]), F32, "VEC4", 4, json!({}));
    let (at, values) = (file.view(&[0], json!({})), file.view(&floats(&[-1.0, -1.0, 0.0]), json!({})));
    let sparse = json!({"sparse": {
        "count": 1, "indices": {"bufferView": at, "componentType": U8}, "values": {"bufferView": values}
    }});
    let positions = file.accessor(&floats(&SQUARE), F32, "VEC3", 4, sparse);
    let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    merge(attributes, json!({"POSITION": positions, "COLOR_0": colours}));
    file
}

#[test]
fn broken_files_name_what_is_wrong() {
    let good = sound();
    assert!(good.try_load(&[]).is_ok());
    let accessor = good.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
    let position = "meshes[0].primitives[0].attributes.POSITION";
    // A pointer into the JSON, what to put there, and what the message must say.
    let cases: Vec<(&str, Value, Vec<&str>)> = vec![
        ("/asset/version", json!("1.0"), vec!["asset.version", "1.0"]),
        ("/asset", json!({}), vec!["asset.version"]),
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            vec!["KHR_draco_mesh_compression", "KHR_texture_transform"],
        ),
        ("/extensionsRequired", json!(["a\nb"]), vec!["a\\nb"]),
        ("/extensionsRequired", json!(7), vec!["extensionsRequired"]),
        ("/scene", json!(5), vec!["scenes[5]"]),
        ("/scene", json!(-1), vec!["scene"]),
        ("/scenes/0/nodes/0", json!(99), vec!["scenes[0]", "nodes[99]"]),
        ("/scenes/0/nodes/0", json!(2), vec!["scenes[0]", "nodes[2]"]),
        ("/nodes/0/children", json!([0]), vec!["nodes[0]"]),
        ("/nodes/0/children", json!([1]), vec!["nodes[1]", "another parent"]),
        ("/nodes/1/children", json!([77]), vec!["nodes[1]", "nodes[77]"]),
        ("/nodes/1/mesh", json!(3), vec!["nodes[1]", "meshes[3]"]),
        ("/nodes/0/camera", json!(3), vec!["nodes[0]", "cameras[3]"]),
        ("/nodes/1/rotation", json!([0, 0, 0, 0]), vec!["nodes[1]", "rotation"]),
        ("/nodes/1/rotation", json!([0, 0, 0]), vec!["nodes[1]"]),
        ("/nodes/1/scale", json!([1e200, 1e200, 1e300]), vec!["nodes[1]", "scale"]),
        ("/nodes/1/scale", json!([1e30, 1e30, 1]), vec!["scene spans"]),
        ("/nodes/1/translation", json!([987_654_321, 0, 0]), vec!["JSON"]),
        ("/nodes/1/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), vec!["nodes[1]", "last row"]),
        ("/nodes/2/extensions/KHR_lights_punctual/light", json!(4), vec!["nodes[2]", "lights[4]"]),
        ("/nodes/2/extensions/KHR_lights_punctual", json!([]), vec!["nodes[2]", "KHR_lights_punctual"]),
        ("/extensions/KHR_lights_punctual/lights/0/type", json!("sun"), vec!["lights[0]", "directional"]),
        ("/extensions/KHR_lights_punctual/lights/0/intensity", json!(-1), vec!["lights[0]", "intensity"]),
        ("/extensions/KHR_lights_punctual/lights/0/color", json!([1, 1e39, 1]), vec!["lights[0]", "color"]),
        (
            "/extensions/KHR_lights_punctual/lights/0",
            json!({"type": "spot", "spot": {"outerConeAngle": 2}}),
            vec!["lights[0]", "cone"],
        ),
        ("/cameras/0/type", json!("fisheye"), vec!["cameras[0]"]),
        ("/cameras/0/orthographic/xmag", json!(0), vec!["cameras[0]", "xmag"]),
        (
            "/cameras/0",
            json!({"type": "perspective", "perspective": {"yfov": 4, "znear": 1}}),
            vec!["cameras[0]", "yfov"],
        ),
        ("/cameras/0", json!({"type": "perspective"}), vec!["cameras[0]"]),
        ("/meshes/0/primitives/0/indices", json!(accessor), vec!["meshes[0].primitives[0].indices", "SCALAR"]),
        ("/meshes/0/primitives/0/indices", json!(99), vec!["indices", "accessors[99]"]),
        ("/meshes/0/primitives/0/mode", json!(9), vec!["meshes[0].primitives[0]", "mode"]),
        ("/meshes/0/primitives/0/material", json!(9), vec!["meshes[0].primitives[0]", "materials[9]"]),
        ("/meshes/0/primitives/0/attributes", json!({}), vec!["meshes[0].primitives[0]", "POSITION"]),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(1), vec![position, "accessor 1", "VEC2"]),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(99), vec![position, "accessors[99]"]),
        ("/meshes/0/primitives/0", json!(7), vec!["meshes[0]"]),
        ("/accessors/1/count", json!(3), vec!["TEXCOORD_0", "3", "4"]),
        ("/accessors/2/count", json!(4_000_000_000u64), vec!["indices", "accessor 2", "bufferViews[3]"]),
        ("/accessors/2/count", json!(u64::MAX), vec!["accessor 2"]),
        ("/accessors/2/count", json!(-1), vec!["accessors[2]"]),
        ("/accessors/2/byteOffset", json!(u64::MAX), vec!["accessor 2"]),
        ("/accessors/2/componentType", json!(1), vec!["accessors[2]", "componentType"]),
        ("/accessors/2/type", json!("VEC9"), vec!["accessors[2]"]),
        ("/accessors/2/bufferView", json!(99), vec!["accessor 2", "bufferViews[99]"]),
        ("/bufferViews/3/byteLength", json!(u64::MAX), vec!["bufferViews[3]", "buffers[0]"]),
        ("/bufferViews/3/byteOffset", json!(1_000_000), vec!["bufferViews[3]"]),
        ("/bufferViews/3/buffer", json!(9), vec!["bufferViews[3]", "buffers[9]"]),
        ("/bufferViews/3/byteStride", json!(0), vec!["bufferViews[3]", "byteStride"]),
        ("/bufferViews/3/byteStride", json!(u64::MAX), vec!["bufferViews[3]"]),
        ("/buffers", json!([{"byteLength": 1_000_000, "uri": "data:,x"}]), vec!["buffers[0]", "1000000"]),
        ("/buffers", json!([{"byteLength": 1}]), vec!["buffers[0]", "uri"]),
        ("/buffers", json!([{"byteLength": 1, "uri": "../../etc/passwd"}]), vec!["buffers[0]", "leaves"]),
        ("/buffers", json!([{"byteLength": 1, "uri": "/etc/passwd"}]), vec!["buffers[0]", "absolute"]),
        ("/buffers", json!([{"byteLength": 1, "uri": "file:///etc/passwd"}]), vec!["buffers[0]", "relative"]),
        ("/buffers", json!([{"byteLength": 1, "uri": "%2e%2e/x"}]), vec!["buffers[0]", "leaves"]),
        ("/buffers", json!([{"byteLength": 1, "uri": "data:;base64,!!"}]), vec!["buffers[0]", "base64"]),
        ("/images/0", json!({"uri": "../x.png"}), vec!["images[0]", "leaves"]),
        ("/images/0", json!({}), vec!["images[0]", "bufferView"]),
        ("/images/0", json!({"uri": "data:image/png;base64,AAAA"}), vec!["images[0]", "PNG, JPEG"]),
        ("/images/0/bufferView", json!(3), vec!["images[0]", "image"]),
        ("/images/0/bufferView", json!(99), vec!["images[0]", "bufferViews[99]"]),
        ("/textures/0/source", json!(9), vec!["textures[0]", "images[9]"]),
        ("/textures/0/sampler", json!(9), vec!["textures[0]", "samplers[9]"]),
        ("/samplers/0/wrapS", json!(1), vec!["textures[0]", "wrapS"]),
        (
            "/materials/0/pbrMetallicRoughness/baseColorTexture/index",
            json!(9),
            vec!["materials[0].baseColorTexture", "textures[9]"],
        ),
        (
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            json!([1, 2, 1, 1]),
            vec!["materials[0]", "baseColorFactor", "2"],
        ),
        ("/materials/0/pbrMetallicRoughness/metallicFactor", json!(-1), vec!["materials[0]", "metallicFactor"]),
        ("/materials/0/pbrMetallicRoughness/roughnessFactor", json!(1e39), vec!["materials[0]", "roughnessFactor"]),
        ("/materials/0/emissiveFactor", json!([-1, 0, 0]), vec!["materials[0]", "emissiveFactor"]),
        ("/materials/0/alphaMode", json!("GLASS"), vec!["materials[0]", "alphaMode"]),
        ("/materials/0/extensions/KHR_materials_ior", json!({"ior": 0.5}), vec!["materials[0]", "ior"]),
        (
            "/materials/0/extensions/KHR_materials_clearcoat",
            json!({"clearcoatFactor": "a"}),
            vec!["materials[0]", "clearcoat"],
        ),
        (
            "/materials/0/extensions/KHR_materials_volume",
            json!({"attenuationDistance": 0}),
            vec!["materials[0]", "attenuationDistance"],
        ),
        ("/materials", json!({}), vec!["materials"]),
    ];
    for (pointer, value, expected) in cases {
        let mut file = good.clone();
        let (parent, name) = pointer.rsplit_once('/').unwrap();
        match file.json.pointer_mut(parent).unwrap_or_else(|| panic!("{pointer}")) {
            Value::Array(list) => list[name.parse::<usize>().unwrap()] = value,
            object => object[name] = value,
        }
        // A number beyond the largest double, which the macro cannot write.
        let text = file.text().replace("987654321", "1e999");
        let message = refused(text.as_bytes(), "scene.gltf");
        for part in expected {
            assert!(message.contains(part), "'{part}' is not in: {message}\nfor: {pointer}");
        }
    }
    // Sparse accessors, which the loop's pointers would make long.
    for (name, value, expected) in [
        ("count", json!(1_000_000_000u64), "sparse.count"),
        ("indices", json!({"bufferView": 99, "componentType": U8}), "bufferViews[99]"),
        ("indices", json!({"bufferView": 0, "componentType": F32}), "componentType"),
        ("indices", json!({"bufferView": 0, "componentType": U32}), "replaces element"),
        ("values", json!({"bufferView": 0, "byteOffset": u64::MAX}), "sparse.values"),
    ] {
        let mut file = good.clone();
        file.json["accessors"][accessor]["sparse"][name] = value;
        let message = refused(file.text().as_bytes(), "scene.gltf");
        assert!(message.contains(position) && message.contains(expected), "{message}");
    }
    let mut file = good.clone();
    file.json["accessors"][accessor] = json!({"componentType": F32, "type": "VEC3", "count": 1u64 << 60});
    assert!(refused(file.text().as_bytes(), "scene.gltf").contains("no bufferView"));
    // Numbers that are none, and an index beyond the vertices.
    for (place, bytes, expected) in [
        (3, f32::NAN.to_le_bytes().to_vec(), "TEXCOORD_0"),
        (2, f32::INFINITY.to_le_bytes().to_vec(), "element 0"),
        (3, vec![9, 0], "vertex 9"),
    ] {
        let mut file = good.clone();
        let view = if expected == "TEXCOORD_0" { 2 } else { place };
        let at = file.json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
        file.bytes[at..at + bytes.len()].copy_from_slice(&bytes);
        let message = refused(file.text().as_bytes(), "scene.gltf");
        assert!(message.contains(expected), "'{expected}' is not in: {message}");
    }
}

#[test]
fn hostile_bytes_never_panic() {
    for bytes in [&b""[..], b"x", b"[]", b"{}", b"\xff\xfe{}", b"{\"asset\":{\"version\":\"2.0\xff\"}}"] {
        refused(bytes, "scene.gltf");
    }
    refused(("[".repeat(100_000) + &"]".repeat(100_000)).as_bytes(), "scene.gltf");
    let good = sound();
    let glb = good.glb();
    assert!(load(&glb, "scene.glb", &[]).is_ok());
    for length in (0..glb.len()).step_by(7).chain(0..64) {
        refused(&glb[..length], "scene.glb");
    }
    // Headers that lie, one word after the other.
    for word in 0..5 {
        for value in [0, 1, 11, 13, 0x7fff_ffff, u32::MAX] {
            let mut bytes = glb.clone();
            bytes[4 * word..4 * word + 4].copy_from_slice(&u32::to_le_bytes(value));
            refused(&bytes, "scene.glb");
        }
    }
    // Any byte changed: refused or read, but no panic. A generator of our own, so that a failure comes again.
    let mut state = 12345u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize
    };
    let (mut read, mut failed) = (0, 0);
    for _ in 0..3000 {
        let mut bytes = glb.clone();
        for _ in 0..1 + next() % 3 {
            let at = 12 + next() % (bytes.len() - 12);
            bytes[at] = if next() % 2 == 0 { b"0123456789,-e]}"[next() % 15] } else { next() as u8 };
        }
        match load(&bytes, "scene.glb", &[]) {
            Ok(_) => read += 1,
            Err(error) => {
                assert!(!error.to_string().contains('\n'), "{error}");
                failed += 1;
            }
        }
    }
    println!("{read} were read and {failed} refused");
    assert!(read > 100 && failed > 100);
}

#[test]
fn a_chain_of_nodes_may_be_as_long_as_the_file() {
    // It is followed without recursion.
    let mut file = sound();
    let first = file.json["nodes"].as_array().unwrap().len();
    for index in 0..50_000 {
        file.add("nodes", json!({"children": [first + index + 1]}));
    }
    file.add("nodes", json!({}));
    file.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(first));
    assert!(file.try_load(&[]).is_ok());
}

/// What few bytes place very often is counted: instances, the meshes of nodes, joints. A skin that many nodes have is there once.
#[test]
fn what_is_placed_is_counted() {
    let mut file = Gltf::new();
    let mesh = file.square(json!({}), json!({}));
    let many = json!({"componentType": F32, "type": "VEC3", "count": 600_000});
    let many = file.add("accessors", many);
    let node = json!({"mesh": mesh, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": many}}}});
    let (first, second) = (file.node(node.clone()), file.node(node));
    let message = refused(file.text().as_bytes(), "scene.gltf");
    let expected = [format!("nodes[{second}]"), String::from("more than 1048576 placed meshes, instances counted")];
    assert!(expected.iter().all(|part| message.contains(part)) && first != second, "{message}");

    let mut file = Gltf::new();
    let joints = file.accessor(&[0; 16], U8, "VEC4", 4, json!({}));
    let weights = file.accessor(&floats(&[1.0, 0.0, 0.0, 0.0].repeat(4)), F32, "VEC4", 4, json!({}));
    let mesh = file.square(json!({}), json!({"attributes": {"JOINTS_0": joints, "WEIGHTS_0": weights}}));
    let joint = file.node(json!({}));
    let skin = file.add("skins", json!({"joints": vec![joint; 1000]}));
    let skinned: Vec<usize> = (0..1100).map(|_| file.node(json!({"mesh": mesh, "skin": skin}))).collect();
    assert_eq!(file.try_load(&[]).unwrap().primitives.len(), 2200);
    file.json["skins"][0]["joints"] = json!(vec![joint; (1 << 20) + 1]);
    let message = refused(file.text().as_bytes(), "scene.gltf");
    let expected = [format!("nodes[{}]", skinned[0]), String::from("more than 1048576 joints")];
    assert!(expected.iter().all(|part| message.contains(part)), "{message}");
}
