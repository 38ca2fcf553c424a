//! PLY files as people have them: what elements and properties mean.

use crate::common::gltf::load;
use glam::Vec3;
use lumbre::layout::{MATERIAL_HAS_COLOURS, SMOOTH_BIT};
use lumbre::scene::Scene;

const POSITIONS: &str = "property float x\nproperty float y\nproperty float z\n";
const FACES: &str = "property list uchar int vertex_indices\nend_header\n";
const SQUARE: [[f32; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

fn read(bytes: &[u8]) -> Scene {
    load(bytes, "scene.ply", &[]).unwrap_or_else(|error| panic!("{error}\n{}", String::from_utf8_lossy(bytes)))
}

fn ascii(vertices: &[&str], properties: &str, faces: &[&str]) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\n{POSITIONS}{properties}element face {}\n{FACES}{}\n{}\n",
        vertices.len(),
        faces.len(),
        vertices.join("\n"),
        faces.join("\n")
    )
}

fn area(scene: &Scene) -> f32 {
    let area = |p: &lumbre::layout::Primitive| {
        let [a, b, c] = [p.v0, p.v1, p.v2].map(Vec3::from);
        0.5 * (b - a).cross(c - a).length()
    };
    scene.primitives.iter().map(area).sum()
}

/// The square with further numbers for each vertex.
fn square(properties: &str, more: [&str; 4]) -> Scene {
    let rows: Vec<String> = SQUARE.iter().zip(more).map(|([x, y, z], more)| format!("{x} {y} {z} {more}")).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    read(ascii(&rows, properties, &["4 0 1 2 3"]).as_bytes())
}

#[test]
fn texture_coordinates_have_several_names() {
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]] {
        let properties = format!("property float {u}\nproperty uchar quality\nproperty double {v}\n");
        let scene = square(&properties, ["0 9 0.25", "1 9 0.25", "1 9 1", "0 9 1"]);
        let mut uvs = scene.uvs.clone();
        uvs.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(uvs, [[0.0, 0.25], [0.0, 1.0], [1.0, 0.25], [1.0, 1.0]], "{u}");
    }
}

#[test]
fn concave_polygons_are_cut_inside() {
    let corners = ["0 0 0", "3 0 0", "3 3 0", "2 3 0", "2 1 0", "1 1 0", "1 3 0", "0 3 0"];
    for face in ["8 0 1 2 3 4 5 6 7", "8 4 5 6 7 0 1 2 3", "8 7 6 5 4 3 2 1 0"] {
        let scene = read(ascii(&corners, "", &["3 0 1 5", face]).as_bytes());
        assert!((area(&scene) - 8.5).abs() < 1e-5 && scene.primitives.len() == 7, "{face}: {}", area(&scene));
    }
    // Faces may come before the vertices that they name.
    let early = format!(
        "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_index\nelement vertex 8\n{POSITIONS}end_header\n8 0 1 2 3 4 5 6 7\n{}\n",
        corners.join("\n")
    );
    assert!((area(&read(early.as_bytes())) - 7.0).abs() < 1e-5);
}

#[test]
fn a_file_without_faces_says_so() {
    for faces in ["element face 0\nproperty list uchar int vertex_indices\n", ""] {
        let text = format!("ply\nformat ascii 1.0\nelement vertex 1\n{POSITIONS}{faces}end_header\n0 0 0\n");
        let message = load(text.as_bytes(), "scene.ply", &[]).unwrap_err().to_string();
        assert!(message.contains("scene.ply: the file has no faces: there is nothing to render"), "{message}");
    }
}

#[test]
fn lists_are_of_any_integers_in_either_order_of_bytes() {
    type Write = fn(u32) -> Vec<u8>;
    let types: [(&str, Write); 8] = [
        ("char", |value| vec![value as u8]),
        ("uint8", |value| vec![value as u8]),
        ("short", |value| (value as u16).to_le_bytes().to_vec()),
        ("ushort", |value| (value as u16).to_le_bytes().to_vec()),
        ("int16", |value| (value as u16).to_le_bytes().to_vec()),
        ("int", |value| value.to_le_bytes().to_vec()),
        ("uint", |value| value.to_le_bytes().to_vec()),
        ("uint32", |value| value.to_le_bytes().to_vec()),
    ];
    for is_big in [false, true] {
        let ordered = |mut bytes: Vec<u8>| {
            if is_big {
                bytes.reverse();
            }
            bytes
        };
        for (count, (count_type, write_count)) in types.iter().enumerate() {
            let (index_type, write_index) = &types[(count + 3) % types.len()];
            let form = if is_big { "binary_big_endian" } else { "binary_little_endian" };
            // An unknown element with a list before the vertices, one with numbers behind them; lines end as on Windows.
            let header = format!(
                "ply\nformat {form} 1.0\ncomment by hand\nobj_info x\nelement camera 1\nproperty list uchar double view\nelement vertex 4\n\
                 {POSITIONS}element face 1\nproperty uchar flags\nproperty list {count_type} {index_type} vertex_indices\nelement edge 1\n\
                 property int a\nend_header\n"
            );
            let mut bytes = header.replace('\n', "\r\n").into_bytes();
            bytes.push(2);
            bytes.extend([0; 16]);
            for value in SQUARE.as_flattened() {
                bytes.extend(ordered(value.to_le_bytes().to_vec()));
            }
            bytes.push(7);
            bytes.extend(ordered(write_count(4)));
            (0..4).for_each(|index| bytes.extend(ordered(write_index(index))));
            bytes.extend([0; 4]);
            let scene = read(&bytes);
            assert!(scene.primitives.len() == 2 && area(&scene) == 4.0, "{header}");
        }
    }
}

#[test]
fn strips_are_triangles_that_face_one_way() {
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 6\n{POSITIONS}element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
         0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n10 0 1 2 3 4 -1 3 5 4 -1\n"
    );
    let scene = read(text.as_bytes());
    assert_eq!(scene.primitives.len(), 4);
    for p in &scene.primitives {
        let [a, b, c] = [p.v0, p.v1, p.v2].map(Vec3::from);
        assert!((b - a).cross(c - a).z > 0.0, "{p:?}");
    }
}

/// Bytes are sRGB, fractions are not.
#[test]
fn vertices_have_colours_and_normals() {
    let rows = ["255 0 128", "255 0 128", "255 0 128", "255 0 128"];
    let scene = square("property uchar red\nproperty uchar green\nproperty uchar blue\n", rows);
    let [r, g, b, a] = scene.colours[0];
    assert!((r, g, a) == (1.0, 0.0, 1.0) && (b - 0.215_861).abs() < 1e-5, "{b}");
    let material = &scene.materials[scene.surfaces[0].front as usize];
    assert!(material.reflectance == [1.0; 3] && material.flags & MATERIAL_HAS_COLOURS != 0);
    let scene = square(
        "property float r\nproperty float g\nproperty float b\n",
        ["1 0.25 2", "1 0.25 2", "1 0.25 2", "1 0.25 2"],
    );
    assert_eq!(scene.colours[0], [1.0, 0.25, 1.0, 1.0]);
    let normals = "property float nx\nproperty float ny\nproperty float nz\n";
    let scene = square(normals, ["0 0 1", "0 0 1", "0 0 1", "0 0.6 0.8"]);
    assert!(scene.primitives[0].surface & SMOOTH_BIT != 0 && scene.normals.contains(&[0.0, 0.6, 0.8]));
    let scene = square("", [""; 4]);
    assert!(scene.colours.is_empty() && scene.materials[0].reflectance == [0.5; 3]);
}
