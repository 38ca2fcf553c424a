//! Numbers that single precision cannot hold, in every format: each is refused with what it is, where it stands and what is valid, and so is each
//! product of numbers that were valid by themselves. The rules of `common/hostile.rs` say that none gets into a scene.

use crate::common::alone::alone;
use crate::common::hostile::{Folder, Format};

/// Where single precision ends, as messages say it.
const RANGE: &str = "-3.4e38 to 3.4e38";

fn mitsuba(body: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{body}\n</scene>")
}

/// A shape of a BSDF with these properties.
fn painted(kind: &str, inside: &str) -> String {
    mitsuba(&format!("<shape type=\"rectangle\"><bsdf type=\"{kind}\">\n{inside}</bsdf></shape>"))
}

/// A shape that emits this radiance.
fn lamp(radiance: &str) -> String {
    mitsuba(&format!("<shape type=\"rectangle\"><emitter type=\"area\">\n{radiance}</emitter></shape>"))
}

/// A triangle of this material, with more members of the file and of its node.
fn gltf(material: &str, node: &str, more: &str) -> String {
    // Corners (0, 0, 0), (1, 0, 0) and (0, 1, 0).
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 36, "uri": "data:;base64,{data}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}], "nodes": [{{"mesh": 0{node}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "max": [1e300]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0}}]}}],
        "materials": [{{{material}}}], "extras": {{"much": 1e300}}{more}}}"#
    )
}

fn extension(name: &str, members: &str) -> String {
    gltf(&format!(r#""emissiveFactor": [2e38, 0, 0], "extensions": {{"KHR_materials_{name}": {{{members}}}}}"#), "", "")
}

/// A file with this light.
fn punctual(light: &str) -> String {
    gltf(
        "",
        r#", "extensions": {"KHR_lights_punctual": {"light": 0}}"#,
        &format!(r#", "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "point", {light}}}]}}}}"#),
    )
}

/// A triangle whose material says this.
fn obj(statement: &str) -> String {
    format!(
        "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n\n#####\nnewmtl a\n{statement}\n"
    )
}

/// A triangle of these vertices.
fn plain_obj(vertices: &str, face: &str) -> String {
    format!("{vertices}v 1 0 0\nv 0 1 0\nf {face}\n\n#####\n")
}

fn ply(property: &str, value: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n{property}\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 {value}\n1 0 {value}\n0 1 {value}\n3 0 1 2\n"
    )
}

#[test]
fn numbers_out_of_range_are_refused() {
    use Format::{Gltf, Mitsuba, Obj, Ply};
    let float = |name: &str, value: &str| format!(r#"<float name="{name}" value="{value}"/>"#);
    let normals = "property double nx\nproperty double ny\nproperty double nz\n";
    let uvs = "property double u\nproperty double v\n";
    let cases: Vec<(Format, String, &[&str])> = vec![
        // What is read.
        (Mitsuba, lamp(r#"<rgb name="radiance" value="1e39"/>"#), &["scene.xml:3", "<rgb> 'radiance'", "1e39", RANGE]),
        (Mitsuba, lamp(r#"<spectrum name="radiance" value="1e39"/>"#), &["scene.xml:3", "'radiance'", "1e39", RANGE]),
        (Mitsuba, painted("roughconductor", &float("alpha", "1e300")), &["scene.xml:3", "'alpha'", "1e300", RANGE]),
        (Mitsuba, painted("dielectric", &float("int_ior", "1e39")), &["scene.xml:3", "'int_ior'", "1e39", RANGE]),
        (Mitsuba, painted("dielectric", &float("ext_ior", "1e-300")), &["scene.xml:3", "'ext_ior'", "too small"]),
        (Mitsuba, painted("roughconductor", r#"<rgb name="eta" value="1 1e39 1"/>"#), &["'eta'", "1e39", RANGE]),
        (
            Mitsuba,
            mitsuba(r#"<emitter type="point"><point name="position" x="-1e39"/></emitter>"#),
            &["scene.xml:2", "<point> 'position'", "-1e39", RANGE],
        ),
        (
            Mitsuba,
            mitsuba(r#"<emitter type="point"><point name="position" x="1e30"/></emitter>"#),
            &["a light", "1e18"],
        ),
        (
            Mitsuba,
            painted(
                "bumpmap",
                &format!("{}<texture type=\"checkerboard\"/><bsdf type=\"diffuse\"/>", float("scale", "1e39")),
            ),
            &["scene.xml:3", "'scale'", "1e39", RANGE],
        ),
        (
            Mitsuba,
            mitsuba(&format!(
                r#"<sensor type="thinlens">{}{}</sensor>"#,
                float("aperture_radius", "1e39"),
                float("focus_distance", "1")
            )),
            &["scene.xml:2", "'aperture_radius'", "1e39", RANGE],
        ),
        (Obj, obj("Ni 1e39"), &["scene.mtl:2", "Ni", "1e39", RANGE]),
        (Obj, obj("Ns 1e39"), &["scene.mtl:2", "Ns", "1e39", RANGE]),
        (Obj, obj("Kd 0.5 1e39 0"), &["scene.mtl:2", "Kd", "1e39", RANGE]),
        (Obj, obj("Ke 1e39"), &["scene.mtl:2", "Ke", "1e39", RANGE]),
        (Obj, obj("Pr 1e300"), &["scene.mtl:2", "Pr", "1e300", RANGE]),
        (Obj, obj("map_Kd -s 1e39 1 image.png"), &["scene.mtl", "map_Kd", "-s", "1e39", RANGE]),
        (Obj, obj("map_Bump -bm 1e39 image.png"), &["scene.mtl", "map_Bump", "-bm", "1e39", RANGE]),
        (Obj, plain_obj("v 0 1e39 0\n", "1 2 3"), &["scene spans", "1e18"]),
        (Obj, plain_obj("v 0 0 0\nvt 1e39 0\n", "1/1 2/1 3/1"), &["texture coordinates of vertex 0", RANGE]),
        (Obj, plain_obj("v 0 0 0\nvn 0 0 1e39\n", "1//1 2//1 3//1"), &["normal of vertex 0", RANGE]),
        (Ply, ply("", "1e39"), &["scene spans", "1e18"]),
        (Ply, ply(normals, "0 0 0 1e39"), &["normal of vertex 0", RANGE]),
        (Ply, ply(uvs, "0 1e39 0"), &["texture coordinates of vertex 0", RANGE]),
        (Gltf, gltf(r#""emissiveFactor": [1e39, 0, 0]"#, "", ""), &["materials[0].emissiveFactor[0]", "1e39", RANGE]),
        (
            Gltf,
            extension("emissive_strength", r#""emissiveStrength": 1e39"#),
            &["materials[0].extensions.KHR_materials_emissive_strength.emissiveStrength", "1e39", RANGE],
        ),
        (Gltf, extension("ior", r#""ior": 1e39"#), &["KHR_materials_ior.ior", "1e39", RANGE]),
        (Gltf, extension("volume", r#""attenuationDistance": 1e39"#), &["attenuationDistance", "1e39", RANGE]),
        (Gltf, punctual(r#""intensity": 1e39"#), &["lights[0].intensity", "1e39", RANGE]),
        (Gltf, gltf("", r#", "translation": [0, 1e39, 0]"#, ""), &["nodes[0].translation[1]", "1e39", RANGE]),
        // What comes of it.
        (
            Mitsuba,
            lamp(&format!(
                r#"<spectrum name="radiance" type="d65">{}<rgb name="color" value="1e20"/></spectrum>"#,
                float("scale", "1e20")
            )),
            &["scene.xml:3", "d65", "out of range", RANGE],
        ),
        (
            Mitsuba,
            lamp(r#"<spectrum name="radiance" value="3e38"/>"#),
            &["scene.xml:3", "'radiance'", "out of range", RANGE],
        ),
        (
            Mitsuba,
            lamp(r#"<spectrum name="radiance" value="360:3e38, 830:3e38"/>"#),
            &["scene.xml:3", "linear sRGB", "out of range", RANGE],
        ),
        (
            Mitsuba,
            lamp(&format!(r#"<spectrum name="radiance" type="blackbody">{}</spectrum>"#, float("temperature", "1e38"))),
            &["scene.xml:3", "blackbody", "out of range", RANGE],
        ),
        (
            Mitsuba,
            painted("dielectric", &(float("int_ior", "1e30") + &float("ext_ior", "1e-30"))),
            &["scene.xml:3", "'int_ior'", "3.4e38"],
        ),
        (
            Mitsuba,
            mitsuba(
                "<shape type=\"rectangle\">\n<transform name=\"to_world\"><scale value=\"1e30\"/><scale value=\"1e30\"/></transform></shape>",
            ),
            &["scene.xml:3", "'to_world'", "matrix", RANGE],
        ),
        (
            Mitsuba,
            mitsuba(&format!(
                r#"<emitter type="projector">{}<rgb name="irradiance" value="1"/></emitter>"#,
                float("scale", "2e38")
            )),
            &["scene.xml:2", "'scale'", "pi", RANGE],
        ),
        (
            Mitsuba,
            mitsuba(&format!(
                r#"<sensor type="perspective">{}{}</sensor>"#,
                float("fov", "150"),
                float("principal_point_offset_x", "-3e38")
            )),
            &["camera 'camera0': its rays", "out of range", RANGE],
        ),
        (
            Gltf,
            extension("emissive_strength", r#""emissiveStrength": 2"#),
            &["materials[0]", "emissiveFactor times emissiveStrength", "4e38", RANGE],
        ),
        (
            Gltf,
            extension("volume", r#""attenuationDistance": 1e-38, "attenuationColor": [0.5, 1e-30, 1]"#),
            &["materials[0]", "attenuationDistance", RANGE],
        ),
        (Gltf, punctual(r#""intensity": 1e20, "color": [1e20, 0, 0]"#), &["lights[0]", "intensity times color", RANGE]),
        (
            Gltf,
            gltf("", r#", "scale": [1e-20, 1e-20, 1e-20], "children": [1]"#, "").replace(
                r#""scale": [1e-20, 1e-20, 1e-20], "children": [1]}"#,
                r#""scale": [1e30, 1, 1], "children": [1]}, {"scale": [1e30, 1, 1]}"#,
            ),
            &["nodes[1]", "where it stands", RANGE],
        ),
    ];
    // Memory is counted for the whole process.
    alone(|| {
        let folder = Folder::new("lumbre-ranges");
        let mut faults = Vec::new();
        for (format, text, expected) in cases {
            match folder.check(format, text.as_bytes()).first() {
                None => faults.push(format!("was read:\n{text}")),
                Some(message) => {
                    let missing: Vec<_> = expected.iter().filter(|part| !message.contains(**part)).collect();
                    if !missing.is_empty() {
                        faults.push(format!("{missing:?} is not in: {message}\n{text}"));
                    }
                }
            }
        }
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    });
}

/// What is within the range is read, however large it is, and so is what is out of it and of no use here.
#[test]
fn numbers_in_range_are_read() {
    let cases = [
        (Format::Mitsuba, lamp(r#"<rgb name="radiance" value="3.4e38"/>"#)),
        (Format::Mitsuba, painted("roughconductor", r#"<float name="alpha" value="1e-300"/>"#)),
        (Format::Gltf, gltf(r#""emissiveFactor": [3.4e38, 0, 0]"#, "", "")),
        (Format::Gltf, extension("volume", r#""thicknessFactor": 1, "attenuationDistance": 3e38"#)),
        (Format::Gltf, extension("unknown", r#""much": 1e300"#)),
        (Format::Obj, obj("Ke 3.4e38")),
        (Format::Obj, obj("unknown 1e300")),
        (Format::Obj, plain_obj("v 0 0 0\nvn nan nan nan\n", "1//1 2//1 3//1")),
        (Format::Ply, ply("property double quality\n", "0 1e300")),
    ];
    // Memory is counted for the whole process.
    alone(|| {
        let folder = Folder::new("lumbre-ranges");
        for (format, text) in cases {
            let messages = folder.check(format, text.as_bytes());
            assert!(messages.is_empty(), "{messages:?}\n{text}");
        }
    });
}
