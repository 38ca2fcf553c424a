//! Bad input: each case names the culprit in one line, and nothing panics.

use std::path::Path;

use crate::common::{settings, with_gpu};
use lumbre::gpu::Buffer;
use lumbre::layout::backend::Backend;
use lumbre::scene::{LoadOptions, Scene};

fn load(folder: &Path, name: &str) -> lumbre::Result<Scene> {
    lumbre::scene::load(&folder.join(name), &LoadOptions::default())
}

/// The message of a scene that must be refused: one line that names the file.
fn refused(name: &str, text: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), text).unwrap();
    let error =
        load(folder.path(), name).expect_err(&format!("{name} should be refused:\n{}", String::from_utf8_lossy(text)));
    assert_eq!(error.exit_status(), 2, "{error}");
    let message = error.to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    assert!(message.contains(name), "the message names the file: {message}");
    message
}

/// A Mitsuba scene of this body; the message must contain all of these.
fn xml(body: &str, expected: &[&str]) {
    let message = refused("scene.xml", format!("<scene version=\"3.0.0\">\n{body}\n</scene>").as_bytes());
    for part in expected {
        assert!(message.contains(part), "'{part}' is not in: {message}\nfor: {body}");
    }
}

#[test]
fn malformed_xml() {
    for text in
        ["", "no xml", "<scene>", "<scene><shape></scene>", "<scene version=\"3.0.0\"/><scene/>", "<a b='1' b='2'/>"]
    {
        assert!(refused("scene.xml", text.as_bytes()).contains("scene.xml:"), "{text}");
    }
    assert!(refused("scene.xml", b"<scene version='3'>\xff\xfe</scene>").contains("scene.xml"));
    assert!(refused("scene.xml", b"<bsdf type='diffuse'/>").contains("<scene>"));
    // Entities that multiply: no document type is read at all.
    let bomb = b"<!DOCTYPE scene [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>]><scene version='3'>&b;</scene>";
    refused("scene.xml", bomb);
    let deep = "<shape type='a'>".repeat(5000) + &"</shape>".repeat(5000);
    refused("scene.xml", format!("<scene version='3'>{deep}</scene>").as_bytes());
}

#[test]
fn unknown_things_list_what_is_known() {
    xml("<shape type='teapot'/>", &["scene.xml:2", "teapot", "obj, ply, serialized, rectangle"]);
    xml("<bsdf type='velvet'/>", &["velvet", "diffuse"]);
    xml("<emitter type='lantern'/>", &["lantern", "point, spot, directional, projector, constant or envmap"]);
    xml("<sensor type='fisheye'/>", &["fisheye", "perspective"]);
    xml("<sensor type='perspective'><film type='ldrfilm'/></sensor>", &["ldrfilm", "hdrfilm"]);
    xml(
        "<sensor type='perspective'><film type='hdrfilm'><rfilter type='sharp'/></film></sensor>",
        &["sharp", "gaussian"],
    );
    xml("<sensor type='perspective'><sampler type='psychic'/></sensor>", &["psychic", "independent"]);
    xml("<medium type='fog'/>", &["medium 'fog'", "participating media"]);
    xml("<shape type='sphere'>\n<float name='radios' value='1'/></shape>", &["scene.xml:3", "radios", "radius"]);
    xml("<bsdf type='diffuse'><float name='shine' value='1'/></bsdf>", &["shine", "reflectance"]);
    xml("<emitter type='point'><integer name='x' value='1'/></emitter>", &["'x'", "intensity"]);
    xml("<shape type='sphere' size='3'/>", &["size", "type"]);
    xml("<shape type='sphere'><ref id='nothing'/></shape>", &["nothing"]);
    xml("<bsdf type='diffuse' id='a'/><bsdf type='diffuse' id='a'/>", &["'a'", "twice"]);
    xml("<shape type='sphere'><float name='radius' value='$r'/></shape>", &["$r", "-D"]);
    xml("<shape type='sphere'><medium type='x'/></shape>", &["medium 'x'", "participating media"]);
    xml("<shape type='sphere'><sensor type='perspective'/></shape>", &["<sensor>"]);
    xml(
        "<bsdf type='conductor'><string name='material' value='Unobtainium'/></bsdf>",
        &["Unobtainium", "none, a-C, Ag,"],
    );
    xml("<bsdf type='conductor'><string name='material' value='Au'/><rgb name='k' value='1'/></bsdf>", &["not both"]);
    xml("<bsdf type='dielectric'><string name='int_ior' value='jelly'/></bsdf>", &["jelly", "water"]);
    xml(
        "<bsdf type='roughconductor'><string name='distribution' value='phong'/></bsdf>",
        &["distribution", "phong", "beckmann or ggx"],
    );
}

#[test]
fn wrong_types_and_values() {
    xml("<shape type='sphere'><float name='radius' value='big'/></shape>", &["radius", "big", "number"]);
    xml("<shape type='sphere'><float name='radius' value='nan'/></shape>", &["radius", "nan"]);
    xml("<shape type='sphere'><float name='radius' value='1e999'/></shape>", &["radius"]);
    xml("<shape type='sphere'><string name='radius' value='1'/></shape>", &["radius", "string", "float"]);
    xml("<shape type='sphere'><float name='radius' value='-1'/></shape>", &["radius", "-1"]);
    xml(
        "<shape type='sphere'><float name='radius' value='1'/><float name='radius' value='2'/></shape>",
        &["radius", "twice"],
    );
    xml("<shape type='sphere'><float name='radius'/></shape>", &["value"]);
    xml("<shape type='sphere'><boolean name='flip_normals' value='yes'/></shape>", &["flip_normals", "true or false"]);
    xml("<bsdf type='diffuse'><rgb name='reflectance' value='1, 2'/></bsdf>", &["reflectance"]);
    xml("<bsdf type='diffuse'><rgb name='reflectance' value='2'/></bsdf>", &["reflectance", "above 1"]);
    xml("<bsdf type='diffuse'><rgb name='reflectance' value='#a0b1c2'/></bsdf>", &["reflectance", "<srgb>"]);
    xml("<bsdf type='diffuse'><srgb name='reflectance' value='#a0b1'/></bsdf>", &["reflectance", "#a0b1c2"]);
    xml("<bsdf type='diffuse'><rgb name='reflectance' value='-1'/></bsdf>", &["reflectance", "negative"]);
    xml("<bsdf type='diffuse'><transform name='reflectance'/></bsdf>", &["reflectance", "transform", "colour"]);
    xml("<emitter type='point'><rgb name='intensity' value='-1'/></emitter>", &["intensity", "negative"]);
    xml("<sensor type='perspective'><float name='fov' value='180'/></sensor>", &["fov", "180"]);
    xml(
        "<sensor type='perspective'><string name='fov_axis' value='w'/><float name='fov' value='9'/></sensor>",
        &["fov_axis", "diagonal"],
    );
    xml(
        "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='0'/></film></sensor>",
        &["width", "0"],
    );
    xml(
        "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='-5'/></film></sensor>",
        &["width", "-5"],
    );
    xml(
        "<sensor type='perspective'><sampler type='independent'><integer name='sample_count' value='-1'/></sampler></sensor>",
        &["sample_count"],
    );
    xml("<integrator type='path'><integer name='max_depth' value='-7'/></integrator>", &["max_depth", "-7"]);
    xml("<shape type='cube'><transform name='to_world'><scale value='0'/></transform></shape>", &["singular"]);
    xml(
        "<shape type='cube'><transform name='to_world'><scale x='1e-200'/><scale x='1e-200'/></transform></shape>",
        &["singular"],
    );
    xml("<shape type='cube'><transform name='to_world'><bend angle='1'/></transform></shape>", &["bend", "translate"]);
    xml("<shape type='cube'><transform name='to_world'><rotate angle='1'/></transform></shape>", &["axis"]);
    xml("<shape type='cube'><transform name='to_world'><matrix value='1 2 3'/></transform></shape>", &["9 or 16"]);
    xml(
        "<shape type='cube'><transform name='to_world'><lookat origin='0,0,0' target='0,0,0' up='0,1,0'/></transform></shape>",
        &["lookat"],
    );
    xml("<shape type='sphere'><transform name='to_world'><scale x='2'/></transform></shape>", &["to_world", "uniform"]);
    xml("<shape type='cylinder'><point name='p1' x='0' y='0' z='0'/></shape>", &["scene.xml:2", "p1", "no length"]);
    xml("<shape type='cylinder'><float name='radius' value='-1'/></shape>", &["radius", "-1"]);
    xml("<shape type='disk'><float name='radius' value='2'/></shape>", &["disk", "radius", "to_world"]);
    xml("<shape type='cube'><transform name='to_world'><translate x='1e30'/></transform></shape>", &["1e18"]);
    xml("<bsdf type='twosided'/>", &["twosided"]);
    xml("<bsdf type='twosided'><bsdf type='dielectric'/></bsdf>", &["two"]);
    xml(
        "<bsdf type='roughconductor'><string name='distribution' value='ggx'/><float name='alpha' value='-0.1'/></bsdf>",
        &["alpha"],
    );
    xml(
        "<emitter type='spot'><float name='cutoff_angle' value='10'/><float name='beam_width' value='20'/></emitter>",
        &["beam_width"],
    );
    xml("<emitter type='constant'/><emitter type='constant'/>", &["two environments"]);
    xml("<emitter type='area'/>", &["inside the shape"]);
    xml("<shape type='instance'/>", &["shapegroup"]);
    let group = "<shape type='shapegroup' id='g'><shape type='sphere'><emitter type='area'/></shape></shape><shape type='instance'><ref id='g'/></shape>";
    xml(group, &["emits", "'g'"]);
}

#[test]
fn broken_spectra() {
    let spectrum = |attributes: &str, expected: &[&str]| {
        xml(&format!("<bsdf type='diffuse'>\n<spectrum name='reflectance' {attributes}/></bsdf>"), expected);
    };
    spectrum("", &["scene.xml:3", "'value' or 'filename'"]);
    spectrum("value='0.5' filename='x.spd'", &["scene.xml:3", "'value' or 'filename'"]);
    spectrum("value='red'", &["'reflectance'", "red", "wavelength:value"]);
    spectrum("value='400:0.1, 500'", &["'500'"]);
    spectrum("value='500:0.1, 400:0.1'", &["must increase"]);
    spectrum("value='500:0.1, 600:-1'", &["negative"]);
    spectrum("value='500:0.1'", &["two samples"]);
    spectrum("filename='none.spd'", &["scene.xml:3", "'reflectance'", "none.spd"]);
    let file = |text: &[u8], expected: &str| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("x.spd"), text).unwrap();
        let scene = "<scene version='3.0.0'><bsdf type='diffuse'><spectrum name='reflectance' filename='x.spd'/></bsdf></scene>";
        std::fs::write(folder.path().join("scene.xml"), scene).unwrap();
        let message = load(folder.path(), "scene.xml").unwrap_err().to_string();
        assert!(message.contains("x.spd") && message.contains(expected), "'{expected}' is not in: {message}");
    };
    file(b"", "two samples");
    file(b"400 0.1\n500 0.2 0.3\n", "x.spd:2: '500 0.2 0.3'");
    file(b"400 0.1\n500, 0.2\n", "x.spd:2");
    file(b"400 0.1\n# a comment\n300 0.2\n", "x.spd:3: the wavelength 300 follows 400");
    file(b"400 0.1\n\xff\xff", "UTF-8");
}

#[test]
fn missing_and_cyclic_files() {
    xml("<shape type='obj'><string name='filename' value='none.obj'/></shape>", &["scene.xml:2", "none.obj"]);
    xml("<shape type='ply'/>", &["filename"]);
    xml("<shape type='serialized'><string name='filename' value='none.ser'/></shape>", &["scene.xml:2", "none.ser"]);
    xml(
        "<shape type='serialized'><string name='filename' value='x'/><integer name='shape_index' value='-1'/></shape>",
        &["shape_index", "-1"],
    );
    // The scene itself is not a mesh.
    xml(
        "<shape type='serialized'><string name='filename' value='scene.xml'/></shape>",
        &["scene.xml: not a serialized mesh"],
    );
    xml("<include filename='none.xml'/>", &["scene.xml:2", "none.xml"]);
    xml("<include filename='scene.xml'/>", &["cycle"]);
    let folder = tempfile::tempdir().unwrap();
    for (name, extension) in [("none.xml", "xml"), ("none.obj", "obj"), ("none.ply", "ply")] {
        let error = load(folder.path(), name).unwrap_err();
        assert!(error.to_string().contains(name) && error.exit_status() == 2, "{extension}: {error}");
    }
}

#[test]
fn broken_obj_files() {
    let obj = |text: &str, expected: &str| {
        let message = refused("mesh.obj", text.as_bytes());
        assert!(message.contains(expected), "'{expected}' is not in: {message}");
    };
    let square = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    obj("", "no faces");
    obj("v 0 0 0\n", "no faces");
    obj("v 0 0\n", "mesh.obj:1");
    obj("v a b c\n", "mesh.obj:1");
    obj(&format!("{square}f 1 2 9\n"), "mesh.obj:4: the face refers to vertex 9");
    obj(&format!("{square}f 1 2 -9\n"), "mesh.obj");
    obj(&format!("{square}f 1 2 0\n"), "mesh.obj");
    obj(&format!("{square}f 1 2 99999999999999999999\n"), "mesh.obj:4");
    obj(&format!("{square}f a b c\n"), "mesh.obj:4");
    obj(&format!("{square}vn 0 0 1\nf 1//7 2//7 3//7\n"), "normal 7");
    obj("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "must be finite");
    obj("v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "must be finite");
    refused("mesh.obj", b"v 0 0 0\nv \xff\xff\xff\n");
}

#[test]
fn broken_ply_files() {
    let header = |vertices: &str, faces: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let ply = |text: String, expected: &str| {
        let message = refused("mesh.ply", text.as_bytes());
        assert!(message.contains(expected), "'{expected}' is not in: {message}");
    };
    let corners = "0 0 0\n1 0 0\n0 1 0\n";
    ply(String::new(), "not a valid PLY");
    ply(String::from("ply\n"), "not a valid PLY");
    ply(header("3", "1"), "not a valid PLY");
    ply(header("3", "1") + corners, "not a valid PLY");
    ply(header("3", "1") + corners + "3 0 1 3\n", "vertex 3");
    ply(header("3", "1") + corners + "3 0 1 -1\n", "refers to vertex");
    ply(header("3", "1") + corners + "2 0 1\n", "three or more");
    ply(header("3", "1") + corners + "3 0 1\n", "mesh.ply:");
    ply(header("3", "1") + "0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n", "'0 0 nan'");
    ply(header("3", "1") + "0 0 x\n1 0 0\n0 1 0\n3 0 1 2\n", "mesh.ply:");
    ply(header("99999999999", "1") + corners, "not a valid PLY");
    ply(header("-3", "1"), "not a valid PLY");
    ply(header("3", "1").replace("property float z\n", "") + "0 0\n1 0\n0 1\n3 0 1 2\n", "no property 'z'");
    ply(header("3", "1").replace("ascii", "morse"), "not a valid PLY");
    // A coordinate that is not a number: text cannot say it, bytes can.
    let mut binary = header("3", "1").replace("ascii", "binary_little_endian").into_bytes();
    [0.0, 0.0, f32::NAN, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|value| binary.extend(value.to_le_bytes()));
    binary.push(3);
    [0, 1, 2].iter().for_each(|index: &i32| binary.extend(index.to_le_bytes()));
    assert!(refused("mesh.ply", &binary).contains("vertex 0 of 3"));
    // A binary file that ends too early, and one whose list claims to be huge.
    let mut binary = header("3", "1").replace("ascii", "binary_little_endian").into_bytes();
    binary.extend([0; 20]);
    refused("mesh.ply", &binary);
    let mut binary =
        header("0", "1").replace("uchar int", "uint int").replace("ascii", "binary_little_endian").into_bytes();
    binary.extend(u32::MAX.to_le_bytes());
    refused("mesh.ply", &binary);
}

/// What a renderer refuses at its own door.
#[test]
fn bad_settings() {
    let scene = crate::common::canon("furnace_box.xml", &[]);
    with_gpu(|gpu| {
        let mut wrong = settings(&scene, "path", Backend::Bvh);
        wrong.width = 0;
        let error = lumbre::render::render(gpu, &scene, &wrong, 1).unwrap_err();
        assert!(error.to_string().contains("0x64") && error.exit_status() == 2, "{error}");
        let fine = settings(&scene, "path", Backend::Bvh);
        assert!(lumbre::render::render(gpu, &scene, &fine, 0).unwrap_err().to_string().contains("1 or more"));
    });
}

/// More memory than there is: the error names the buffer, its size and what is in use.
#[test]
fn out_of_memory_is_named() {
    with_gpu(|gpu| {
        let error = Buffer::new(gpu, "a very large buffer", 1 << 50).err().unwrap().to_string();
        assert!(error.contains("a very large buffer") && error.contains("1048576.00 GiB"), "{error}");
        // The device goes on working.
        assert_eq!(Buffer::with_data(gpu, "small", &[1u32, 2, 3]).unwrap().read::<u32>(3).unwrap(), [1, 2, 3]);
    });
}
