//! OBJ and MTL files as people have them: what each kind of line means.

use crate::common::gltf::{load, png};
use glam::Vec3;
use lumbre::layout::{
    MATERIAL_CONDUCTOR, MATERIAL_DIELECTRIC, MATERIAL_DIFFUSE, MATERIAL_HAS_COLOURS, MATERIAL_LAYERED, Material, NONE,
    PROPERTY_REFLECTANCE, PROPERTY_ROUGHNESS, SMOOTH_BIT, SURFACE_MASK, Surface, UV_BIT,
};
use lumbre::scene::Scene;

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
const RED: &str = "newmtl red\nKd 0.9 0.1 0.1\n";

fn with(text: &str, others: &[(&str, &[u8])]) -> Scene {
    load(text.as_bytes(), "scene.obj", others).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn refused(text: &str, mtl: &str) -> String {
    load(text.as_bytes(), "scene.obj", &[("scene.mtl", mtl.as_bytes())]).unwrap_err().to_string()
}

fn surface(scene: &Scene, primitive: usize) -> &Surface {
    &scene.surfaces[(scene.primitives[primitive].surface & SURFACE_MASK) as usize]
}

fn material(scene: &Scene, primitive: usize) -> &Material {
    &scene.materials[surface(scene, primitive).front as usize]
}

/// The square under an MTL file's only material.
fn square_of(mtl: &str) -> Scene {
    let obj = format!("mtllib scene.mtl\n{SQUARE}vt 0 0\nusemtl a\nf 1/1 2/1 3/1 4/1\n");
    let texels = [[255, 128, 0, 255], [255, 128, 0, 0]];
    let others = [("scene.mtl", format!("newmtl a\n{mtl}").into_bytes()), ("a b.png", png(2, 1, &texels))];
    let others: Vec<(&str, &[u8])> = others.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
    with(&obj, &others)
}

fn area(scene: &Scene) -> f32 {
    let area = |p: &lumbre::layout::Primitive| {
        let [a, b, c] = [p.v0, p.v1, p.v2].map(Vec3::from);
        0.5 * (b - a).cross(c - a).length()
    };
    scene.primitives.iter().map(area).sum()
}

/// A warning with this text, and no others.
fn only_warning(scene: &Scene, text: &str) {
    // Every scene here gets a camera and most a sky.
    let own: Vec<&String> = scene.warnings.iter().filter(|warning| !warning.contains("stands in")).collect();
    assert!(own.len() == 1 && own[0].contains(text), "'{text}' is not all of {own:?}");
}

#[test]
fn faces_need_not_have_the_same_attributes() {
    let corners = "v -2 0 0\nv -1 0 0\nv -1 1 0\nv -2 1 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n";
    let attributes = "vn 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    for (first, second, expected) in [
        ("f 1//1 2//1 3//1 4//1", "f 5 6 7 8", [SMOOTH_BIT, 0]),
        ("f 1/1 2/2 3/3 4/4", "f 5//1 6//1 7//1 8//1", [UV_BIT, SMOOTH_BIT]),
        ("f 1/1/1 2/2/1 3/3/1 4/4/1", "f 5/1 6/2 7/3 8/4", [SMOOTH_BIT | UV_BIT, UV_BIT]),
        // A face has what all its corners have.
        ("f 1 2 3 4", "f 5/1/1 6/2/1 7//1 8/4/1", [0, SMOOTH_BIT]),
        ("f 1 2 3 4", "f -4/-4 -3/-3 -2/-2 -1/-1", [0, UV_BIT]),
    ] {
        // The second kind of face comes between two of the first.
        let scene = with(&format!("{corners}{attributes}{first}\n{second}\n{first}\n"), &[]);
        let kinds = |x: f32| {
            let side = scene.primitives.iter().filter(|p| p.v0[0] * x > 0.0);
            side.map(|p| p.surface & !SURFACE_MASK).collect::<Vec<u32>>()
        };
        assert_eq!(kinds(-1.0), [expected[0]; 4], "{first}");
        assert_eq!(kinds(1.0), [expected[1]; 2], "{second}");
        assert_eq!(scene.groups.len(), 1, "{first}");
    }
}

/// As a shape of Mitsuba such a file is one mesh: normals that are missing are computed.
#[test]
fn mitsuba_s_shapes_get_the_normals_that_are_missing() {
    let obj = format!("{SQUARE}v 1 1 2\nvn 0 0.6 0.8\nf 1//1 2//1 3//1\nf 2 5 3\n");
    let scene = r#"<scene version="3.0.0"><shape type="obj"><string name="filename" value="a.obj"/></shape></scene>"#;
    let scene = load(scene.as_bytes(), "scene.xml", &[("a.obj", obj.as_bytes())]).unwrap();
    let normals: Vec<Vec3> = scene.normals.iter().map(|normal| Vec3::from(*normal)).collect();
    assert_eq!(normals.len(), 6);
    assert!(normals[..3].iter().all(|normal| normal.distance(Vec3::new(0.0, 0.6, 0.8)) < 1e-6), "{normals:?}");
    assert!(normals[3..].iter().all(|normal| normal.distance(Vec3::NEG_X) < 1e-6 || normal.distance(Vec3::X) < 1e-6));
}

#[test]
fn lines_may_continue_end_and_comment_in_every_way() {
    let plain = with(&format!("{SQUARE}f 1 2 3 4\n"), &[]);
    for text in [
        "v -1 -1 \\\n 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 \\\n 3 4\n",
        "v -1 -1\\\r\n0\r\nv 1 -1 0\r\nv 1 1 0\r\nv -1 1 0\r\nf 1 2\\\r\n3 4",
        "v -1 -1 0 # a corner\nv 1 -1 0# another\nv 1 1 0\nv -1 1 0\nf 1 2 3 4 # the face\n",
        "# old \\\rv -1 -1 0\rv 1 -1 0\rv 1 1 0\rv -1 1 0\r\rf 1 2 3 4",
        "\u{feff}v -1. -1.0 +0\nv 1e0 -1E+0 .0\nv\t1 1\t-0 1.0\n  v -10e-1 1 0 \nfo -4 -3 -2 -1",
        "v -2 -2 0 2\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n",
    ] {
        let scene = with(text, &[]);
        assert_eq!(scene.primitives, plain.primitives, "{text}");
    }
    for (text, expected) in [
        ("v 0 0 0\nv 1d0 0 0\n", ["scene.obj:2", "the position", "1d0"]),
        ("\n\nv 0 \\\n\\\n0\n", ["scene.obj:3", "three numbers", "has 2"]),
        ("v 0 0 0 1 1\n", ["scene.obj:1", "with a colour six", "has 5"]),
        ("v 0 0 0 1 1 x\n", ["scene.obj:1", "colour", "x"]),
        ("v 0 0 0 0\n", ["scene.obj:1", "w of 0", ""]),
        ("vt\n", ["scene.obj:1", "texture coordinate", "has 0"]),
        ("vn 1 2 # 3\n", ["scene.obj:1", "normal", "has 2"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2/1/1/1 3\n", ["scene.obj:4", "2/1/1/1", "v/vt/vn"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 7 2\n", ["scene.obj:5", "vertex 7", "there are 3"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", ["scene.obj:4", "corner '0'", "from 1"]),
    ] {
        let message = refused(text, "");
        assert!(expected.iter().all(|part| message.contains(part)), "{expected:?} is not in: {message}");
    }
}

#[test]
fn texture_coordinates_may_have_one_number_or_three() {
    let scene = with(&format!("{SQUARE}vt 0.25\nvt 1 0.5 7\nf 1/1 2/2 3/2 4/1\n"), &[]);
    // v runs downwards in a scene.
    let mut uvs = scene.uvs.clone();
    uvs.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(uvs, [[0.25, 1.0], [0.25, 1.0], [1.0, 0.5], [1.0, 0.5]]);
}

/// sRGB, white where a vertex has none; of a mesh without material they are its colour.
#[test]
fn vertices_may_have_colours() {
    let face = "f 1 2 3 4\n";
    for (first, others) in [
        ("v -1 -1 0 1 0 0.5\n", "v 1 -1 0\nv 1 1 0 1\nv -1 1 0\n"),
        ("v -1 -1 0 1 0 0.5 1\n", "v 1 -1 0 1 1 1\nv 1 1 0\nv -2 2 0 2\n"),
    ] {
        for text in [format!("{first}{others}{face}"), format!("{others}{first}{face}")] {
            let scene = with(&text, &[]);
            assert_eq!(scene.colours.len(), 4, "{text}");
            let at = scene.colours.iter().position(|colour| colour[1] < 0.5).unwrap();
            let linear = 0.214_041; // ((0.5 + 0.055) / 1.055)^2.4
            let found = scene.colours[at];
            assert!(found[..2] == [1.0, 0.0] && (found[2] - linear).abs() < 1e-5, "{found:?}");
            let white = scene.colours.iter().filter(|colour| **colour == [1.0; 4]).count();
            assert!(white == 3 && area(&scene) == 4.0, "{text}");
            let material = material(&scene, 0);
            assert!(material.reflectance == [1.0; 3] && material.flags & MATERIAL_HAS_COLOURS != 0, "{text}");
        }
    }
    let scene = with(&format!("mtllib m\nusemtl red\nv -1 -1 0 1 0 0\n{SQUARE}f 2 3 4 5"), &[("m", RED.as_bytes())]);
    assert!(
        material(&scene, 0).reflectance == [0.9, 0.1, 0.1] && material(&scene, 0).flags & MATERIAL_HAS_COLOURS != 0
    );
    assert!(with(&format!("{SQUARE}{face}"), &[]).colours.is_empty());
}

#[test]
fn concave_polygons_are_cut_inside() {
    let corners = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\n";
    for face in ["f 1 2 3 4 5 6 7 8\n", "f 5 6 7 8 1 2 3 4\n", "f 8 7 6 5 4 3 2 1\n"] {
        let scene = with(&format!("{corners}{face}"), &[]);
        assert!((area(&scene) - 7.0).abs() < 1e-5 && scene.primitives.len() == 6, "{face}: {}", area(&scene));
    }
}

#[test]
fn libraries_and_names_are_found() {
    let grey = "newmtl grey\nKd 0.5 0.5 0.5\n";
    let other_red = "newmtl red\nKd 0 0 1\n";
    for (head, others) in [
        ("usemtl red\nmtllib b.mtl\n", [("b.mtl", RED), ("a.mtl", grey)]),
        ("mtllib a.mtl b.mtl\nusemtl red\n", [("b.mtl", RED), ("a.mtl", grey)]),
        ("mtllib a.mtl\nmtllib b.mtl\nusemtl red\n", [("b.mtl", RED), ("a.mtl", grey)]),
        ("mtllib my lib.mtl a.mtl\nusemtl red\n", [("my lib.mtl", RED), ("a.mtl", grey)]),
        ("mtllib \"my lib.mtl\"\nusemtl red\n", [("my lib.mtl", RED), ("a.mtl", grey)]),
        ("mtllib C:\\lib\\b.mtl\nusemtl red # the ball\n", [("b.mtl", RED), ("a.mtl", grey)]),
        ("mtllib b.mtl # the reds\nusemtl red\n", [("b.mtl", "newmtl red # a red\nKd 0.9 0.1 0.1\n"), ("a.mtl", grey)]),
        // The first library that has it.
        ("mtllib b.mtl a.mtl\nusemtl red\n", [("b.mtl", RED), ("a.mtl", other_red)]),
        ("\u{feff}mtllib b.mtl\r\nusemtl red\r\n", [("b.mtl", RED), ("a.mtl", "")]),
        (
            "mtllib b.mtl\nusemtl red\n",
            [("b.mtl", "\u{feff}newmtl red\r\nKd 0.9 \\\r\n 0.1 0.1 # dark\r\n"), ("a.mtl", "")],
        ),
        ("mtllib b.mtl\nusemtl red #2\n", [("b.mtl", "newmtl red #2\nkd 0.9 0.1 0.1\n"), ("a.mtl", "")]),
    ] {
        let others = others.map(|(name, text)| (name, text.as_bytes()));
        let scene = with(&format!("{head}{SQUARE}f 1 2 3 4\n"), &others);
        assert_eq!(material(&scene, 0).reflectance, [0.9, 0.1, 0.1], "{head}");
    }
    for (head, warning) in [
        ("mtllib b.mtl\nusemtl red\nusemtl\n", "a usemtl names no material"),
        ("mtllib b.mtl\nusemtl blue\n", "no MTL file has these materials, and they are grey: 'blue'"),
    ] {
        let scene = with(&format!("{head}{SQUARE}f 1 2 3 4\n"), &[("b.mtl", RED.as_bytes())]);
        assert_eq!(material(&scene, 0).reflectance, [0.5; 3], "{head}");
        only_warning(&scene, warning);
    }
    let scene = with(
        &format!("mtllib b.mtl\nusemtl red\n{SQUARE}f 1 2 3 4\n"),
        &[("b.mtl", &[b"newmtl\nKd 0 0 0\n", RED.as_bytes()].concat())],
    );
    assert_eq!(material(&scene, 0).reflectance, [0.9, 0.1, 0.1]);
    only_warning(&scene, "a newmtl names no material");
}

#[test]
fn what_is_left_out_is_said() {
    let scene = with(&format!("{SQUARE}l 1 2\np 1\nl 2 3\ncurv 0 1 1 2\ns 1\nf 1 2\nf 1 2 3 4\n"), &[]);
    let warnings = scene.warnings.join("\n");
    assert!(warnings.contains("statements that are not read: 'curv' (1), 'l' (2) and 'p' (1)"), "{warnings}");
    assert!(warnings.contains("1 faces of fewer than three corners"), "{warnings}");
    only_warning(
        &square_of("Kd 1 1 1\nKs 1 1 1\nNs 20\nillum 2\nmap_Ns a b.png\nrefl -type sphere a b.png\n"),
        "not read of its materials, with how many say it: Ks (1), map_Ns (1) and refl (1)",
    );
    only_warning(&square_of("map_Kd none.png\nillum 0\n"), "material 'a': map_Kd: there is no file 'none.png'");
    only_warning(&square_of("Tr 1\n"), "Tr is 1");
}

#[test]
fn opacity_is_d_or_one_minus_tr() {
    for (mtl, expected) in
        [("d 0.1\nillum 2\n", 0.1), ("Tr 0.75\n", 0.25), ("d -halo 0.5\nTr 0.1\n", 0.5), ("d 1\n", 1.0)]
    {
        let scene = square_of(mtl);
        assert_eq!((surface(&scene, 0).opacity, material(&scene, 0).kind), (expected, MATERIAL_DIFFUSE), "{mtl}");
    }
    for illum in [4, 6, 7, 9] {
        let scene = square_of(&format!("d 0.1\nNi 1.25\nTf 1 0.5 0.25\nillum {illum}\n"));
        let glass = material(&scene, 0);
        assert_eq!((glass.kind, glass.eta, glass.transmittance), (MATERIAL_DIELECTRIC, 1.25, [1.0, 0.5, 0.25]));
        assert_eq!(surface(&scene, 0).opacity, 1.0);
    }
    // The alpha of an image that has some, the luminance of others.
    for (option, channel) in [("", 3), ("-imfchan r ", 0)] {
        let scene = square_of(&format!("d 0.5\nmap_d {option}a b.png\n"));
        let texture = &scene.textures[surface(&scene, 0).opacity_texture as usize];
        assert_eq!((surface(&scene, 0).opacity, texture.channel), (0.5, channel));
    }
}

#[test]
fn images_colour_tilt_and_light() {
    let scene =
        square_of("Kd 0.5 1 1\nmap_Kd -s 2 3 -o 0.5 0.25 -clamp on -mm 0.25 0.5 a b.png\nKe 2 2 2\nmap_Ke a b.png\n");
    let material = material(&scene, 0);
    let texture = &scene.textures[scene.textures_of(material)[0].texture as usize];
    assert_eq!(material.reflectance, [0.5, 1.0, 1.0]);
    // u' = 2 u + 0.5; v' = 3 v + 0.25 upwards.
    assert_eq!((texture.row_u, texture.row_v), ([2.0, 0.0, 0.5], [0.0, 3.0, 1.0 - 3.0 - 0.25]));
    assert_eq!((texture.scale[0], texture.offset[0]), (0.5, 0.25));
    assert!(surface(&scene, 0).emission == [2.0; 3] && surface(&scene, 0).emission_texture != NONE);
    assert_eq!(scene.images.len(), 1, "an image is decoded once");

    // An image with colours is a map of normals, wherever it stands; the tangents of its mesh are computed.
    let textures = |mtl: &str| {
        let scene = square_of(mtl);
        (scene.material_textures[0], scene.tangents.len())
    };
    for mtl in ["norm a b.png\n", "map_Bump -bm 0.5 a b.png\n", "bump a b.png\n", "map_bump a b.png\n"] {
        let (found, tangents) = textures(mtl);
        assert!(found.normal != NONE && found.bump == NONE && tangents > 0, "{mtl}");
        assert_eq!(found.normal_scale, if mtl.contains("-bm") { 0.5 } else { 1.0 }, "{mtl}");
    }
    let grey = png(2, 1, &[[9, 9, 9, 255], [90, 90, 90, 255]]);
    let obj = format!("mtllib m\n{SQUARE}vt 0 0\nusemtl a\nf 1/1 2/1 3/1 4/1\n");
    let scene = with(&obj, &[("m", b"newmtl a\nbump -bm 0.25 g.png\n"), ("g.png", &grey)]);
    let found = scene.material_textures[0];
    assert!(found.normal == NONE && found.bump != NONE && found.bump_scale == 0.25);
}

#[test]
fn mirrors_and_physically_based_materials() {
    let scene = square_of("Ks 0.5 0.25 1\nmap_Ks a b.png\nillum 3\n");
    assert_eq!((material(&scene, 0).kind, material(&scene, 0).reflectance), (MATERIAL_CONDUCTOR, [0.5, 0.25, 1.0]));
    assert_eq!(scene.property_textures[0].property, PROPERTY_REFLECTANCE);
    let scene = square_of("Kd 0.5 0.25 1\nPr 0.25\nPm 0.75\nPc 1\nPcr 0.5\nNi 1.25\nillum 3\nmap_Pr a b.png\n");
    let (material, layers) = (material(&scene, 0), &scene.layereds[0]);
    assert_eq!((material.kind, material.alpha_u, material.eta), (MATERIAL_LAYERED, 0.25, 1.25));
    assert_eq!((layers.metallic, layers.clearcoat, layers.clearcoat_roughness), (0.75, 1.0, 0.5));
    let textured: Vec<u32> = scene.property_textures.iter().map(|own| own.property).collect();
    assert_eq!(textured, [PROPERTY_ROUGHNESS]);
}

#[test]
fn entries_that_are_wrong_name_their_line() {
    let obj = format!("mtllib scene.mtl\n{SQUARE}usemtl a\nf 1 2 3 4\n");
    for (mtl, expected) in [
        ("newmtl a\n\nNi glass\n", ["scene.mtl:3", "Ni needs a number", "glass"]),
        ("newmtl a\nKd 1 0\n", ["scene.mtl:2", "Kd", "three numbers"]),
        ("newmtl a\nillum 2.5\n", ["scene.mtl:2", "illum", "integer"]),
        ("newmtl a\nmap_Kd\n", ["scene.mtl:2", "map_Kd", "no file"]),
        ("newmtl a\nKe 1 -1 1\n", ["scene.mtl", "Ke", "0 or more"]),
    ] {
        let message = refused(&obj, mtl);
        assert!(expected.iter().all(|part| message.contains(part)), "{expected:?} is not in: {message}");
    }
    assert_eq!(material(&square_of("Kd 0.25\n"), 0).reflectance, [0.25; 3]);
}
