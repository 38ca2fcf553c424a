//! PLY meshes: ASCII and both binary encodings.

use std::io::BufReader;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use super::Mesh;
use crate::error::{Error, Result};
use crate::input::open;

/// Reads positions, normals (if all three are there), texture coordinates (`u`, `v` or `s`, `t`) and faces; polygons become fans of triangles.
pub fn read(path: &Path) -> Result<Mesh> {
    let wrong = |error: ParseError| parse_error(path, &error);
    let mut reader = Reader::new(BufReader::new(open(path)?));
    let header = Parser::<Vertex>::new().read_header(&mut reader).map_err(wrong)?;
    let mut mesh = Mesh::default();
    let mut has_faces = false;
    for (_, element) in &header.elements {
        // Any number of them would take no byte.
        if element.properties.is_empty() && element.count > 0 {
            return Err(Error::scene(path, format!("the element '{}' has no properties", element.name)));
        }
        match element.name.as_str() {
            "vertex" => {
                for needed in ["x", "y", "z"] {
                    if !element.properties.contains_key(needed) {
                        return Err(Error::scene(path, format!("the element 'vertex' has no property '{needed}'")));
                    }
                }
                let vertices =
                    Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header).map_err(wrong)?;
                if ["nx", "ny", "nz"].iter().all(|name| element.properties.contains_key(*name)) {
                    mesh.normals = vertices.iter().map(|vertex| vertex.normal).collect();
                }
                if [["u", "v"], ["s", "t"]]
                    .iter()
                    .any(|pair| pair.iter().all(|name| element.properties.contains_key(*name)))
                {
                    mesh.uvs = vertices.iter().map(|vertex| vertex.uv).collect();
                }
                mesh.positions = vertices.iter().map(|vertex| vertex.position).collect();
            }
            "face" => {
                has_faces = true;
                let indices = ["vertex_indices", "vertex_index"].iter().find_map(|name| element.properties.get(*name));
                match indices.map(|property| &property.data_type) {
                    Some(PropertyType::List(_, ScalarType::Float | ScalarType::Double) | PropertyType::Scalar(_)) => {
                        return Err(Error::scene(
                            path,
                            "the element 'face' has vertex indices that are no list of integers",
                        ));
                    }
                    None => return Err(Error::scene(path, "the element 'face' has no property 'vertex_indices'")),
                    Some(_) => {}
                }
                let faces =
                    Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header).map_err(wrong)?;
                for (index, face) in faces.iter().enumerate() {
                    let [first, rest @ ..] = &face.0[..] else { continue };
                    if rest.len() < 2 {
                        return Err(Error::scene(
                            path,
                            format!("face {index} has {} vertices, and needs three or more", face.0.len()),
                        ));
                    }
                    mesh.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
                }
            }
            _ => {
                // Something else, such as edges: read past it.
                Parser::<Skipped>::new().read_payload_for_element(&mut reader, element, &header).map_err(wrong)?;
            }
        }
    }
    if mesh.positions.is_empty() || !has_faces {
        return Err(Error::scene(
            path,
            "the file has no element 'vertex' with data, or no element 'face': it is not a mesh",
        ));
    }
    mesh.check_indices(path)?;
    Ok(mesh)
}

/// The parser's error as one line: its own first line, and the text that it could not read.
fn parse_error(path: &Path, error: &ParseError) -> Error {
    let message = error.to_string();
    let mut lines = message.lines().map(|line| line.trim().trim_end_matches(['.', ':']));
    let mut what = lines.next().unwrap_or("unreadable");
    if error.line().is_some() {
        what = what.split_once(": ").map_or(what, |(_, rest)| rest);
    }
    let text = lines.find_map(|line| line.strip_prefix("String: '"));
    let text = text.map_or(String::new(), |text| format!(": '{}'", text.trim_end_matches('\'')));
    let message = format!("not a valid PLY file: {what}{text}");
    match error.line().and_then(|line| u32::try_from(line).ok()) {
        Some(line) => Error::scene_line(path, line, message),
        None => Error::scene(path, message),
    }
}

#[derive(Clone, Copy, Default)]
struct Vertex {
    position: DVec3,
    normal: Vec3,
    uv: Vec2,
}

#[derive(Default)]
struct Face(Vec<u32>);

struct Skipped;

fn scalar(property: &Property) -> Option<f64> {
    match property {
        Property::Double(value) => Some(*value),
        Property::Float(value) => Some(f64::from(*value)),
        other => other.to_f32_lossy().map(f64::from),
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = scalar(&property) else { return PropertyAccessResult::Ignored };
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "nx" => self.normal.x = value as f32,
            "ny" => self.normal.y = value as f32,
            "nz" => self.normal.z = value as f32,
            "u" | "s" => self.uv.x = value as f32,
            "v" | "t" => self.uv.y = value as f32,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        // A negative index is out of range, which the check of the whole mesh reports.
        self.0 = match property {
            Property::ListChar(list) => list.into_iter().map(|index| i32::from(index) as u32).collect(),
            Property::ListShort(list) => list.into_iter().map(|index| i32::from(index) as u32).collect(),
            Property::ListInt(list) => list.into_iter().map(|index| index as u32).collect(),
            other => match other.to_u32_list() {
                Some(list) => list,
                None => return PropertyAccessResult::Ignored,
            },
        };
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }

    fn set_property(&mut self, _: &str, _: Property) -> PropertyAccessResult {
        PropertyAccessResult::Ignored
    }
}
