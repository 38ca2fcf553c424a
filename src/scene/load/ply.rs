//! PLY meshes: ASCII and both binary encodings.

use std::io::{BufRead, BufReader};
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use crate::error::{Error, Result};
use crate::files::open;
use crate::scene::Mesh;

/// Reads positions, normals (if all three are there), texture coordinates (`u`, `v` or `s`, `t`) and faces; polygons become fans of triangles.
pub fn read(path: &Path) -> Result<Mesh> {
    let wrong = |error: ParseError| parse_error(path, &error, "");
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
                let has = |names: &[&str]| names.iter().all(|name| element.properties.contains_key(*name));
                let (has_normals, has_uvs) = (has(&["nx", "ny", "nz"]), has(&["u", "v"]) || has(&["s", "t"]));
                in_batches(&mut reader, element, &header, |_, vertex: Vertex| {
                    mesh.positions.push(vertex.position);
                    if has_normals {
                        mesh.normals.push(vertex.normal);
                    }
                    if has_uvs {
                        mesh.uvs.push(vertex.uv);
                    }
                    Ok(())
                })
                .map_err(|error| error.located(path))?;
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
                in_batches(&mut reader, element, &header, |index, face: Face| {
                    let [first, rest @ ..] = &face.0[..] else { return Ok(()) };
                    if rest.len() < 2 {
                        return Err(format!("face {index} has {} vertices, and needs three or more", face.0.len()));
                    }
                    mesh.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
                    Ok(())
                })
                .map_err(|error| error.located(path))?;
            }
            _ => {
                // Something else, such as edges: read past it.
                in_batches(&mut reader, element, &header, |_, _: Skipped| Ok(()))
                    .map_err(|error| error.located(path))?;
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

/// Elements that are held at once as the parser returns them: each face is a list of its own there, which takes several times
/// the memory that its triangles do.
const BATCH: usize = 1 << 16;

/// Why an element could not be taken in.
enum Refusal {
    Unreadable(ParseError, String),
    Wrong(String),
}

impl Refusal {
    fn located(&self, path: &Path) -> Error {
        match self {
            Self::Unreadable(error, announced) => parse_error(path, error, announced),
            Self::Wrong(message) => Error::scene(path, message),
        }
    }
}

/// Reads all elements of one kind, and hands each on with its number.
fn in_batches<E: PropertyAccess>(
    reader: &mut Reader<impl BufRead>,
    element: &ElementDef,
    header: &Header,
    mut take: impl FnMut(usize, E) -> Result<(), String>,
) -> Result<(), Refusal> {
    let parser = Parser::<E>::new();
    let mut part = element.clone();
    for first in (0..element.count).step_by(BATCH) {
        part.count = BATCH.min(element.count - first);
        let read = parser.read_payload_for_element(reader, &part, header).map_err(|error| {
            Refusal::Unreadable(error, format!("; the header announces {} of '{}'", element.count, element.name))
        })?;
        for (index, item) in read.into_iter().enumerate() {
            take(first + index, item).map_err(Refusal::Wrong)?;
        }
    }
    Ok(())
}

/// The parser's error as one line: its own first line, the text that it could not read, and what was announced.
fn parse_error(path: &Path, error: &ParseError, announced: &str) -> Error {
    let message = error.to_string();
    let mut lines = message.lines().map(|line| line.trim().trim_end_matches(['.', ':']));
    let mut what = lines.next().unwrap_or("unreadable");
    if error.line().is_some() {
        what = what.split_once(": ").map_or(what, |(_, rest)| rest);
    }
    let text = lines.find_map(|line| line.strip_prefix("String: '"));
    let text = text.map_or(String::new(), |text| format!(": '{}'", text.trim_end_matches('\'')));
    let message = format!("not a valid PLY file: {what}{text}{announced}");
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
